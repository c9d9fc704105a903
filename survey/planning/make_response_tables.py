"""Make the tables of survey/optics/data anew: ``python -m survey.planning.make_response_tables``.

The walks are those of `survey.transport.response`; here one set of them serves all depths.
"""

from __future__ import annotations

import json
import math
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.optics.water import PAPER_COEFFICIENTS, petzold_water
from survey.transport.response import SQUARE
from survey.transport.response_column import column_batches
from survey.transport.response_echo import echo_batches
from survey.transport.response_walks import BATCHES

FloatArray = NDArray[np.float64]

DEEPEST = {"clear": 90.0, "coastal": 50.0, "harbor": 18.0}
COLUMN_BIN = {"clear": 0.5, "coastal": 0.5, "harbor": 0.25}
BLOCKS = {"clear": 96, "coastal": 256, "harbor": 512}
WALKS = {"clear": 4000, "coastal": 4000, "harbor": 8000}
DEPTHS = 32
SHALLOWEST_SHARE = 0.01
LATE_BIN = 0.125
LATE_EDGES = (0.0, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
INDEX = 1.33  # the tables do not depend on it
SPLIT_ANGLE = math.radians(45.0)
DIGITS = 5


def tables(*, work: float = 1.0, seed: int = 1, threads: int = 2) -> dict[str, Any]:
    """Trace the three waters and return the tables as plain values.

    Parameters
    ----------
    work : float
        Walks over those of the shipped tables [1].
    seed, threads : int
    """
    return {
        "made_by": "python -m survey.planning.make_response_tables",
        "work": work,
        "seed": seed,
        "batches": BATCHES,
        "isolated_square_side_m": SQUARE.side,
        "late_edges_m": list(LATE_EDGES),
        "waters": {
            name: _water(name, work=work, seed=seed, threads=threads) for name in PAPER_COEFFICIENTS
        },
    }


def _water(name: str, *, work: float, seed: int, threads: int) -> dict[str, Any]:
    water = petzold_water(name, refractive_index=INDEX, group_index=INDEX)
    depths = np.geomspace(1.0, 1.0 / SHALLOWEST_SHARE, DEPTHS) * SHALLOWEST_SHARE * DEEPEST[name]
    walks = max(64, round(work * WALKS[name]))
    blocks = max(2, round(work * BLOCKS[name]))
    echo = echo_batches(
        water=water,
        footprint=SQUARE,
        depths=depths,
        bins=round(LATE_EDGES[-1] / LATE_BIN),
        bin_width=LATE_BIN,
        seed=seed,
        walks=walks,
        threads=threads,
    )
    column = column_batches(
        water=water,
        footprint=SQUARE,
        bins=math.ceil(DEEPEST[name] / COLUMN_BIN[name]),
        bin_width=COLUMN_BIN[name],
        seed=seed,
        split_angle=SPLIT_ANGLE,
        blocks=blocks,
        threads=threads,
    )
    return {
        "absorption_per_m": water.absorption,
        "scattering_per_m": water.scattering,
        "phase_function": water.phase_function.name,
        "walks_each_way": walks * BATCHES,
        "column_blocks": blocks * BATCHES,
        "depth_m": _plain(depths),
        "column_bin_m": COLUMN_BIN[name],
        "flood": _lit(echo[:, 0], column[:, 0]),
        "isolated": _lit(echo[:, 1], column[:, 1]),
    }


def _lit(echo: FloatArray, column: FloatArray) -> dict[str, Any]:
    """Return echo (batches, depths, late bins) and column (batches, bins) as means with errors."""
    two_way = echo.sum(axis=-1)
    first = np.rint(np.array(LATE_EDGES[:-1]) / LATE_BIN).astype(np.intp)
    late = np.add.reduceat(echo.mean(axis=0), first, axis=-1)
    return {
        "two_way": _plain(two_way.mean(axis=0)),
        "two_way_sem": _plain(_sem(two_way)),
        "late_share": [_plain(row) for row in late / late.sum(axis=-1, keepdims=True)],
        "column_per_m_sr": _plain(column.mean(axis=0)),
        "column_sem": _plain(_sem(column)),
    }


def _sem(batches: FloatArray) -> FloatArray:
    return np.asarray(batches.std(axis=0, ddof=1) / len(batches) ** 0.5)


def _plain(values: FloatArray) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]


def as_text(made: dict[str, Any]) -> str:
    r"""Return JSON with every list of numbers on a line of its own.

    Examples
    --------
    >>> as_text({"depth_m": [1.0, 2.0], "late_share": [[1.0], [0.5]]})
    '{\n "depth_m": [1.0, 2.0],\n "late_share": [\n  [1.0],\n  [0.5]\n ]\n}\n'
    """
    return _lines(made, "") + "\n"


def _lines(value: Any, margin: str) -> str:
    inner = margin + " "
    if isinstance(value, dict):
        parts = [f"{inner}{json.dumps(key)}: {_lines(part, inner)}" for key, part in value.items()]
        return "{\n" + ",\n".join(parts) + f"\n{margin}}}"
    if isinstance(value, list) and value and isinstance(value[0], list):
        return "[\n" + ",\n".join(inner + json.dumps(row) for row in value) + f"\n{margin}]"
    return json.dumps(value)


if __name__ == "__main__":
    place = resources.files("survey.optics") / "data" / "response_tables.json"
    Path(str(place)).write_text(as_text(tables()), encoding="utf-8")

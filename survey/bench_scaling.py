"""How the time of a flash grows with pixels, with scattering depth, and with the mesh."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from survey.bench import SPACING_M, Case, bench_scenario
from survey.preparation import prepare
from survey.scenario.scenario import Scenario

REPEATS = 5
WALKS = 64
ROWS_AND_COLUMNS = {512: (16, 32), 2048: (32, 64), 8192: (64, 128)}
SCATTERING_DEPTHS = (1.0, 4.0, 16.0)
TRIANGLES = {10_000: 10.0**0.5, 100_000: 1.0, 1_000_000: 10.0**-0.5}
DEPTH_M, TURBID_ABSORPTION_PER_M = 10.0, 0.05


def scaling() -> Iterator[dict[str, Any]]:
    """Measure three rows of cases; yields name, sizes, seconds of one core, fitted exponent.

    Coastal water 10 m deep but where it is varied: pixels of 2 m (so that more see more water),
    optical depth b z of scattering, and triangles of the mesh. The exponent is that of a power law
    through the seconds.
    """
    coastal = Case(water="coastal", depth_m=DEPTH_M, walks_per_pixel=WALKS)
    yield _row(
        "pixels",
        list(ROWS_AND_COLUMNS),
        [
            bench_scenario(coastal, **{"camera.rows": rows, "camera.columns": columns})
            for rows, columns in ROWS_AND_COLUMNS.values()
        ],
    )
    yield _row(
        "scattering depth",
        SCATTERING_DEPTHS,
        [
            bench_scenario(
                coastal,
                **{
                    "water.scattering_per_m": depth / DEPTH_M,
                    "water.absorption_per_m": TURBID_ABSORPTION_PER_M,
                },
            )
            for depth in SCATTERING_DEPTHS
        ],
    )
    yield _row(
        "triangles",
        list(TRIANGLES),
        [
            bench_scenario(coastal, **{"seabed.spacing_m": SPACING_M * coarser})
            for coarser in TRIANGLES.values()
        ],
    )


def _row(name: str, sizes: Sequence[float], scenarios: list[Scenario]) -> dict[str, Any]:
    seconds = [_seconds(scenario) for scenario in scenarios]
    exponent = np.polyfit(np.log(sizes), np.log(seconds), 1)[0]
    return {"name": name, "sizes": list(sizes), "seconds": seconds, "exponent": float(exponent)}


def _seconds(scenario: Scenario) -> float:
    """Return the least processor time of a few flashes."""
    mission = prepare(scenario)
    engine, pose = mission.engine, mission.frames[0].pose
    engine.flash(pose=pose, frame=0)
    spent = []
    for frame in range(REPEATS):
        start = time.thread_time()
        engine.flash(pose=pose, frame=frame)
        spent.append(time.thread_time() - start)
    return min(spent)

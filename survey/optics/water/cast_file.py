"""Profiles of absorption and scattering by depth as CSV with named columns, in any order.

``depth_m``, ``absorption_per_m``, ``scattering_per_m``, perhaps ``backscatter_fraction``; others
are left alone. Read in a child process.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from terrain.foreign.faults import ReaderError
from terrain.foreign.limits import limits_for_whole
from terrain.foreign.reading import read_foreign
from terrain.foreign.text_table import doubled, few, numbers

FloatArray = NDArray[np.float64]

NEEDED = ("depth_m", "absorption_per_m", "scattering_per_m")
BACKSCATTER = "backscatter_fraction"
MOST_ROWS = 1000
GREATEST_DEPTH = 12_000.0  # [m]
LEAST_COEFFICIENT, GREATEST_COEFFICIENT = 1e-6, 1000.0  # [1/m]


@dataclass(frozen=True, kw_only=True)
class Cast:
    """What was measured at depths, arrays (n,).

    Parameters
    ----------
    depth : array
        Increasing [m].
    absorption, scattering : array
        Of all that is in the water, and of the water itself [1/m].
    backscatter_fraction : array, optional
        Share of scattering by more than 90 degrees [1].
    """

    depth: FloatArray
    absorption: FloatArray
    scattering: FloatArray
    backscatter_fraction: FloatArray | None


def read_cast(path: Path) -> Cast:
    """Return the cast in a file.

    Raises
    ------
    ForeignFileError
        With every fault: columns that are missing, numbers that are none or out of bounds, depths
        that do not increase.
    """
    columns = read_foreign(
        "survey.optics.water.cast_file:cast_columns", path, limits=limits_for_whole(path)
    )
    depth, absorption, scattering = (columns[name] for name in NEEDED)
    return Cast(
        depth=depth,
        absorption=absorption,
        scattering=scattering,
        backscatter_fraction=columns.get(BACKSCATTER),
    )


def cast_columns(path: str) -> dict[str, FloatArray]:
    """Return the columns of a cast by name, in the child.

    Raises
    ------
    ReaderError
        As `read_cast`.
    """
    try:
        header, *rows = Path(path).read_text(encoding="utf-8-sig").splitlines() or [""]
    except UnicodeDecodeError as error:
        raise ReaderError("not UTF-8 text. Save it as UTF-8") from error
    names = tuple(name.strip() for name in header.split(","))
    missing = [name for name in NEEDED if name not in names]
    held = ", ".join(names)
    faults = [f"line 1: no column {name}. It has {held}" for name in missing]
    if faults := faults + doubled([name for name in names if name in (*NEEDED, BACKSCATTER)]):
        raise ReaderError(*faults)
    try:
        table = numbers(rows, names=names, separator=",", first_line=2)
    except ValueError as error:
        raise ReaderError(*str(error).splitlines()) from error
    wanted = [*NEEDED, *({BACKSCATTER} & set(names))]
    columns = {name: table[:, names.index(name)] for name in wanted}
    lines = [number for number, row in enumerate(rows, start=2) if row.strip()]
    if faults := _faults(columns, lines):
        raise ReaderError(*faults)
    return columns


def _faults(columns: dict[str, FloatArray], lines: list[int]) -> list[str]:
    from survey.optics.phase import backscatter_reach

    if not 2 <= len(lines) <= MOST_ROWS:
        return [f"{len(lines)} rows. A profile needs 2 to {MOST_ROWS}: average it over depth"]
    coefficient = (LEAST_COEFFICIENT, GREATEST_COEFFICIENT)
    bounds = {
        "depth_m": (0.0, GREATEST_DEPTH),
        "absorption_per_m": coefficient,
        "scattering_per_m": coefficient,
        BACKSCATTER: backscatter_reach(),
    }
    faults = []
    for name, values in columns.items():
        low, high = bounds[name]
        off = np.flatnonzero(~((values >= low) & (values <= high)))
        faults += few(
            [f"line {lines[i]}: {name} {values[i]:g} is not in {low:.2g} to {high:g}" for i in off]
        )
    depth = columns["depth_m"]
    back = np.flatnonzero(np.diff(depth) <= 0.0) + 1
    return faults + few(
        [
            f"line {lines[i]}: depth_m {depth[i]:g} is not below {depth[i - 1]:g} before it. "
            "Sort the rows and leave out doubles"
            for i in back
        ]
    )

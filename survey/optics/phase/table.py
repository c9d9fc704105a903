"""Phase functions from tables, the user's and our own."""

from __future__ import annotations

import csv
import reprlib
from collections.abc import Callable, Iterator
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from survey.errors import UserError
from survey.optics.phase.function import FloatArray, PhaseFunction
from terrain.foreign.faults import ForeignFileError, ReaderError
from terrain.foreign.limits import limits_for_whole
from terrain.foreign.reading import read_foreign
from terrain.foreign.text_table import is_number

HEADER = ["angle_deg", "value"]
LAST_ANGLE_TOLERANCE = 1e-6
Row = tuple[int, float, float]


def tabled_phase_function(
    *, name: str, angle: ArrayLike, value: ArrayLike, small_angle_slope: float | None = None
) -> PhaseFunction:
    """Interpolate a table, log-log between its angles, and normalise it.

    Parameters
    ----------
    name : str
        What it is called in reports.
    angle : array (n,)
        Ascending from 0 or above to pi [rad].
    value : array (n,)
        Positive, in any unit, for the integral becomes one.
    small_angle_slope : float, optional
        Exponent of the power law below the first angle, above -2; by default the first two rows
        are continued. A table that begins at 0 needs none: its first interval is interpolated
        linearly in the angle [1].

    Raises
    ------
    ValueError
        A line for each fault.

    Examples
    --------
    >>> even = tabled_phase_function(name="even", angle=[0.01, np.pi], value=[7.0, 7.0])
    >>> round(float(even.density(1.0) * 4.0 * np.pi), 5)
    1.0
    """
    angles, values = np.asarray(angle, np.float64), np.asarray(value, np.float64)
    rows = list(zip(range(1, len(angles) + 1), np.degrees(angles), values, strict=True))
    faults = [f"{name}: row {row}: {fault}" for row, fault in _row_faults(rows)]
    if not faults:
        slope = _slope(angles, values) if small_angle_slope is None else small_angle_slope
        faults = [f"{name}: row 1: {fault}" for fault in _slope_faults(slope)]
    if faults:
        raise ValueError("\n".join(faults))
    return PhaseFunction.from_function(
        name=name,
        function=_interpolation(angles, values / values.max(), slope),
        small_angle_slope=0.0 if angles[0] == 0.0 else slope,
    )


def read_phase_function(path: Path, *, small_angle_slope: float | None = None) -> PhaseFunction:
    """Read a table of two columns with the header ``angle_deg,value``; ``#`` begins a comment.

    Parameters
    ----------
    path : Path
        Comma-separated file: angle [deg], ascending to 180; value, positive, in any unit.
    small_angle_slope : float, optional
        As in `tabled_phase_function`.

    Raises
    ------
    UserError
        When the file cannot be read, or its rows are not a phase function: a line for each fault,
        with file and line.
    """
    try:
        status = path.stat()
        table = _table(path, (status.st_mtime_ns, status.st_size), small_angle_slope)
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror}") from None
    except ForeignFileError as error:
        raise UserError(str(error)) from None
    return tabled_phase_function(name=path.name, small_angle_slope=small_angle_slope, **table)


@lru_cache(maxsize=4)
def _table(
    path: Path, stamp: tuple[int, int], small_angle_slope: float | None
) -> dict[str, FloatArray]:
    """Read a table once, in a child; another time or size of the file is another file."""
    return read_foreign(
        f"{__name__}:table_columns",
        path,
        limits=limits_for_whole(path),
        small_angle_slope=small_angle_slope,
    )


def table_columns(path: str, *, small_angle_slope: float | None) -> dict[str, FloatArray]:
    """Return ``angle`` (n,) [rad] and ``value`` (n,) of a table, in the child.

    Raises
    ------
    ReaderError
        With every fault of the file.
    """
    rows, faults = _read_rows(Path(path))
    faults += _row_faults(rows)
    angle, value = np.radians([row[1] for row in rows]), np.array([row[2] for row in rows])
    if not faults:
        angle[-1] = np.pi
        slope = _slope(angle, value) if small_angle_slope is None else small_angle_slope
        faults = [(rows[0][0], fault) for fault in _slope_faults(slope)]
    if faults:
        raise ReaderError(*(f"line {line}: {text}" for line, text in sorted(faults)))
    return {"angle": angle, "value": value}


def _interpolation(
    angle: FloatArray, value: FloatArray, slope: float
) -> Callable[[FloatArray], FloatArray]:
    log_value = np.log(value)
    positive = angle > 0.0

    def shape(theta: FloatArray) -> FloatArray:
        tabled = np.interp(np.log(theta), np.log(angle[positive]), log_value[positive])
        if angle[0] == 0.0:
            first = theta < angle[1]
            tabled[first] = np.interp(theta[first], angle, log_value)
        else:
            below = theta < angle[0]
            tabled[below] += slope * np.log(theta[below] / angle[0])
        return np.exp(tabled)

    return shape


def _slope(angle: FloatArray, value: FloatArray) -> float:
    if angle[0] == 0.0:
        return 0.0
    return float(np.log(value[1] / value[0]) / np.log(angle[1] / angle[0]))


def _slope_faults(slope: float) -> list[str]:
    if slope > -2.0:
        return []
    return [
        f"below its first angle the table goes on as angle^{slope:.3g}, which has no integral. "
        "Add smaller angles or state a small_angle_slope above -2"
    ]


def _row_faults(rows: list[Row]) -> list[tuple[int, str]]:
    faults = []
    for line, angle, value in rows:
        if not 0.0 <= angle <= 180.0 + LAST_ANGLE_TOLERANCE:
            faults.append((line, f"angle {angle:g} deg: must lie in 0 to 180"))
        if not (value > 0.0 and np.isfinite(value)):
            faults.append((line, f"value {value:g}: must be positive and finite"))
    for (_, before, _), (line, angle, _) in pairwise(rows):
        if not angle > before:
            faults.append(
                (line, f"angle {angle:g} deg after {before:g}: angles must ascend. Sort the rows")
            )
    if len(rows) < 2:
        faults.append((rows[-1][0] if rows else 1, "a table needs at least two rows"))
    elif abs(rows[-1][1] - 180.0) > LAST_ANGLE_TOLERANCE:
        faults.append((rows[-1][0], f"the table ends at {rows[-1][1]:g} deg: must reach 180"))
    return faults


def _read_rows(path: Path) -> tuple[list[Row], list[tuple[int, str]]]:
    rows: list[Row] = []
    faults: list[tuple[int, str]] = []
    header_seen = False
    for line, cells in _cells(path):
        if not header_seen:
            header_seen = True
            if cells != HEADER:
                faults.append((line, f"'{','.join(cells)}': must be the header angle_deg,value"))
            continue
        if len(cells) == 2 and all(map(is_number, cells)):
            rows.append((line, float(cells[0]), float(cells[1])))
        else:
            shown = reprlib.repr(",".join(cells))
            faults.append((line, f"{shown}: must be two numbers with a comma between"))
    return rows, faults


def _cells(path: Path) -> Iterator[tuple[int, list[str]]]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = [line.split("#", 1)[0] for line in file]
    except OSError as error:
        raise ReaderError(f"cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ReaderError("is not text. Give a CSV file in UTF-8") from None
    for number, line in enumerate(lines, start=1):
        if line.strip():
            yield number, [cell.strip() for cell in next(csv.reader([line.strip()]))]

"""What is wrong with a file of flights, and the checks that every reader shares."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from terrain.foreign.text_table import few

FloatArray = NDArray[np.float64]

LARGEST_TRACK_BYTES = 1_000_000_000
FEWEST_RECORDS = 2


class FlightFileError(ValueError):
    """A file that cannot be flown by; its text is ``file: place: what is wrong``, a line a fault.

    Parameters
    ----------
    path : Path
    faults : list of str
        ``place: what is wrong. what to do``
    """

    def __init__(self, path: Path, faults: list[str]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(f"{path}: {fault}" for fault in faults))


def content_of(path: Path, *, largest: int) -> bytes:
    """Return a file's bytes.

    Raises
    ------
    FlightFileError
        When it cannot be read, is empty or too large.
    """
    try:
        size = path.stat().st_size
        if 0 < size <= largest:
            return path.read_bytes()
    except OSError as error:
        raise FlightFileError(path, [f"cannot be read: {error.strerror}"]) from error
    fault = f"{size} bytes. Stay below {largest}" if size else "is empty"
    raise FlightFileError(path, [fault])


def text_of(path: Path) -> str:
    """Return the text of a file of a track; raises as `content_of`."""
    try:
        return content_of(path, largest=LARGEST_TRACK_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FlightFileError(path, ["not UTF-8 text. Save it as UTF-8"]) from error


def track_faults(
    columns: Mapping[str, FloatArray],
    *,
    place: Callable[[int], str],
    limits: Mapping[str, float],
) -> list[str]:
    """Return what is wrong with the columns of a track, each (n,).

    Parameters
    ----------
    columns : mapping
        By name, the time first.
    place : callable
        From a record's number to the words for where it stands.
    limits : mapping
        Greatest size of some columns.
    """
    count = len(next(iter(columns.values())))
    if count < FEWEST_RECORDS:
        return [f"{count} records. A track needs {FEWEST_RECORDS} at least"]
    faults: list[str] = []
    for name, values in columns.items():
        finite = np.isfinite(values)
        limit = limits.get(name, np.inf)
        bad, wide = _places(~finite), _places(finite & (np.abs(values) > limit))
        faults += few([f"{place(i)}: {name} is not a finite number" for i in bad])
        faults += few([f"{place(i)}: {name} {values[i]:g} is beyond {limit:g}" for i in wide])
    name, time = next(iter(columns.items()))
    back = [i + 1 for i in _places(np.diff(time) <= 0.0)]
    return faults + few(
        [
            f"{place(i)}: {name} {time[i]:.12g} is not after {time[i - 1]:.12g} before it. "
            "Sort the records and leave out doubles"
            for i in back
        ]
    )


def _places(wrong: NDArray[np.bool_]) -> list[int]:
    return [int(i) for i in np.flatnonzero(wrong)]

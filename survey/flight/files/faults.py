"""What is wrong with a file of flights, and the checks that every reader shares."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

SHOWN = 5
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
        raise FlightFileError(path, ["not UTF-8 text"]) from error


def numbers(
    rows: list[str], *, names: tuple[str, ...], separator: str | None, first_line: int
) -> FloatArray:
    """Return a table (rows, columns) of text; blank rows are left out.

    Raises
    ------
    ValueError
        With the first rows that have another number of columns or a word, a line each.
    """
    filled = [row for row in rows if row.strip()]
    if not filled:
        return np.empty((0, len(names)))
    try:
        table = np.loadtxt(filled, delimiter=separator, ndmin=2, comments=None)
        if table.shape[1] == len(names):
            return np.asarray(table)
    except ValueError:
        pass
    faults: list[str] = []
    for line, row in enumerate(rows, start=first_line):
        if row.strip():
            faults += _row_faults(row.split(separator), names, line)
        if len(faults) > SHOWN:
            faults[SHOWN:] = ["and more of the kind"]
            break
    raise ValueError("\n".join(faults))


def _row_faults(words: list[str], names: tuple[str, ...], line: int) -> list[str]:
    if len(words) != len(names):
        return [f"line {line}: {len(words)} columns, but there should be {len(names)}"]
    faults = []
    for word, name in zip(words, names, strict=True):
        try:
            float(word)
        except ValueError:
            faults.append(f"line {line}: {name} {word.strip()!r} is not a number")
    return faults


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


def few(faults: list[str]) -> list[str]:
    """Return the first faults of a kind and how many more there are.

    Examples
    --------
    >>> few(["a"] * 8)[-2:]
    ['a', 'and 3 more of the kind']
    """
    if len(faults) <= SHOWN:
        return faults
    return [*faults[:SHOWN], f"and {len(faults) - SHOWN} more of the kind"]

"""Tables of numbers in text files."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

SHOWN = 5


def numbers(
    rows: list[str], *, names: tuple[str, ...], separator: str | None, first_line: int
) -> NDArray[np.float64]:
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
        if not is_number(word):
            faults.append(f"line {line}: {name} {word.strip()!r} is not a number")
    return faults


def doubled(names: Sequence[str]) -> list[str]:
    """Return the fault of each name in a header that stands there twice.

    Examples
    --------
    >>> doubled(["x", "y", "x"])
    ['line 1: column x stands there twice. Leave one out']
    """
    twice = sorted({name for name in names if names.count(name) > 1})
    return [f"line 1: column {name} stands there twice. Leave one out" for name in twice]


def is_number(word: str) -> bool:
    """Tell whether a word of a file is a number: in plain digits, without marks between them.

    Examples
    --------
    >>> is_number(" -1.5e3"), is_number("1_000"), is_number("\u0661\u0662"), is_number("nan")
    (True, False, False, True)
    """
    try:
        float(word)
    except ValueError:
        return False
    return word.isascii() and "_" not in word


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

"""Columns of whole numbers as few bytes, unpacked by `assets/decode.js`.

Differences of neighbours, zigzag (0, -1, 1, -2 ... become 0, 1, 2, 3 ...), bytes of equal weight
together, deflate: points that lie in the order of their pixels differ little from the one before.
"""

from __future__ import annotations

import zlib
from base64 import b64encode
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

IntArray = NDArray[np.int64]
LARGEST = 2**30
"""A difference of two such values still fits into the 32 bits of the page's integers."""


def packed(columns: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Return columns of integers as the page's JSON holds them.

    Parameters
    ----------
    columns : mapping of name to array (n,)
        Whole numbers between -2^30 and 2^30.

    Returns
    -------
    dict
        ``count``, ``columns`` (name and bytes a value, in order) and ``data``, base64.

    Raises
    ------
    ValueError
        If a value is too large, or the columns are not equally long.

    Examples
    --------
    >>> found = packed({"frame": np.array([7, 7, 8]), "error": np.array([0, -300, 5])})
    >>> found["count"], found["columns"]
    (3, [{'name': 'frame', 'bytes': 1}, {'name': 'error', 'bytes': 2}])
    """
    lengths = {len(column) for column in columns.values()}
    if len(lengths) > 1:
        raise ValueError(f"columns: lengths {sorted(lengths)} in one table. Give equal ones")
    planes = {name: _planes(name, column) for name, column in columns.items()}
    content = b"".join(plane.tobytes() for plane in planes.values())
    return {
        "count": lengths.pop() if lengths else 0,
        "columns": [{"name": name, "bytes": len(plane)} for name, plane in planes.items()],
        "data": b64encode(zlib.compress(content, 9)).decode("ascii"),
    }


def rounded(values: NDArray[Any], step: float) -> IntArray:
    """Return values in whole steps, from 1 on, and 0 for nan; see `start_of`.

    Examples
    --------
    >>> rounded(np.array([0.5, np.nan, 0.61]), 0.05).tolist()
    [1, 0, 3]
    """
    steps = np.round(np.asarray(values, np.float64) / step)
    start = start_of(values, step)
    return np.where(np.isfinite(steps), steps - start + 1, 0).astype(np.int64)


def start_of(values: NDArray[Any], step: float) -> int:
    """Return the number of steps for which `rounded` writes 1: the least of the finite values."""
    finite = np.asarray(values, np.float64)[np.isfinite(values)]
    return int(np.round(finite.min() / step)) if finite.size else 0


def logarithmic(values: NDArray[Any], *, least: float, step: float) -> IntArray:
    """Return logarithms in whole steps, from 1 on; 0 stands for all below the least and for nan.

    Parameters
    ----------
    values : array
    least : float
        Written as 1.
    step : float
        Ratio of neighbours less 1: 0.02 rounds to 1 %.

    Examples
    --------
    >>> logarithmic(np.array([0.0, 1e-3, 1.0, 1.02]), least=1e-3, step=0.02).tolist()
    [0, 1, 350, 351]
    """
    values = np.nan_to_num(np.asarray(values, np.float64), nan=0.0)
    exponents = np.log(np.maximum(values, least) / least) / np.log1p(step)
    return np.where(values < least, 0, np.round(exponents) + 1).astype(np.int64)


def _planes(name: str, column: NDArray[Any]) -> NDArray[np.uint8]:
    """Return a column's bytes (bytes, n), the low ones first, as many as it needs."""
    values = np.asarray(column).astype(np.int64)
    if values.size and np.abs(values).max() > LARGEST:
        raise ValueError(
            f"{name}: {values[np.abs(values).argmax()]} does not fit. Use larger steps"
        )
    difference = np.diff(values, prepend=0)
    zigzag = np.where(difference < 0, -2 * difference - 1, 2 * difference).astype("<u4")
    count = max((int(zigzag.max(initial=0)).bit_length() + 7) // 8, 1)
    return zigzag.view(np.uint8).reshape(-1, 4).T[:count].copy()

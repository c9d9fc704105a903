"""How many places of each kind lie near the centres of the cells of a raster."""

from __future__ import annotations

from math import ceil, floor, sqrt

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import kernel

FloatArray = NDArray[np.float64]


def count_near(
    places: FloatArray,
    kinds: NDArray[np.uint8],
    *,
    number_of_kinds: int,
    shape: tuple[int, int],
    west: float,
    north: float,
    cell_size: float,
    reach: float,
) -> NDArray[np.uint32]:
    """Count the places within a distance of each cell's centre.

    Parameters
    ----------
    places : array (n, 2)
        Finite, on the map [m].
    kinds : array (n,)
        Below ``number_of_kinds``.
    shape : tuple of int
        Rows southward and columns eastward.
    west, north, cell_size : float
        Outer corner of the raster, and the side of its cells [m].
    reach : float
        Distance [m].

    Returns
    -------
    array (number_of_kinds, rows, columns)

    Examples
    --------
    >>> count_near(np.array([[1.0, 2.4]]), np.array([1], np.uint8), number_of_kinds=2,
    ...            shape=(3, 3), west=0.0, north=3.0, cell_size=1.0, reach=0.6)[1]
    array([[1, 1, 0],
           [0, 0, 0],
           [0, 0, 0]], dtype=uint32)
    """
    counts = np.zeros((number_of_kinds, *shape), np.uint32)
    x, y = (places[:, 0] - west) / cell_size - 0.5, (north - places[:, 1]) / cell_size - 0.5
    _count(counts, x, y, kinds, reach / cell_size)
    return counts


@kernel
def _count(
    counts: NDArray[np.uint32],
    x: FloatArray,
    y: FloatArray,
    kinds: NDArray[np.uint8],
    reach: float,
) -> None:
    _, rows, columns = counts.shape
    for i in range(x.size):
        for row in range(max(ceil(y[i] - reach), 0), min(floor(y[i] + reach), rows - 1) + 1):
            half = sqrt(max(reach**2 - (row - y[i]) ** 2, 0.0))
            first, last = max(ceil(x[i] - half), 0), min(floor(x[i] + half), columns - 1)
            for column in range(first, last + 1):
                counts[kinds[i], row, column] += 1

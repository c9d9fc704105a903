"""Sums over gates; arrays (pixels, bins)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import kernel

FloatArray = NDArray[np.float64]


@kernel
def windowed(values: FloatArray, width: int, result: FloatArray) -> None:
    """Write the sums of ``width`` bins, an odd number, around every bin."""
    bins, half = values.shape[1], width // 2
    for pixel in range(values.shape[0]):
        row, sums = values[pixel], result[pixel]
        total = 0.0
        for i in range(min(half, bins)):
            total += row[i]
        for i in range(bins):
            if i + half < bins:
                total += row[i + half]
            if i > half:
                total -= row[i - half - 1]
            sums[i] = total

"""Sums over gates; arrays (pixels, bins)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import kernel

FloatArray = NDArray[np.float64]


@kernel
def windowed(values: FloatArray, width: int, running: FloatArray, result: FloatArray) -> None:
    """Write the sums of ``width`` bins, an odd number, around every bin.

    They are differences of sums from the beginning, ``running`` (bins + 1,): those of nothing
    negative never fall, so neither can a difference be negative.
    """
    bins, half = values.shape[1], width // 2
    for pixel in range(values.shape[0]):
        row, sums = values[pixel], result[pixel]
        running[0] = 0.0
        for i in range(bins):
            running[i + 1] = running[i] + row[i]
        for i in range(bins):
            sums[i] = running[min(bins, i + half + 1)] - running[max(0, i - half)]

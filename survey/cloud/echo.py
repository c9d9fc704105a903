"""One echo in each pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class Echo:
    """One echo in each pixel; arrays (rows, columns), nan where there is none.

    Parameters
    ----------
    time : array
        Two-way time [s].
    counts : array
        Counts above the expected noise [1].
    snr : array
        Those counts over the standard deviation of all counts in the gate, the detector's own
        noise included [1].
    time_error : array
        Standard error of `time` by the chance of counts alone, those of sun, darkness and column
        included [s]. Left out are how the water shifts and stretches the echo, the Monte Carlo's
        error, and what dead time does to first photons.
    """

    time: FloatArray
    counts: FloatArray
    snr: FloatArray
    time_error: FloatArray

    @property
    def found(self) -> BoolArray:
        """Tell which pixels have the echo."""
        return np.isfinite(self.time)

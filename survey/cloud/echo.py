"""One echo in each pixel."""

from __future__ import annotations

from dataclasses import dataclass, fields

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

    def only(self, which: BoolArray) -> Echo:
        """Return the echoes of some pixels, none in the others.

        Examples
        --------
        >>> two = np.array([1.0, 2.0])
        >>> echo = Echo(time=two, counts=two, snr=two, time_error=two)
        >>> echo.only(np.array([True, False])).found.tolist()
        [True, False]
        """
        columns = {field.name: getattr(self, field.name) for field in fields(self)}
        return Echo(**{name: np.where(which, column, np.nan) for name, column in columns.items()})

"""The ideal photon counter of [Lisenko2017]."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.sensor.detector import Readings
from survey.sensor.scatter import Scatter

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class IdealCounter:
    """Counts every photo-electron; no dead time, no afterpulses.

    Parameters
    ----------
    quantum_efficiency : float
        Photo-electrons per photon, 0 to 1 [1].
    dark_count_rate : float
        Counts in the dark, per pixel [1/s].
    max_counts_per_bin : int
        Where the counter of a bin is full.
    pulses : int
        Pulses of a frame, whose counts are summed.

    Examples
    --------
    >>> counter = IdealCounter(quantum_efficiency=0.2, dark_count_rate=0.0, max_counts_per_bin=9)
    >>> readings = counter.read(np.array([[[0.0, 1e6]]]), np.random.default_rng(1))
    >>> readings.counts.tolist(), readings.blind.tolist()
    ([[[0, 9]]], [[[False, True]]])
    """

    quantum_efficiency: float
    dark_count_rate: float
    max_counts_per_bin: int
    pulses: int = 1
    timing_sigma: float = 0.0

    @property
    def photo_electrons_per_photon(self) -> float:
        """Photo-electrons per photon behind the optics [1]."""
        return self.quantum_efficiency

    def read(self, light: FloatArray, chance: np.random.Generator) -> Readings:
        """Draw counts for expected photo-electrons of any shape, equation (9) of [Lisenko2017]."""
        drawn = chance.poisson(light * self.pulses)
        counts = np.minimum(drawn, self.max_counts_per_bin).astype(np.int32)
        return Readings(counts=counts, blind=counts >= self.max_counts_per_bin)

    def mean(self, light: FloatArray) -> FloatArray:
        """Return the mean counts."""
        return light * self.pulses

    def scatter(self, light: FloatArray, mean: FloatArray) -> Scatter:
        """Counts scatter as Poisson's."""
        return Scatter.poisson(mean)

    def added(self, light: FloatArray, more: FloatArray, mean: FloatArray) -> FloatArray:
        """Return the mean counts that more light adds, whatever was there."""
        return more * self.pulses

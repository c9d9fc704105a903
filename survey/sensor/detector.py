"""From expected photo-electrons to counts: the ideal photon counter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import pdtrc
from scipy.stats import poisson

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
        Where the counter of a bin is full; a full bin says that the pixel is saturated.
    """

    quantum_efficiency: float
    dark_count_rate: float
    max_counts_per_bin: int

    def count(self, expected: FloatArray, chance: np.random.Generator) -> NDArray[np.int32]:
        """Draw counts for expected photo-electrons of any shape, equation (9) of [Lisenko2017]."""
        return np.minimum(chance.poisson(expected), self.max_counts_per_bin).astype(np.int32)

    def saturated(self, counts: NDArray[np.int32]) -> NDArray[np.bool_]:
        """Tell which pixels have a full bin; the last axis is time."""
        return np.asarray((counts >= self.max_counts_per_bin).any(axis=-1))


def firing_probability(*, threshold: FloatArray, mean: FloatArray) -> FloatArray:
    """Probability of at least ``threshold`` counts, equation (11) of [Lisenko2017] [1].

    Examples
    --------
    >>> round(float(firing_probability(threshold=np.array(1.0), mean=np.array(0.5))), 6)
    0.393469
    """
    return np.asarray(pdtrc(threshold - 1.0, mean))


def firing_threshold(*, false_alarm: float, noise: FloatArray) -> FloatArray:
    """Smallest count that noise alone reaches with at most this probability.

    Parameters
    ----------
    false_alarm : float
        Probability, above 0 and below 1 [1].
    noise : array
        Mean counts of the noise [1].

    Examples
    --------
    >>> firing_threshold(false_alarm=1e-3, noise=np.array([0.01, 1.0])).tolist()
    [2.0, 6.0]
    """
    return np.asarray(poisson.isf(false_alarm, noise) + 1.0)

"""How a detector's readings scatter, and the thresholds that noise reaches seldom enough."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from survey.sensor.photon_counting import firing_probability, firing_threshold

FloatArray = NDArray[np.float64]

SMALLEST_TILT, LARGEST_TILT, TILTS = 1e-6, 30.0, 240


@dataclass(frozen=True, kw_only=True)
class Scatter:
    """Readings: a Poisson number of counts, each of them with a random gain, and added noise.

    Where the gain is sure and nothing is added, readings are Poisson counts.

    Parameters
    ----------
    mean : array
        Mean reading [counts].
    gain_variance : array
        Variance of the gain of one count, whose mean is 1; F - 1, F being the excess noise factor.
    added_variance : array
        Variance of Gaussian noise that is there without any count [counts^2].
    """

    mean: FloatArray
    gain_variance: FloatArray
    added_variance: FloatArray

    @classmethod
    def poisson(cls, mean: FloatArray) -> Scatter:
        """Return that of plain counts."""
        nothing = np.zeros_like(mean)
        return cls(mean=mean, gain_variance=nothing, added_variance=nothing)

    @property
    def variance(self) -> FloatArray:
        """Variance of the readings [counts^2]."""
        return self.mean * (1.0 + self.gain_variance) + self.added_variance

    def at(self, place: NDArray[np.int64]) -> Scatter:
        """Return the readings at places (..., 1) along the last axis."""
        parts = (self.mean, self.gain_variance, self.added_variance)
        mean, gain_variance, added_variance = (
            np.take_along_axis(part, place, -1) for part in parts
        )
        return Scatter(mean=mean, gain_variance=gain_variance, added_variance=added_variance)

    def threshold(self, false_alarm: float) -> FloatArray:
        """Smallest reading that is reached with at most this probability.

        Poisson counts have the threshold of equation (11) of [Lisenko2017]. Other readings have
        Chernoff's bound, which their tail never exceeds: P(R >= T) <= exp[K(s) - s T] for every
        s > 0. K(s) = -(mean / v) ln[1 - v (e^s - 1)] + added s^2 / 2 is that of a negative
        binomial reading, not less than that of gains that follow a gamma distribution, or of
        clusters of geometric size, with the same variance. The largest v of all is taken.

        Examples
        --------
        >>> counts = Scatter.poisson(np.array([2.0]))
        >>> amplified = Scatter(mean=np.array([2.0]), gain_variance=np.array([1.5]),
        ...                     added_variance=np.array([4.0]))
        >>> [round(float(noise.threshold(1e-3)[0]), 1) for noise in (counts, amplified)]
        [9.0, 22.0]
        """
        plain = (self.gain_variance == 0.0) & (self.added_variance == 0.0)
        result = np.empty_like(self.mean)
        result[plain] = firing_threshold(false_alarm=false_alarm, noise=self.mean[plain])
        result[~plain] = _chernoff(
            mean=self.mean[~plain],
            gain_variance=float(self.gain_variance.max(initial=0.0)),
            added_variance=self.added_variance[~plain],
            false_alarm=false_alarm,
        )
        return result

    def firing_probability(self, threshold: FloatArray) -> FloatArray:
        """Probability of reaching a threshold: equation (11), or normal where gains scatter."""
        plain = (self.gain_variance == 0.0) & (self.added_variance == 0.0)
        whole = np.maximum(np.ceil(threshold), 1.0)
        spread = np.sqrt(np.where(plain, 1.0, self.variance))
        return np.where(
            plain,
            firing_probability(threshold=whole, mean=np.maximum(self.mean, 0.0)),
            ndtr((self.mean - threshold) / spread),
        )


def _chernoff(
    *, mean: FloatArray, gain_variance: float, added_variance: FloatArray, false_alarm: float
) -> FloatArray:
    """Return the lowest bound of many tilts; every one of them is true."""
    highest = LARGEST_TILT
    if gain_variance > 0.0:
        highest = min(highest, 0.999 * float(np.log1p(1.0 / gain_variance)))
    best = np.full(mean.shape, np.inf)
    for tilt in np.geomspace(SMALLEST_TILT, highest, TILTS):
        growth = np.expm1(tilt)
        if gain_variance > 0.0:
            growth = -np.log1p(-gain_variance * growth) / gain_variance
        bound = mean * (growth / tilt) + added_variance * (0.5 * tilt) - np.log(false_alarm) / tilt
        np.minimum(best, bound, out=best)
    return best

"""How far noise reaches: tails of weighted sums of counts, as rare as a matched filter needs them.

A filter adds the counts of neighbouring bins, each times its weight. Over noise that is even within
the filter's length the tail of that sum depends on the noise's variance alone, so that one table
holds it for every gate, pixel and flash.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from survey.cloud.kernels.matched_filter import interpolated

FloatArray = NDArray[np.float64]

STEPS = 32  # of the grid on which a sum is told, in the largest weight
FAINTEST, STRONGEST = 1e-6, 50.0  # variances between which the sum's distribution is computed
ENDLESS = 1e16
POINTS_PER_DECADE = 12
ROOM = 16.0  # standard deviations above the mean that the computed distribution reaches


@dataclass(frozen=True, kw_only=True)
class TailTable:
    """Thresholds above the mean of a weighted sum of counts, by its variance.

    Parameters
    ----------
    log_variance : array (n,)
        Natural logarithms of the variances, evenly spaced.
    deviations : array (n,)
        Threshold less mean, in standard deviations.
    """

    log_variance: FloatArray
    deviations: FloatArray

    @classmethod
    def build(cls, *, weights: FloatArray, false_alarm: float, gain_variance: float) -> TailTable:
        """Compute the thresholds that noise reaches with at most this probability.

        Parameters
        ----------
        weights : array (taps,)
            Of the bins, the largest of them 1.
        false_alarm : float
            Probability, above 0 and below 1 [1].
        gain_variance : float
            Variance of the gain of one count, whose mean is 1; counts are then negative binomial,
            as in `survey.sensor.scatter.Scatter.threshold`.

        Examples
        --------
        >>> one_bin = TailTable.build(weights=np.ones(1), false_alarm=1e-3, gain_variance=0.0)
        >>> print(1.0 + one_bin.above(np.array([1.0])).round(2))  # more than 5 counts of mean 1
        [5.03]
        """
        decades = np.log10(ENDLESS / FAINTEST)
        variance = np.geomspace(FAINTEST, ENDLESS, int(decades * POINTS_PER_DECADE) + 1)
        few = variance <= STRONGEST
        above = [_counted(v, weights, false_alarm, gain_variance) for v in variance[few]]
        many = _expanded(variance[~few], weights, false_alarm, gain_variance)
        deviations = np.concatenate([above / np.sqrt(variance[few]), many])
        return cls(log_variance=np.log(variance), deviations=deviations)

    def above(self, variance: NDArray[np.floating]) -> NDArray[np.float32]:
        """Return by how much a sum of such variance must exceed its mean."""
        given = np.ascontiguousarray(variance, dtype=np.float32)
        result = np.empty_like(given)
        first, second = self.log_variance[:2]
        interpolated(given.reshape(-1), first, second - first, self.deviations, result.reshape(-1))
        return result


def _rate(variance: float, weights: FloatArray, gain_variance: float) -> float:
    """Return the mean counts of a bin that give the sum this variance."""
    return float(variance / ((1.0 + gain_variance) * (weights**2).sum()))


def _counted(
    variance: float, weights: FloatArray, false_alarm: float, gain_variance: float
) -> float:
    """Return threshold less mean from the sum's own distribution.

    Its characteristic function is the product of the bins', its distribution the transform of it;
    weights are rounded to 1/32 of the largest.
    """
    rate = _rate(variance, weights, gain_variance)
    mean = rate * weights.sum()
    reach = mean + ROOM * (1.0 + gain_variance) * (np.sqrt(variance) + 1.0)
    size = 1 << int(np.ceil(np.log2(reach * STEPS)))
    turn = np.exp(-2j * np.pi * np.arange(size // 2 + 1) / size)
    growth = sum(
        _cumulant(turn ** int(step) - 1.0, gain_variance) for step in np.round(weights * STEPS)
    )
    chance = np.fft.irfft(np.exp(rate * growth), n=size)
    reached = np.cumsum(chance[::-1])[::-1]
    return float((reached <= false_alarm).argmax() / STEPS - mean)


def _cumulant(growth: NDArray[np.complex128], gain_variance: float) -> NDArray[np.complex128]:
    """Return the logarithm of a count's generating function, for a mean of one count."""
    if gain_variance == 0.0:
        return growth
    return np.asarray(-np.log(1.0 - gain_variance * growth) / gain_variance)


def _expanded(
    variance: FloatArray, weights: FloatArray, false_alarm: float, gain_variance: float
) -> FloatArray:
    """Return the threshold of many counts in deviations, by Cornish's and Fisher's expansion."""
    v, z = gain_variance, float(norm.isf(false_alarm))
    rate = variance / ((1.0 + v) * (weights**2).sum())
    skew = rate * (weights**3).sum() * (1.0 + v) * (1.0 + 2.0 * v) / variance**1.5
    fourth = (1.0 + v) * (1.0 + 6.0 * v + 6.0 * v**2)
    excess = rate * (weights**4).sum() * fourth / variance**2
    bend = (z**3 - 3.0 * z) / 24.0 * excess - (2.0 * z**3 - 5.0 * z) / 36.0 * skew**2
    return np.asarray(z + (z**2 - 1.0) / 6.0 * skew + bend)

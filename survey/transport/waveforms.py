"""Expected photo-electrons by origin, with their variance, and how a pulse blurs them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from survey.transport.join import TimeBins
from terrain.kernels import kernel

FloatArray = NDArray[np.float64]

ORIGINS = ("surface", "column", "bottom")
PULSE_REACH = 4.5


@dataclass(frozen=True, kw_only=True)
class Waveforms:
    """What every pixel of one flash may expect to count.

    Light that has touched bottom or land is ``bottom``; other light from under the surface is
    ``column``.

    Parameters
    ----------
    photo_electrons : array (3, rows, columns, bins)
        Mean photo-electrons by origin, in the order of `ORIGINS` [1].
    variance : array (3, rows, columns, bins)
        Squared Monte Carlo standard error of the same; the surface is computed without chance.
    bin_start, bin_width : float
        Early edge of the first bin after emission, and width of the bins [s].
    ledger : dict
        Energy balance of the forward walks by name, in launched photons.
    """

    photo_electrons: FloatArray
    variance: FloatArray
    bin_start: float
    bin_width: float
    ledger: dict[str, float]

    @property
    def total(self) -> FloatArray:
        """Mean photo-electrons of all origins (rows, columns, bins)."""
        return np.asarray(self.photo_electrons.sum(axis=0))

    @property
    def times(self) -> FloatArray:
        """Centres of the bins after emission [s]."""
        bins = self.photo_electrons.shape[-1]
        return np.asarray(self.bin_start + (np.arange(bins) + 0.5) * self.bin_width)

    def origin(self, name: str) -> FloatArray:
        """Return the mean photo-electrons of one origin (rows, columns, bins)."""
        return np.asarray(self.photo_electrons[ORIGINS.index(name)])


def padded_bins(*, start: float, width: float, bins: int, sigma: float) -> tuple[TimeBins, int]:
    """Return the gate's bins with room on both sides for the pulse, and how many were added."""
    pad = int(np.ceil(PULSE_REACH * sigma / width)) + 1
    return TimeBins(start=start - pad * width, width=width, number=bins + 2 * pad), pad


def pulse_taps(*, sigma: float, width: float, pad: int) -> FloatArray:
    """Return the share of a Gaussian pulse in each bin around its own, (2 pad + 1,).

    Examples
    --------
    >>> taps = pulse_taps(sigma=4.0, width=1.0, pad=19)
    >>> bool(abs(taps.sum() - 1.0) < 1e-12), bool(taps.argmax() == 19)
    (True, True)
    """
    if sigma == 0.0:
        return np.asarray(np.eye(2 * pad + 1)[pad], dtype=np.float64)
    edges = (np.arange(-pad, pad + 2) - 0.5) * width / sigma
    taps = np.diff(ndtr(edges))
    return np.asarray(taps / taps.sum())


@kernel
def blurred(histogram: NDArray[np.floating], taps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Convolve each row with the pulse and cut the padding off."""
    pad = taps.shape[0] // 2
    bins = histogram.shape[1] - 2 * pad
    result = np.zeros((histogram.shape[0], bins))
    for row in range(histogram.shape[0]):
        for i in range(histogram.shape[1]):
            photons = histogram[row, i]
            if photons == 0.0:
                continue
            low, high = max(0, i - 2 * pad), min(bins, i + 1)
            for j in range(low, high):
                result[row, j] += photons * taps[j - i + 2 * pad]
    return result


@dataclass(kw_only=True)
class Replicates:
    """Running sums over independent repetitions of the same estimate.

    Examples
    --------
    >>> sums = Replicates(shape=(1,))
    >>> for value in (1.0, 3.0):
    ...     sums.add(np.array([value]))
    >>> float(sums.mean[0]), float(sums.variance_of_mean[0])
    (2.0, 1.0)
    """

    shape: tuple[int, ...]
    count: int = 0
    _sum: FloatArray = field(init=False)
    _squares: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self._sum = np.zeros(self.shape)
        self._squares = np.zeros(self.shape)

    def add(self, value: FloatArray) -> None:
        """Add one repetition."""
        self._sum += value
        self._squares += value * value
        self.count += 1

    @property
    def mean(self) -> FloatArray:
        """Mean of the repetitions."""
        return np.asarray(self._sum / self.count)

    @property
    def variance_of_mean(self) -> FloatArray:
        """Squared standard error of the mean."""
        spread = self._squares / self.count - self.mean**2
        return np.asarray(np.maximum(spread, 0.0) / (self.count - 1))


def crossed_variance(forward: Replicates, backward: Replicates, matched: Replicates) -> FloatArray:
    """Return the squared standard error of a mean over all pairs of two kinds of batches.

    With R batches of each kind, X_ij = m + f_i + b_j + g_ij has the mean's variance
    (s_f + s_b) / R + s_g / R^2. The means over the other kind, X_i. and X_.j, scatter by
    s_f + s_g / R and s_b + s_g / R; the matched X_ii by s_f + s_b + s_g. The pairing's part s_g is
    solved for, and kept within what it can be.

    Examples
    --------
    >>> chance = np.random.default_rng(1)
    >>> grid = chance.normal(size=(400, 1)) + chance.normal(size=400)
    >>> grid += 3.0 * chance.normal(size=(400, 400))
    >>> sums = [Replicates(shape=(1,)) for _ in range(3)]
    >>> for i in range(400):
    ...     for sum_, value in zip(sums, (grid[i].mean(), grid[:, i].mean(), grid[i, i])):
    ...         sum_.add(np.array([value]))
    >>> bool(abs(crossed_variance(*sums)[0] * 400 / (2 + 9 / 400) - 1) < 0.1)
    True
    """
    batches = forward.count
    apart = forward.variance_of_mean + backward.variance_of_mean
    pairing = (matched.variance_of_mean - apart) / (batches - 2.0)
    return np.asarray(apart - np.clip(pairing, 0.0, 0.5 * apart))

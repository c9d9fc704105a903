"""Expected photo-electrons by origin, with their variance, and how a pulse blurs them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from survey.transport.tally import TimeBins
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
    scatterings : int
        Scatterings on all walks of the flash.
    ledger : dict
        What became of the walks from the pixels, by name, as shares of all.
    """

    photo_electrons: NDArray[np.float32]
    variance: NDArray[np.float32]
    bin_start: float
    bin_width: float
    scatterings: int
    ledger: dict[str, float]

    @property
    def total(self) -> FloatArray:
        """Mean photo-electrons of all origins (rows, columns, bins)."""
        return np.asarray(self.photo_electrons.sum(axis=0, dtype=np.float64))

    @property
    def times(self) -> FloatArray:
        """Centres of the bins after emission [s]."""
        bins = self.photo_electrons.shape[-1]
        return np.asarray(self.bin_start + (np.arange(bins) + 0.5) * self.bin_width)

    def origin(self, name: str) -> FloatArray:
        """Return the mean photo-electrons of one origin (rows, columns, bins)."""
        return np.asarray(self.photo_electrons[ORIGINS.index(name)], dtype=np.float64)


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

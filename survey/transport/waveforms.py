"""Expected photo-electrons by origin, with their variance, and how a pulse blurs them."""

from __future__ import annotations

from dataclasses import dataclass

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


@kernel
def crossed_variance(
    batches: NDArray[np.float32], taps: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the squared standard error of a mean over all pairs of two kinds of batches.

    With R batches of each kind, X_ij = m + f_i + b_j + g_ij has the mean's variance
    (s_f + s_b) / R + s_g / R^2. The means over the other kind, X_i. and X_.j, scatter by
    s_f + s_g / R and s_b + s_g / R; the matched X_ii by s_f + s_b + s_g. The pairing's part s_g is
    solved for, and kept within what it can be.

    Parameters
    ----------
    batches : array (3, R, origins, pixels, bins)
        X_i., X_.j and X_ii, without the pulse's width.
    taps : array (odd number,)
        The pulse, with which every row is convolved first.

    Returns
    -------
    array (origins, pixels, bins)
    """
    _, count, origins, pixels, bins = batches.shape
    result = np.empty((origins, pixels, bins), np.float32)
    half = taps.shape[0] // 2
    for origin in range(origins):
        for pixel in range(pixels):
            total = np.zeros((3, bins), np.float32)
            squares = np.zeros((3, bins), np.float32)
            row = np.empty(bins, np.float32)
            for side in range(3):
                for batch in range(count):
                    row[:] = 0.0
                    for i in range(bins):
                        photons = batches[side, batch, origin, pixel, i]
                        if photons != 0.0:
                            for j in range(max(0, i - half), min(bins, i + half + 1)):
                                row[j] += photons * taps[j - i + half]
                    total[side] += row
                    squares[side] += row * row
            for i in range(bins):
                scatter = squares[:, i] - total[:, i] * total[:, i] / count
                scatter /= count * (count - 1.0)
                apart = scatter[0] + scatter[1]
                pairing = (scatter[2] - apart) / (count - 2.0)
                result[origin, pixel, i] = apart - min(max(pairing, 0.0), 0.5 * apart)
    return result

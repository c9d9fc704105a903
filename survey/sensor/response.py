"""How timing jitter and limited bandwidth spread readings over neighbouring bins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d
from scipy.special import ndtr

FloatArray = NDArray[np.float64]

REACH = 5.0


def spread(values: FloatArray, *, sigma: float) -> FloatArray:
    """Spread bins of the last axis by a Gaussian; what leaves the gate is lost.

    A bin's content is even over the bin.

    Parameters
    ----------
    values : array (..., bins)
    sigma : float
        Standard deviation [bins].

    Examples
    --------
    >>> spread(np.array([0.0, 0.0, 1.0, 0.0, 0.0]), sigma=0.2).round(4).tolist()
    [0.0, 0.0798, 0.8404, 0.0798, 0.0]
    """
    if sigma == 0.0:
        return values
    taps = bin_shares(sigma)
    return np.asarray(convolve1d(values, taps, axis=-1, mode="constant"))


def bin_shares(sigma: float) -> FloatArray:
    """Return which share of a bin's content ends up in each bin around it (odd number,).

    The second difference of the twice integrated Gaussian, x Phi(x/s) + s phi(x/s).
    """
    reach = int(np.ceil(REACH * sigma)) + 1
    edges = np.arange(-reach - 1.0, reach + 2.0)
    scaled = edges / sigma
    integral = edges * ndtr(scaled) + sigma * np.exp(-0.5 * scaled**2) / np.sqrt(2.0 * np.pi)
    return np.asarray(np.diff(integral, n=2))

"""Echoes that stand alone: noise, by the company they keep."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

SIDE = 7
AGREEMENT = 1.0  # [m]


def stands_alone(elevation: FloatArray, which: BoolArray) -> BoolArray:
    """Tell which echoes no other of the 48 pixels around agrees with to 1 m (rows, columns).

    Where detectors fire falsely once in p pixels, evenly over a depth of D, a false echo finds
    company with probability 1 - (1 - 2 p / D)^48, below 1 % for p = 1e-3 and D = 10 m. Where a
    share q of the pixels has its true echo, on a bed that 3 pixels to the side differs by less
    than 1 m, a true one stands alone with probability (1 - q)^48: 0.6 % at q = 0.1, 62 % at 0.01.

    Parameters
    ----------
    elevation : array (rows, columns)
        [m].
    which : array (rows, columns)
        Pixels that have such an echo.

    Examples
    --------
    >>> elevation = np.array([[-4.0, -4.3, 2.0, -4.1]])
    >>> stands_alone(elevation, np.ones((1, 4), np.bool_)).tolist()
    [[False, False, True, False]]
    """
    around = _around(elevation, which)
    agrees = np.abs(around - elevation[which][:, None, None]) <= AGREEMENT
    alone = np.zeros(which.shape, np.bool_)
    alone[which] = agrees.sum(axis=(1, 2)) <= 1  # the echo itself
    return alone


def stands_high(elevation: FloatArray, which: BoolArray) -> BoolArray:
    """Tell which echoes lie above the median of those in the 7 x 7 pixels around, their own too.

    An echo without any company is compared with all echoes of the frame.
    """
    around = _around(elevation, which).reshape(-1, SIDE * SIDE)
    high = np.zeros(which.shape, np.bool_)
    if which.any():
        company = np.isfinite(around).sum(axis=1) > 1
        typical = np.where(company, np.nanmedian(around, axis=1), np.median(elevation[which]))
        high[which] = elevation[which] > typical
    return high


def _around(elevation: FloatArray, which: BoolArray) -> FloatArray:
    """Return elevations around every echo (m, 7, 7), nan where there is no echo."""
    padded = np.pad(np.where(which, elevation, np.nan), SIDE // 2, constant_values=np.nan)
    return np.lib.stride_tricks.sliding_window_view(padded, (SIDE, SIDE))[which]

"""Into which directions waves run: the spreading cos^2s of half the angle."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.constants import g
from scipy.special import gammaln

from terrain.waves.spectrum import WindSea

FloatArray = NDArray[np.float64]

LEAST = 1.0


def spread(angle: FloatArray, s: FloatArray | float) -> FloatArray:
    """Return the share of waves by direction, over a full turn one [1/rad].

    Gamma(s + 1) / [2 sqrt(pi) Gamma(s + 1/2)] cos^2s(angle / 2), Longuet-Higgins, Cartwright and
    Smith (1963).

    Parameters
    ----------
    angle : array
        From the direction that most waves run to [rad].
    s : array or float
        How narrow; 0 is even all round [1].

    Examples
    --------
    >>> spread(np.array([0.0, np.pi / 2, np.pi]), 2.0).round(4)
    array([0.4244, 0.1061, 0.    ])
    """
    scale = np.exp(gammaln(np.add(s, 1.0)) - gammaln(np.add(s, 0.5))) / (2.0 * np.sqrt(pi))
    return np.asarray(scale * np.abs(np.cos(0.5 * angle)) ** (2.0 * np.asarray(s)))


def narrowness(frequency: FloatArray, sea: WindSea) -> FloatArray:
    """Return s of wind waves by their frequency [1], Hasselmann, Dunckel and Ewing (1980).

    6.97 (f / f_p)^4.06 below the peak and 9.77 (f / f_p)^mu above it, with
    mu = -2.33 - 1.45 (U10 / c_p - 1.17) and c_p = g / (2 pi f_p). Read in two public codes that
    agree. Departure: never below 1; less would send more waves across the wind than along it.

    Parameters
    ----------
    frequency : array
        [Hz].
    sea : WindSea

    Examples
    --------
    >>> sea = WindSea.fully_developed(wind_speed=10.0)
    >>> narrowness(np.array([0.5, 1.001, 2.0, 10.0]) * sea.peak_frequency, sea).round(2)
    array([1.  , 9.75, 2.77, 1.  ])
    """
    ratio = frequency / sea.peak_frequency
    wind_over_wave = 2.0 * pi * sea.peak_frequency * sea.wind_speed / g
    fall = -2.33 - 1.45 * (wind_over_wave - 1.17)
    s = np.where(ratio <= 1.0, 6.97 * ratio**4.06, 9.77 * ratio**fall)
    return np.asarray(np.maximum(s, LEAST))

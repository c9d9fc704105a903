"""How fast waves of a length run over water of a depth: linear theory of gravity waves.

Departure: no surface tension. At a wavelength of 0.1 m it adds 1.5 % to the speed, above it less.
"""

from __future__ import annotations

from math import pi, sqrt, tanh

import numpy as np
from numpy.typing import NDArray
from scipy.constants import g

FloatArray = NDArray[np.float64]

FLATTENED = 300.0  # hyperbolic functions of more are those of infinity
NEWTON_STEPS = 12


def angular_frequency(wavenumber: FloatArray, *, depth: float = np.inf) -> FloatArray:
    """Return omega = sqrt(g k tanh(k h)) [rad/s], Airy (1845).

    Parameters
    ----------
    wavenumber : array
        k, not negative [rad/m].
    depth : float
        h of the water; deep without one [m].

    Examples
    --------
    >>> angular_frequency(np.array([0.1]), depth=5.0).round(4)
    array([0.6732])
    """
    return np.asarray(np.sqrt(g * wavenumber * np.tanh(_depths(wavenumber, depth))))


def group_speed(wavenumber: FloatArray, *, depth: float = np.inf) -> FloatArray:
    """Return d omega / d k = (omega / 2 k) (1 + 2 k h / sinh 2 k h) [m/s], k positive.

    Parameters
    ----------
    wavenumber, depth
        See `angular_frequency`.

    Examples
    --------
    >>> group_speed(np.array([0.1])).round(4)
    array([4.9514])
    """
    twice = 2.0 * _depths(wavenumber, depth)
    phase_speed = angular_frequency(wavenumber, depth=depth) / wavenumber
    return np.asarray(0.5 * phase_speed * (1.0 + twice / np.sinh(twice)))


def wavenumber(period: float, *, depth: float = np.inf) -> float:
    """Return k of waves of a period [rad/m]: omega^2 = g k tanh(k h) solved by Newton's method.

    Parameters
    ----------
    period : float
        [s].
    depth : float
        Of the water; deep without one [m].

    Examples
    --------
    >>> round(2.0 * pi / wavenumber(10.0), 1), round(2.0 * pi / wavenumber(10.0, depth=8.0), 1)
    (156.1, 83.8)
    """
    deep = (2.0 * pi / period) ** 2 / g
    if not np.isfinite(depth):
        return deep
    k = deep / sqrt(tanh(min(deep * depth, FLATTENED)))  # Eckart (1952): within 5 %
    for _ in range(NEWTON_STEPS):
        still = tanh(min(k * depth, FLATTENED))
        k -= (k * still - deep) / (still + k * depth * (1.0 - still * still))
    return k


def depth_factor(wavenumber: FloatArray, *, depth: float = np.inf) -> FloatArray:
    """Return phi = tanh^2(k h) / (1 + 2 k h / sinh 2 k h), TMA: Bouws et al. (1985) [1].

    By it a spectrum of deep water falls where the bottom is felt; Kitaigorodskii et al. (1975).

    Parameters
    ----------
    wavenumber, depth
        See `angular_frequency`.

    Examples
    --------
    >>> depth_factor(np.array([0.05, 0.2, 3.0]), depth=8.0).round(3)
    array([0.076, 0.673, 1.   ])
    """
    depths = _depths(wavenumber, depth)
    return np.asarray(np.tanh(depths) ** 2 / (1.0 + 2.0 * depths / np.sinh(2.0 * depths)))


def _depths(wavenumber: FloatArray, depth: float) -> FloatArray:
    return np.minimum(wavenumber * depth, FLATTENED)

"""Swell: waves from far away, of one period and one direction but for a little."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from terrain.waves.dispersion import wavenumber
from terrain.waves.spectrum import jonswap
from terrain.waves.spreading import spread

FloatArray = NDArray[np.float64]

# Assumed: the narrowest that Goda (2010) gives for swell that has come far.
ENHANCEMENT, NARROWNESS = 10.0, 75.0
COMPONENTS = 64
ANGLES, FREQUENCIES = 721, 2001
LONGEST, SHORTEST = 0.5, 2.0  # frequency over that of the peak


@dataclass(frozen=True, kw_only=True)
class PlaneWaves:
    """A sum of plane waves: elevation = sum of a cos(kx x + ky y - omega t + phase).

    Parameters
    ----------
    amplitude, kx, ky, frequency, phase : array (n,)
        [m], [rad/m] towards east and north, [rad/s], [rad].
    """

    amplitude: FloatArray
    kx: FloatArray
    ky: FloatArray
    frequency: FloatArray
    phase: FloatArray

    def variance(self) -> float:
        """Return the mean square of the elevation [m2]."""
        return float(0.5 * (self.amplitude**2).sum())

    def slope_covariance(self) -> FloatArray:
        """Return the mean products (2, 2) of the slopes towards east and north [1]."""
        return mean_products(self.kx, self.ky, 0.5 * self.amplitude**2)


@dataclass(frozen=True, kw_only=True)
class Swell:
    """A narrow sea of its own.

    Parameters
    ----------
    height : float
        Significant height, four standard deviations of the elevation [m].
    period : float
        At the peak of the spectrum [s].
    comes_from : float
        Clockwise from grid north [rad].
    """

    height: float
    period: float
    comes_from: float

    def plane_waves(self, chance: np.random.Generator, *, depth: float = np.inf) -> PlaneWaves:
        """Return 64 waves of equal energy that make the swell.

        Their frequencies are drawn from equal parts of a JONSWAP spectrum with gamma = 10, their
        directions from cos^2s with s = 75.

        Parameters
        ----------
        chance : Generator
            Of random numbers.
        depth : float
            Of the water; deep without one [m].

        Examples
        --------
        >>> swell = Swell(height=1.0, period=10.0, comes_from=np.pi / 2)
        >>> waves = swell.plane_waves(np.random.default_rng(1))
        >>> round(4.0 * waves.variance() ** 0.5, 6), bool(waves.kx.mean() < 0.0)
        (1.0, True)
        """
        draws = chance.random((3, COMPONENTS))
        parts = (np.arange(COMPONENTS) + draws[0]) / COMPONENTS
        ratio = np.linspace(LONGEST, SHORTEST, FREQUENCIES)
        shape = jonswap(ratio, peak_frequency=1.0, alpha=1.0, enhancement=ENHANCEMENT)
        frequency = _quantiles(ratio, shape, parts) / self.period
        angle = np.linspace(-pi, pi, ANGLES)
        turn = _quantiles(angle, spread(angle, NARROWNESS), draws[1])
        towards = self.comes_from + pi + turn
        k = np.array([wavenumber(1.0 / f, depth=depth) for f in frequency])
        return PlaneWaves(
            amplitude=np.full(COMPONENTS, self.height / 4.0 * sqrt(2.0 / COMPONENTS)),
            kx=k * np.sin(towards),
            ky=k * np.cos(towards),
            frequency=2.0 * pi * frequency,
            phase=2.0 * pi * draws[2],
        )


def mean_products(kx: FloatArray, ky: FloatArray, variance: FloatArray) -> FloatArray:
    """Return the mean products (2, 2) of the slopes of waves, by the variance of each [1]."""
    xy = (kx * ky * variance).sum()
    return np.array([[(kx**2 * variance).sum(), xy], [xy, (ky**2 * variance).sum()]])


def _quantiles(value: FloatArray, density: FloatArray, parts: FloatArray) -> FloatArray:
    below = np.cumsum(density)
    return np.asarray(np.interp(parts, below / below[-1], value))

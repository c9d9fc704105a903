"""How the energy of a spectrum is shared out among the wavenumbers of a lattice."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from terrain.waves.dispersion import angular_frequency, depth_factor, group_speed
from terrain.waves.spectrum import WindSea
from terrain.waves.spreading import narrowness, spread

FloatArray = NDArray[np.float64]

COARSE_BINS = 16  # up to this wavenumber, in bins, a bin is wide against the spectrum's peak
PARTS = 8


def wavenumbers(*, width: float, largest: float) -> tuple[FloatArray, FloatArray]:
    """Return the wavenumbers towards east and north on a lattice of ``width``, up to ``largest``.

    Zero is left out.

    Examples
    --------
    >>> wavenumbers(width=1.0, largest=1.0)
    (array([ 0., -1.,  1.,  0.]), array([-1.,  0.,  0.,  1.]))
    """
    most = int(largest / width * (1.0 + 1e-12))
    index = np.arange(-most, most + 1.0)
    kx, ky = np.meshgrid(index * width, index * width)
    k = np.hypot(kx, ky)
    inside = (k > 0.0) & (k <= largest * (1.0 + 1e-12))
    return kx[inside], ky[inside]


def spectrum_of_wavenumber(
    kx: FloatArray, ky: FloatArray, *, sea: WindSea, towards: float, depth: float
) -> FloatArray:
    """Return the variance of the elevation by vector wavenumber [m4]: E(f) df/dk D / k.

    Parameters
    ----------
    kx, ky : array
        Wavenumber towards east and north, not both zero [rad/m].
    sea : WindSea
    towards : float
        Where most waves run to, clockwise from grid north [rad].
    depth : float
        Of the water; its bottom takes from long waves what `depth_factor` says [m].
    """
    k = np.hypot(kx, ky)
    frequency = angular_frequency(k, depth=depth) / (2.0 * pi)
    angle = np.arctan2(kx, ky) - towards
    density = sea.density(frequency) * depth_factor(k, depth=depth)
    per_wavenumber = density * group_speed(k, depth=depth) / (2.0 * pi)
    return np.asarray(per_wavenumber * spread(angle, narrowness(frequency, sea)) / k)


def energy_of_bins(
    kx: FloatArray, ky: FloatArray, width: float, *, sea: WindSea, towards: float, depth: float
) -> FloatArray:
    """Return the variance in square bins of wavenumber [m2]: long waves part by part.

    Parameters
    ----------
    kx, ky : array (n,)
        Middle of the bins [rad/m].
    width : float
        Side of the bins [rad/m].
    sea, towards, depth
        See `spectrum_of_wavenumber`.
    """
    spectrum = spectrum_of_wavenumber(kx, ky, sea=sea, towards=towards, depth=depth)
    coarse = np.maximum(np.abs(kx), np.abs(ky)) < (COARSE_BINS + 0.5) * width
    offset = ((np.arange(PARTS) + 0.5) / PARTS - 0.5) * width
    spectrum[coarse] = spectrum_of_wavenumber(
        kx[coarse][:, None, None] + offset[:, None],
        ky[coarse][:, None, None] + offset,
        sea=sea,
        towards=towards,
        depth=depth,
    ).mean(axis=(1, 2))
    return np.asarray(spectrum * width**2)

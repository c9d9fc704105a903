"""Light at the sea surface: facets, entry into the water, reflection from below, glint."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from survey.optics.interface import fresnel_reflectance, refracted
from survey.transport.random import uniform
from survey.transport.scene import Sea
from terrain.kernels import leaf_kernel
from terrain.waves.whitecaps import FOAM_REFLECTANCE

_ENTRIES = 4096
_QUANTILES = ndtri((np.arange(_ENTRIES) + 0.5) / _ENTRIES)
# Gaussian numbers of equal chance: 4,096 quantiles, scaled to unit variance.
NORMAL_QUANTILES = _QUANTILES / _QUANTILES.std()


@leaf_kernel
def drawn_normal(
    sea: Sea, quantiles: NDArray[np.float64], state: NDArray[np.uint64]
) -> tuple[float, float, float]:
    """Draw the upward unit normal of a facet: Gaussian slopes along and across the wind."""
    if sea.upwind_deviation == 0.0 and sea.crosswind_deviation == 0.0:
        return 0.0, 0.0, 1.0
    up = sea.upwind_deviation * quantiles[int(uniform(state) * quantiles.shape[0])]
    across = sea.crosswind_deviation * quantiles[int(uniform(state) * quantiles.shape[0])]
    slope_x = up * sea.wind_east + across * sea.wind_north
    slope_y = up * sea.wind_north - across * sea.wind_east
    norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    return -slope_x * norm, -slope_y * norm, norm


@leaf_kernel
def enter_water(
    index: float, dx: float, dy: float, dz: float, mx: float, my: float, mz: float
) -> tuple[float, float, float, float, float]:
    """Refract a downward ray at a facet: new direction, facet weight, Fresnel reflectance.

    The facet weight (d . m) / (d_z m_z) is how much more of the ray a tilted facet catches than
    level water does; its mean over the slopes is one.
    """
    cos_in = -(dx * mx + dy * my + dz * mz)
    if cos_in <= 0.0:
        return dx, dy, dz, 0.0, 0.0
    caught = cos_in / (-dz * mz)
    rx, ry, rz = refracted(dx, dy, dz, mx, my, mz, 1.0 / index)
    return rx, ry, rz, caught, fresnel_reflectance(cos_in, 1.0 / index)


@leaf_kernel
def facing_from_below(
    dx: float, dy: float, dz: float, mx: float, my: float, mz: float, slope_x: float, slope_y: float
) -> tuple[float, float, float]:
    """Return the facet normal at which a ray from below is mirrored, on water of a given slope.

    Departure: facets are weighted as seen along the vertical; a ray that a facet would miss, or
    send out again, meets smooth water instead. Both touch light along the surface alone.
    """
    cos_in = dx * mx + dy * my + dz * mz
    out = dz - dx * slope_x - dy * slope_y
    if cos_in <= 0.0 or out - 2.0 * cos_in * (mz - mx * slope_x - my * slope_y) >= 0.0:
        norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
        return -slope_x * norm, -slope_y * norm, norm
    return mx, my, mz


@leaf_kernel
def tilted(
    mx: float, my: float, mz: float, slope_x: float, slope_y: float
) -> tuple[float, float, float]:
    """Return the unit normal of a facet on water of a given slope: slopes add up."""
    nx, ny = mx - slope_x * mz, my - slope_y * mz
    norm = 1.0 / math.sqrt(nx * nx + ny * ny + mz * mz)
    return nx * norm, ny * norm, mz * norm


@leaf_kernel
def slope_density(sea: Sea, slope_x: float, slope_y: float) -> float:
    """Gaussian density of the facet slopes [1]."""
    up = slope_x * sea.wind_east + slope_y * sea.wind_north
    across = slope_x * sea.wind_north - slope_y * sea.wind_east
    exponent = (up / sea.upwind_deviation) ** 2 + (across / sea.crosswind_deviation) ** 2
    scale = 2.0 * math.pi * sea.upwind_deviation * sea.crosswind_deviation
    return math.exp(-0.5 * exponent) / scale


@leaf_kernel
def passing(sea: Sea) -> float:
    """Share of the light that whitecaps let through the surface."""
    return 1.0 - FOAM_REFLECTANCE * sea.white


@leaf_kernel
def glint_per_steradian(sea: Sea, index: float, dx: float, dy: float, dz: float) -> float:
    """Return of the surface to where the light came from, per incident power [1/sr].

    rho p(slope) / (4 cos^5 t), p the Gaussian density of the facet slope that faces the ray and
    t its angle off nadir: the isotropic case is rho exp(-tan^2 t / s2) / (4 pi s2 cos^5 t).
    """
    density = slope_density(sea, dx / -dz, dy / -dz)
    return fresnel_reflectance(1.0, 1.0 / index) * density / (4.0 * (-dz) ** 5)


@leaf_kernel
def return_per_steradian(
    sea: Sea, index: float, dx: float, dy: float, dz: float, slope_x: float, slope_y: float
) -> float:
    """Return of a wave of a given slope to where the light came from, per incident power [1/sr].

    (1 - W) rho p(s - slope) / (4 cos^4 t (-d . N)) of the facets, s the slope that faces the ray,
    N = (-slope, 1), and W R / pi cos i of the white share W, R its reflectance (Koepke 1984) and i
    the angle of incidence. On level water without foam it is `glint_per_steradian`.
    """
    onto = dx * slope_x + dy * slope_y - dz
    if onto <= 0.0:
        return 0.0
    density = slope_density(sea, dx / -dz - slope_x, dy / -dz - slope_y)
    glint = fresnel_reflectance(1.0, 1.0 / index) * density / (4.0 * dz**4 * onto)
    foam = FOAM_REFLECTANCE / math.pi * onto
    foam /= math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    return (1.0 - sea.white) * glint + sea.white * foam

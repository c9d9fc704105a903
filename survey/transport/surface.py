"""Light at the sea surface: facets, entry into the water, reflection from below, glint."""

from __future__ import annotations

import math

import numpy as np

from survey.optics.interface import fresnel_reflectance, reflected, refracted
from survey.transport.random import mixed
from survey.transport.scene import Sea
from terrain.kernels import leaf_kernel

_TO_UNIT = 1.0 / (1 << 53)


@leaf_kernel
def facet_normal(sea: Sea, x: float, y: float) -> tuple[float, float, float]:
    """Upward unit normal of the facet at a place: one Gaussian slope for each square.

    The square's numbers come from its place and the realisation's key, so that every walk of the
    realisation finds the same slope there.
    """
    if sea.upwind_deviation == 0.0 and sea.crosswind_deviation == 0.0:
        return 0.0, 0.0, 1.0
    i = np.uint64(np.int64(math.floor(x / sea.facet)))
    j = np.uint64(np.int64(math.floor(y / sea.facet)))
    address = mixed(sea.key ^ mixed(i ^ mixed(j + np.uint64(0x9E3779B97F4A7C15))))
    radius_bits = mixed(address)
    angle_bits = mixed(address ^ np.uint64(0xD1B54A32D192ED03))
    radius = math.sqrt(-2.0 * math.log(1.0 - float(radius_bits >> np.uint64(11)) * _TO_UNIT))
    angle = 2.0 * math.pi * float(angle_bits >> np.uint64(11)) * _TO_UNIT
    up = sea.upwind_deviation * radius * math.cos(angle)
    across = sea.crosswind_deviation * radius * math.sin(angle)
    slope_x = up * sea.wind_east + across * sea.wind_north
    slope_y = up * sea.wind_north - across * sea.wind_east
    norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    return -slope_x * norm, -slope_y * norm, norm


@leaf_kernel
def enter_water(
    sea: Sea, index: float, x: float, y: float, dx: float, dy: float, dz: float
) -> tuple[float, float, float, float, float]:
    """Refract a downward ray at its facet: new direction, facet weight, Fresnel reflectance.

    The facet weight (d . m) / (d_z m_z) is how much more of the ray a tilted facet catches than
    level water does; its mean over the slopes is one.
    """
    mx, my, mz = facet_normal(sea, x, y)
    cos_in = -(dx * mx + dy * my + dz * mz)
    if cos_in <= 0.0:
        return dx, dy, dz, 0.0, 0.0
    caught = cos_in / (-dz * mz)
    rx, ry, rz = refracted(dx, dy, dz, mx, my, mz, 1.0 / index)
    return rx, ry, rz, caught, fresnel_reflectance(cos_in, 1.0 / index)


@leaf_kernel
def reflectance_from_below(
    sea: Sea, index: float, x: float, y: float, dx: float, dy: float, dz: float
) -> tuple[float, float, float, float]:
    """Meet the surface from below: Fresnel reflectance and the direction if reflected.

    Departure: facets are weighted as seen along the vertical, and a ray that a facet would send
    up again is sent down at the same angle; both touch light near the horizontal alone.
    """
    mx, my, mz = facet_normal(sea, x, y)
    cos_in = dx * mx + dy * my + dz * mz
    if cos_in <= 0.0:
        return 1.0, dx, dy, -dz
    rx, ry, rz = reflected(dx, dy, dz, mx, my, mz)
    return fresnel_reflectance(cos_in, index), rx, ry, -abs(rz)


@leaf_kernel
def glint_per_steradian(sea: Sea, index: float, dx: float, dy: float, dz: float) -> float:
    """Return of the surface to where the light came from, per incident power [1/sr].

    rho p(slope) / (4 cos^5 t), p the Gaussian density of the facet slope that faces the ray and
    t its angle off nadir: the isotropic case is rho exp(-tan^2 t / s2) / (4 pi s2 cos^5 t).
    """
    slope_x, slope_y = dx / -dz, dy / -dz
    up = slope_x * sea.wind_east + slope_y * sea.wind_north
    across = slope_x * sea.wind_north - slope_y * sea.wind_east
    exponent = (up / sea.upwind_deviation) ** 2 + (across / sea.crosswind_deviation) ** 2
    scale = 2.0 * math.pi * sea.upwind_deviation * sea.crosswind_deviation
    density = math.exp(-0.5 * exponent) / scale
    return fresnel_reflectance(1.0, 1.0 / index) * density / (4.0 * (-dz) ** 5)

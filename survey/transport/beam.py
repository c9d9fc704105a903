"""The laser's light on level water: where it enters to reach a place, and how dense it is there."""

from __future__ import annotations

import math
from typing import NamedTuple

from survey.transport.launch import Optics, pixel_at
from terrain.kernels import leaf_kernel

NEWTON_STEPS = 2


class Ray(NamedTuple):
    """The unscattered ray of the laser to a place, through level water.

    ``x, y``: where it enters. ``slope_x, slope_y``: how far it goes sideways in the water, per
    metre of depth. ``radial, tangential``: how much neighbouring rays part, per metre of depth.
    """

    x: float
    y: float
    slope_x: float
    slope_y: float
    radial: float
    tangential: float


@leaf_kernel
def ray_to(optics: Optics, level: float, index: float, x: float, y: float, depth: float) -> Ray:
    """Solve Snell's law for the ray from the laser to a place under level water."""
    east, north = x - optics.position[0], y - optics.position[1]
    height = optics.position[2] - level
    away = math.sqrt(east * east + north * north)
    entry = away * index * height / (index * height + depth)
    slant = root = radial = 0.0
    for _ in range(NEWTON_STEPS):
        slant = math.sqrt(entry * entry + height * height)
        sine = entry / slant
        root = math.sqrt(index * index - sine * sine)
        upright = height / slant
        radial = index * index * upright * upright / (root * root * root * slant)
        entry -= (entry + depth * sine / root - away) / (1.0 + depth * radial)
    if away == 0.0:
        return Ray(x, y, 0.0, 0.0, radial, radial)
    east, north = east / away, north / away
    slope = entry / (slant * root)
    return Ray(
        optics.position[0] + east * entry,
        optics.position[1] + north * entry,
        east * slope,
        north * slope,
        radial,
        1.0 / (root * slant),
    )


@leaf_kernel
def light_on_water(
    optics: Optics, level: float, x: float, y: float, pixel: int, isolated: bool
) -> float:
    """Share of the pulse that falls on a square metre of level water [1/m2]; 0 where it is dark.

    The pulse fills the field of view evenly in its tangent plane. ``isolated`` light is that
    launched into the one pixel.
    """
    t = optics.turn
    east, north = x - optics.position[0], y - optics.position[1]
    height = optics.position[2] - level
    down = t[0, 2] * east + t[1, 2] * north - t[2, 2] * height
    if down <= 0.0:
        return 0.0
    forward = (t[0, 0] * east + t[1, 0] * north - t[2, 0] * height) / down
    right = (t[0, 1] * east + t[1, 1] * north - t[2, 1] * height) / down
    lit = pixel_at(optics, forward, right)
    if lit < 0 or (isolated and lit != pixel):
        return 0.0
    field = 4.0 * optics.half_forward * optics.half_right
    return float(height / (down * down * down * field))

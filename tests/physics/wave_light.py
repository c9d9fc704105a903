"""Light through waves, told anew: rays of the laser and of the pixels one by one, plain numpy.

Nothing of the engine's: rays fall on the sheet by iteration, Snell's and Fresnel's laws are written
in angles, light is counted in cells of the bottom.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from terrain.sea_surface import SeaSurface
from terrain.waves import WaveLattice

FloatArray = NDArray[np.float64]

MEETINGS = 8
DIFFERENCE = 1e-4  # [m]


class Rays(NamedTuple):
    """Unit directions in the water (n, 3) from places (n, 3) on the waves, what of them passes."""

    place: FloatArray
    direction: FloatArray
    passed: FloatArray
    in_air: FloatArray


def elevation(waves: WaveLattice, x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the sheet's elevation at places by scipy's spline [m]."""
    at = np.stack([(y - waves.y0) * waves.per_cell, (x - waves.x0) * waves.per_cell])
    return np.asarray(
        map_coordinates(waves.coefficients, at, order=2, prefilter=False, mode="nearest")
    )


def into_water(
    *,
    waves: WaveLattice,
    sea: SeaSurface,
    position: FloatArray,
    tangents: FloatArray,
    refractive_index: float,
    chance: np.random.Generator,
) -> Rays:
    """Send rays of slopes (n, 2) down from a position, each through a facet of its own."""
    rays = np.column_stack([tangents, -np.ones(len(tangents))])
    drop = np.full(len(rays), position[2])
    for _ in range(MEETINGS):
        place = position + rays * drop[:, None]
        drop = position[2] - elevation(waves, place[:, 0], place[:, 1])
    place = position + rays * drop[:, None]
    in_air = np.linalg.norm(rays, axis=1) * drop
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    slopes = slopes_at(waves, place)
    onto = -(rays * upright(slopes)).sum(axis=1)
    slopes += facets(sea, len(rays), chance)
    caught = np.maximum(-(rays * upright(slopes)).sum(axis=1), 0.0)
    normal = upright(slopes) / np.linalg.norm(upright(slopes), axis=1, keepdims=True)
    cosine = np.clip(-(rays * normal).sum(axis=1), 1e-6, 1.0)
    above = np.arccos(cosine)
    below = np.arcsin(np.sin(above) / refractive_index)
    along = (rays + cosine[:, None] * normal) / np.maximum(np.sin(above), 1e-12)[:, None]
    direction = np.sin(below)[:, None] * along - np.cos(below)[:, None] * normal
    straight = ((refractive_index - 1.0) / (refractive_index + 1.0)) ** 2
    near = above < 1e-3
    above, below = np.where(near, 0.5, above), np.where(near, 0.3, below)
    reflected = 0.5 * (
        (np.sin(above - below) / np.sin(above + below)) ** 2
        + (np.tan(above - below) / np.tan(above + below)) ** 2
    )
    passed = caught / onto * (1.0 - np.where(near, straight, reflected))
    return Rays(place, direction, passed, in_air)


def slopes_at(waves: WaveLattice, place: FloatArray) -> FloatArray:
    """Return the sheet's slopes (n, 2) by differences."""
    x, y, h = place[:, 0], place[:, 1], DIFFERENCE
    to_east = elevation(waves, x + h, y) - elevation(waves, x - h, y)
    to_north = elevation(waves, x, y + h) - elevation(waves, x, y - h)
    return np.column_stack([to_east, to_north]) / (2.0 * h)


def facets(sea: SeaSurface, count: int, chance: np.random.Generator) -> FloatArray:
    """Draw the slopes (n, 2) that no wave resolves."""
    along, across = np.sqrt(sea.remaining_slope_variance)[:, None] * chance.standard_normal(
        (2, count)
    )
    east, north = np.sin(sea.wind_from), np.cos(sea.wind_from)
    return np.column_stack([along * east + across * north, along * north - across * east])


def upright(slopes: FloatArray) -> FloatArray:
    """Return the normals (n, 3) of slopes, one metre high."""
    return np.column_stack([-slopes, np.ones(len(slopes))])

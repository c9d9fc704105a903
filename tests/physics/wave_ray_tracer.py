"""An independent ray tracer through a wavy surface: plain numpy, nothing of the engine's.

The surface is any function of place. Where a ray meets it is found by bisection, its normal by
differences, and Snell's law is written in angles.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Elevation = Callable[[FloatArray, FloatArray], FloatArray]

SCAN = 400
HALVINGS = 45
DIFFERENCE = 1e-4  # [m]


class Traced(NamedTuple):
    """Where rays enter the water and where they end on a level bottom.

    ``entry, normal, direction, end`` (n, 3): place on the surface, its unit normal, direction in
    the water, place on the bottom. ``in_air, in_water`` (n,): lengths [m].
    """

    entry: FloatArray
    normal: FloatArray
    direction: FloatArray
    end: FloatArray
    in_air: FloatArray
    in_water: FloatArray


def trace(
    *,
    position: FloatArray,
    rays: FloatArray,
    elevation: Elevation,
    crest: float,
    trough: float,
    bottom: float,
    refractive_index: float,
    facet_slopes: FloatArray | None = None,
) -> Traced:
    """Trace downward unit rays (n, 3) from a position (3,) or positions (n, 3) to the bottom.

    ``crest`` and ``trough`` bound the surface's elevation [m]. ``facet_slopes`` (n, 2) are added to
    the slopes of the surface where a ray meets it.
    """
    position = np.broadcast_to(position, rays.shape)
    in_air = _first_meeting(position, rays, elevation, crest, trough)
    entry = position + in_air[:, None] * rays
    slopes = _slopes(elevation, entry)
    if facet_slopes is not None:
        slopes = slopes + facet_slopes
    normal = np.column_stack([-slopes, np.ones(len(rays))])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    direction = _bent(rays, normal, refractive_index)
    in_water = (bottom - entry[:, 2]) / direction[:, 2]
    end = entry + in_water[:, None] * direction
    return Traced(entry, normal, direction, end, in_air, in_water)


def _first_meeting(
    position: FloatArray, rays: FloatArray, elevation: Elevation, crest: float, trough: float
) -> FloatArray:
    """Return the distance at which each ray first dips under the surface."""
    begin = (crest + 1e-6 - position[:, 2]) / rays[:, 2]
    finish = (trough - 1e-6 - position[:, 2]) / rays[:, 2]
    share = np.linspace(0.0, 1.0, SCAN)
    dips = _gap(begin + np.outer(share, finish - begin), position, rays, elevation) <= 0.0
    first = dips.argmax(axis=0)
    low = begin + share[first - 1] * (finish - begin)
    high = begin + share[first] * (finish - begin)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        above = _gap(middle, position, rays, elevation) > 0.0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.asarray(0.5 * (low + high))


def _gap(
    length: FloatArray, position: FloatArray, rays: FloatArray, elevation: Elevation
) -> FloatArray:
    x, y, z = (position[:, axis] + length * rays[:, axis] for axis in range(3))
    return np.asarray(z - elevation(x, y))


def _slopes(elevation: Elevation, at: FloatArray) -> FloatArray:
    x, y, h = at[:, 0], at[:, 1], DIFFERENCE
    to_east = elevation(x + h, y) - elevation(x - h, y)
    to_north = elevation(x, y + h) - elevation(x, y - h)
    return np.column_stack([to_east, to_north]) / (2.0 * h)


def _bent(rays: FloatArray, normal: FloatArray, refractive_index: float) -> FloatArray:
    """Turn rays towards the normal, in the plane of the two, from angle i to asin(sin i / n)."""
    cosine = np.clip(-(rays * normal).sum(axis=1), -1.0, 1.0)
    along = rays + cosine[:, None] * normal
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.divide(along, length, out=np.zeros_like(along), where=length > 0.0)
    angle = np.arcsin(np.sin(np.arccos(cosine)) / refractive_index)
    return np.asarray(np.sin(angle)[:, None] * along - np.cos(angle)[:, None] * normal)

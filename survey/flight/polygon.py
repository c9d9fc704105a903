"""Polygons on the map: faults, clipping, area."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

FEWEST_CORNERS, MOST_CORNERS = 3, 2000
SHOWN = 5
SMALLEST_AREA = 1.0
MOST_AT_ONCE = 4_000_000


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return how far vectors b (..., 2) lie to the left of a, times the length of a.

    Examples
    --------
    >>> cross(np.array([2.0, 0.0]), np.array([5.0, 3.0])).tolist()
    6.0
    """
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def polygon_faults(corners: FloatArray) -> list[str]:
    """Return what is wrong with a polygon, one line a fault; nothing where it is sound.

    Parameters
    ----------
    corners : array (n, 2)
        Easting and northing [m]; the last corner joins the first without being repeated.

    Examples
    --------
    >>> polygon_faults(np.array([[0.0, 0.0], [90.0, 90.0], [90.0, 0.0], [0.0, 90.0]]))
    ['side 0-1 crosses side 2-3 near easting 45.0, northing 45.0. Put the corners in order']
    """
    count = len(corners)
    if not FEWEST_CORNERS <= count <= MOST_CORNERS:
        return [f"{count} corners. Give {FEWEST_CORNERS} to {MOST_CORNERS}"]
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=1))
    if bad.size:
        return [f"corner {number} is not a finite place" for number in bad[:SHOWN]]
    same = np.flatnonzero((corners == np.roll(corners, -1, axis=0)).all(axis=1))
    if same.size:
        return [f"corner {i} is repeated. Leave it out" for i in (same[:SHOWN] + 1) % count]
    crossings = _crossings(corners)
    if crossings:
        return crossings
    if abs(signed_area(corners)) < SMALLEST_AREA:
        return [f"an area of less than {SMALLEST_AREA:g} m2. Are the corners on one line?"]
    return []


def _crossings(corners: FloatArray) -> list[str]:
    """Return the pairs of sides that meet elsewhere than in a corner that they share."""
    low = corners.min(axis=0)
    a = corners - low
    b = np.roll(a, -1, axis=0)
    count = len(a)
    first, second = np.triu_indices(count, 2)
    neighbours = (first == 0) & (second == count - 1)
    first, second = first[~neighbours], second[~neighbours]
    sides = (
        _side(a[first], b[first], a[second]) * _side(a[first], b[first], b[second]),
        _side(a[second], b[second], a[first]) * _side(a[second], b[second], b[first]),
    )
    boxes = (np.minimum(a, b), np.maximum(a, b))
    apart = (boxes[1][first] < boxes[0][second]) | (boxes[1][second] < boxes[0][first])
    cross = (sides[0] <= 0.0) & (sides[1] <= 0.0) & ~apart.any(axis=1)
    return [
        _crossing(i, j, a, b, low)
        for i, j in zip(first[cross][:SHOWN], second[cross][:SHOWN], strict=True)
    ]


def _crossing(i: int, j: int, a: FloatArray, b: FloatArray, low: FloatArray) -> str:
    count = len(a)
    along, other = b[i] - a[i], b[j] - a[j]
    across = along[0] * other[1] - along[1] * other[0]
    way = a[j] - a[i]
    part = (way[0] * other[1] - way[1] * other[0]) / across if across else 0.5
    east, north = a[i] + np.clip(part, 0.0, 1.0) * along + low
    return (
        f"side {i}-{(i + 1) % count} crosses side {j}-{(j + 1) % count} near easting {east:.1f}, "
        f"northing {north:.1f}. Put the corners in order"
    )


def _side(start: FloatArray, end: FloatArray, place: FloatArray) -> FloatArray:
    """Return on which side of directed lines places lie: positive on the left."""
    along, way = end - start, place - start
    return np.asarray(np.sign(along[:, 0] * way[:, 1] - along[:, 1] * way[:, 0]))


def signed_area(corners: FloatArray) -> float:
    """Return the area of a polygon (n, 2) [m2], negative where it runs clockwise.

    Examples
    --------
    >>> signed_area(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]))
    6.0
    """
    if len(corners) < FEWEST_CORNERS:
        return 0.0
    x, y = (corners - corners[0]).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def area_between(corners: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the areas of a polygon (n, 2) between two limits along its first axis, each (m,) [m2].

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])
    >>> area_between(square, np.array([-1.0, 3.0]), np.array([2.0, 9.0])).tolist()
    [6.0, 3.0]
    """
    size = max(1, MOST_AT_ONCE // len(corners))
    parts = [slice(first, first + size) for first in range(0, len(low), size)]
    areas = [_area_below(corners, high[part]) - _area_below(corners, low[part]) for part in parts]
    return np.asarray(np.abs(np.concatenate([np.empty(0), *areas])))


def _area_below(corners: FloatArray, limits: FloatArray) -> FloatArray:
    """Return the signed area of a polygon below limits (m,) along its first axis, by Green."""
    (x, y), (next_x, next_y) = corners.T, np.roll(corners, -1, axis=0).T
    y, next_y = y - y[0], next_y - y[0]
    run = next_x - x
    slope = np.divide(next_y - y, run, out=np.zeros_like(run), where=run != 0.0)
    begin, end = (np.minimum(end, limits[:, None]) for end in (x, next_x))
    middle = y + slope * (0.5 * (begin + end) - x)
    return np.asarray(-np.sum(middle * (end - begin), axis=1))


def clipped(corners: FloatArray, *, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the part of a polygon (n, 2) inside a box with its sides along the axes.

    Sutherland and Hodgman (1974): of a concave polygon several parts may come joined by lines
    without area along the box's sides, so extent and area are right.
    """
    for axis in (0, 1):
        corners = _cut(corners, axis, low[axis], 1.0)
        corners = _cut(corners, axis, high[axis], -1.0)
    return corners


def _cut(corners: FloatArray, axis: int, limit: float, sense: float) -> FloatArray:
    """Return the part of a polygon on one side of a limit: above it where sense is 1."""
    if len(corners) == 0 or np.isinf(limit):
        return corners
    depth = sense * (corners[:, axis] - limit)
    following, next_depth = np.roll(corners, -1, axis=0), np.roll(depth, -1)
    inside = depth >= 0.0
    crossing = inside != (next_depth >= 0.0)
    span = np.where(crossing, depth - next_depth, 1.0)
    meets = corners + (depth / span)[:, None] * (following - corners)
    both = np.stack([corners, meets], axis=1).reshape(-1, 2)
    return np.asarray(both[np.stack([inside, crossing], axis=1).ravel()])

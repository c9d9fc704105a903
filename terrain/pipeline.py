"""A pipeline over the seabed, with free spans."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from terrain.seabed import Seabed

if TYPE_CHECKING:
    import trimesh

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SIDES = 24
STEPS_PER_DIAMETER = 1.0
MOST_STATIONS = 20_000


@dataclass(frozen=True, kw_only=True)
class FreeSpan:
    """Where the pipe hangs free.

    Parameters
    ----------
    start, length : float
        Along the route from its first point [m].
    gap : float
        Between the seabed and the underside of the pipe [m].
    """

    start: float
    length: float
    gap: float


def pipeline(
    *,
    seabed: Seabed,
    route: FloatArray,
    diameter: float,
    burial: float = 0.0,
    bend_radius: float = 200.0,
    spans: Sequence[FreeSpan] = (),
) -> trimesh.Trimesh:
    """Return a closed pipe laid along a route, in local coordinates.

    The pipe is stiff: it follows the seabed, but where it curves upwards its radius is never below
    ``bend_radius``, so that it bridges hollows and rises gently to its free spans. (Its axis is the
    seabed's closing by a parabola of that curvature: no statics.)

    Parameters
    ----------
    route : array (points, 2)
        Corners of the route in the local frame [m].
    diameter : float
        Outside [m].
    burial : float
        How far its underside is under the seabed outside the free spans [m].
    bend_radius : float
        [m].
    spans : sequence of FreeSpan

    Raises
    ------
    ValueError
        When the route is no line, leaves the seabed or is too long, or a span leaves the route.
    """
    if not (diameter > 0.0 and bend_radius > 0.0 and burial >= 0.0):
        raise ValueError("pipeline: diameter and bend_radius must be positive, burial not negative")
    along, places = _stations(np.asarray(route, dtype=np.float64), diameter / STEPS_PER_DIAMETER)
    bed = seabed.elevation_at(places[:, 0], places[:, 1])
    if np.isnan(bed).any():
        x, y = places[np.isnan(bed)][0]
        raise ValueError(
            f"pipeline: no seabed at east {x:.1f} m, north {y:.1f} m of the local frame. "
            "shorten the route or give a larger seabed"
        )
    underside = bed - burial
    for span in spans:
        if not 0.0 <= span.start < span.start + span.length <= along[-1]:
            raise ValueError(
                f"pipeline: the free span from {span.start:g} to {span.start + span.length:g} m "
                f"leaves the route, which is {along[-1]:.1f} m long. move it"
            )
        hangs = (along >= span.start) & (along <= span.start + span.length)
        underside[hangs] = bed[hangs] + span.gap
    height = _stiffened(underside, float(along[1]), bend_radius) + 0.5 * diameter
    return _tube(np.column_stack([places, height]), 0.5 * diameter)


def _stations(route: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """Return evenly spaced distances (n,) along the route [m] and their places (n, 2)."""
    legs = np.linalg.norm(np.diff(route, axis=0), axis=1)
    if len(route) < 2 or not (legs > 0.0).all():
        raise ValueError("pipeline: the route needs two different points or more, none twice")
    corner = np.concatenate([[0.0], np.cumsum(legs)])
    count = int(np.ceil(corner[-1] / step)) + 1
    if count > MOST_STATIONS:
        raise ValueError(f"pipeline: {corner[-1]:.0f} m is too long for its diameter. shorten it")
    along = np.linspace(0.0, corner[-1], max(count, 3))
    return along, np.column_stack([np.interp(along, corner, route[:, i]) for i in range(2)])


def _stiffened(height: FloatArray, step: float, bend_radius: float) -> FloatArray:
    """Return the least curve above heights (n,) that nowhere curves upwards more sharply."""
    from scipy.ndimage import grey_closing

    reach = int(np.ceil(np.sqrt(2.0 * bend_radius * max(np.ptp(height), 1e-9)) / step))
    reach = min(reach, len(height))
    parabola = -((np.arange(-reach, reach + 1) * step) ** 2) / (2.0 * bend_radius)
    closed: FloatArray = grey_closing(  # type: ignore[call-overload]
        height, structure=parabola, mode="nearest"
    )
    return closed


def _tube(axis: FloatArray, radius: float) -> trimesh.Trimesh:
    """Return the closed tube about an axis (n, 3) that nowhere stands upright."""
    import trimesh

    tangent = np.gradient(axis, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    right = np.column_stack([tangent[:, 1], -tangent[:, 0], np.zeros(len(axis))])
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    up = np.cross(right, tangent)
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    ring = np.cos(angle)[:, None, None] * right + np.sin(angle)[:, None, None] * up
    wall = (axis + radius * ring).transpose(1, 0, 2).reshape(-1, 3)
    vertices = np.concatenate([wall, axis[[0, -1]]])
    return trimesh.Trimesh(vertices, _tube_faces(len(axis)), process=False)


def _tube_faces(rings: int) -> IntArray:
    """Return the faces (m, 3) of a tube, looking outwards; its ends' middles come last."""
    number = np.arange(rings * SIDES).reshape(rings, SIDES)
    following = np.roll(number, -1, axis=1)
    a, b, c, d = number[:-1], following[:-1], following[1:], number[1:]
    wall = np.concatenate([np.stack([a, c, b], -1), np.stack([a, d, c], -1)]).reshape(-1, 3)
    first = np.column_stack([number[0], following[0], np.full(SIDES, rings * SIDES)])
    last = np.column_stack([following[-1], number[-1], np.full(SIDES, rings * SIDES + 1)])
    return np.concatenate([wall, first, last])

"""Bodies to set on the seabed: a wreck, a boulder, a cube, or any mesh.

Every body is closed, its faces look outwards, and it stands about the origin with its bow to the
north. Sizes in metres.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from terrain.seabed import Seabed

if TYPE_CHECKING:
    import trimesh

FloatArray = NDArray[np.float64]


def cube(*, side: float) -> trimesh.Trimesh:
    """Return a cube about the origin, its sides along the axes.

    Examples
    --------
    >>> float(cube(side=2.0).volume)
    8.0
    """
    import trimesh

    body: trimesh.Trimesh = trimesh.creation.box(extents=[side, side, side])
    return body


def boulder(*, radius: float, relief: float, seed: int, subdivisions: int = 4) -> trimesh.Trimesh:
    """Return a ball whose radius varies by ``relief`` (r.m.s., as a part of the radius).

    The relief is a sum of 24 plane waves over the directions, smooth over about a radian; a part
    of more than 0.3 is refused (ValueError), for it would turn the body inside out.
    """
    import trimesh

    if not (radius > 0.0 and 0.0 <= relief <= 0.3):
        raise ValueError("boulder: radius must be positive, relief between 0 and 0.3")
    body = trimesh.creation.icosphere(subdivisions=subdivisions, radius=1.0)
    rng = np.random.Generator(np.random.Philox(key=seed))
    waves = 4.0 * rng.standard_normal((24, 3)) / np.sqrt(3.0)
    phases = rng.uniform(0.0, 2.0 * np.pi, 24)
    relief_at = np.cos(body.vertices @ waves.T + phases).sum(axis=1) / np.sqrt(12.0)
    scale = radius * np.maximum(1.0 + relief * relief_at, 0.2)
    return trimesh.Trimesh(body.vertices * scale[:, None], body.faces, process=False)


def wreck(
    *,
    length: float = 30.0,
    beam: float = 6.0,
    height: float = 3.0,
    plate: float = 0.1,
    edge: float = 0.3,
) -> trimesh.Trimesh:
    """Return an open hull with a broken deck: overhangs above, dark rooms below.

    Parameters
    ----------
    length, beam, height, plate : float
        Hull, keel to sheer, and thickness of its plates [m].
    edge : float
        Length of the triangles' edges, about [m].

    The deck lies at 0.75 of the height and covers the length but for its ends and a gap of a fifth
    amidships; the keel's lowest point is at elevation 0.

    Examples
    --------
    >>> body = wreck()
    >>> body.is_watertight, body.extents.round(0)
    (True, array([ 6., 30.,  3.]))
    """
    import trimesh

    if not (plate > 0.0 and edge > 0.0 and beam > 8 * plate and height > 8 * plate):
        raise ValueError("wreck: plate and edge must be positive, beam and height 8 plates or more")
    along = np.linspace(-0.5, 0.5, max(int(length / edge), 8) + 1)
    around = np.linspace(-1.0, 1.0, max(int((beam + 2.0 * height) / edge), 8) + 1)
    parts = [
        _plate(
            _hull(along, around, length, beam, height, 0.0),
            _hull(along, around, length, beam, height, plate),
        )
    ]
    for start, end in ((-0.42, -0.12), (0.08, 0.42)):
        stations = np.linspace(start, end, max(int((end - start) * length / edge), 4) + 1)
        top = _deck(stations, length, beam, height, plate, edge)
        parts.append(_plate(top - [0.0, 0.0, plate], top))
    body = cast("trimesh.Trimesh", trimesh.util.concatenate(parts))
    body.apply_translation([0.0, 0.0, -body.bounds[0, 2]])
    return body


def _fullness(along: FloatArray) -> FloatArray:
    """Return the size of the section over the length: full amidships, a tenth at the ends."""
    return 0.1 + 0.9 * (1.0 - (2.0 * along) ** 4)


def _hull(
    along: FloatArray, around: FloatArray, length: float, beam: float, height: float, inset: float
) -> FloatArray:
    """Return points (stations, section, 3) of the hull, or of its inner side ``inset`` inwards."""
    full = _fullness(along)[:, None]
    angle = 0.5 * np.pi * around[None, :]
    across = (0.5 * beam * full - inset) * np.sin(angle)
    down = (height * full - inset) * np.cos(angle) ** 0.7
    ends = (along * length)[:, None] + 0.0 * across
    return np.stack([across, ends, height - down], axis=-1)


def _deck(
    stations: FloatArray, length: float, beam: float, height: float, plate: float, edge: float
) -> FloatArray:
    """Return points (stations, across, 3) of a deck that just clears the hull."""
    depth = 0.25 * height
    at_underside = depth + plate
    cosine = np.clip(at_underside / (height * _fullness(stations) - plate), 0.0, 1.0) ** (1.0 / 0.7)
    half = (0.5 * beam * _fullness(stations) - plate) * np.sqrt(1.0 - cosine**2) - 0.5 * plate
    across = np.linspace(-1.0, 1.0, max(int(beam / edge), 4) + 1)[None, :] * half[:, None]
    ends = (stations * length)[:, None] + 0.0 * across
    return np.stack([across, ends, np.full_like(across, height - depth)], axis=-1)


def _plate(outer: FloatArray, inner: FloatArray) -> trimesh.Trimesh:
    """Return the closed plate between two sheets of points (rows, cols, 3), facing outwards."""
    import trimesh

    rows, cols = outer.shape[:2]
    number = np.arange(rows * cols).reshape(rows, cols)
    rim = np.concatenate([number[0, :-1], number[:-1, -1], number[-1, :0:-1], number[:0:-1, 0]])
    following, inside = np.roll(rim, -1), rows * cols
    sheet = _two_triangles(number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    edge = _two_triangles(rim, following, following + inside, rim + inside)
    faces = np.concatenate([sheet, sheet[:, ::-1] + inside, edge])
    vertices = np.concatenate([outer.reshape(-1, 3), inner.reshape(-1, 3)])
    body = trimesh.Trimesh(vertices, faces, process=False)
    if body.volume < 0.0:
        body.invert()
    return body


def _two_triangles(
    a: NDArray[np.int64], b: NDArray[np.int64], c: NDArray[np.int64], d: NDArray[np.int64]
) -> NDArray[np.int64]:
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def place(
    body: trimesh.Trimesh,
    *,
    seabed: Seabed,
    east: float,
    north: float,
    heading: float = 0.0,
    list_angle: float = 0.0,
    trim_angle: float = 0.0,
    burial: float = 0.0,
) -> trimesh.Trimesh:
    """Return a body set on the seabed, in local coordinates.

    Parameters
    ----------
    east, north : float
        Where the body's origin goes, in the local frame [m].
    heading : float
        Direction of the body's north, clockwise from grid north [rad].
    list_angle, trim_angle : float
        Turn about its own axis, starboard (east) side down, and bow up [rad].
    burial : float
        How far its lowest point is under the seabed that lies there [m].

    Raises
    ------
    ValueError
        When there is no seabed under its lowest point.
    """
    placed = body.copy()
    for angle, about in ((list_angle, 1), (trim_angle, 0), (-heading, 2)):
        placed.apply_transform(_turn(angle, about))
    placed.apply_translation([east, north, 0.0])
    lowest = placed.vertices[placed.vertices[:, 2].argmin()]
    ground = float(seabed.elevation_at(lowest[0], lowest[1]))
    if np.isnan(ground):
        raise ValueError(
            f"object: no seabed at east {lowest[0]:.1f} m, north {lowest[1]:.1f} m of the local "
            "frame. move the object or give a larger seabed"
        )
    placed.apply_translation([0.0, 0.0, ground - burial - lowest[2]])
    return placed


def _turn(angle: float, about: int) -> FloatArray:
    """Return the matrix (4, 4) of a right-handed turn about an axis, 0 to 2."""
    i, j = (about + 1) % 3, (about + 2) % 3
    matrix = np.eye(4)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i], matrix[i, j] = np.sin(angle), -np.sin(angle)
    return matrix

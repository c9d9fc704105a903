"""The first triangle a ray meets.

Ray against triangle is the watertight test of Woop, Benthin and Wald (2013, "Watertight
ray/triangle intersection", J. Computer Graphics Techniques 2, 65): two triangles evaluate their
shared edge by the same products, so that no ray slips through between them. Both sides of a
triangle are hit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from terrain.cell_binning import PADDING
from terrain.kernels import inlined_kernel, kernel, leaf_kernel
from terrain.seabed_grid import SeabedGrid, build_grid

__all__ = ["SeabedGrid", "build_grid", "cast_rays", "first_hit"]

FloatArray = NDArray[np.float64]


class Ray(NamedTuple):
    """Origin, direction, inverse direction and longest distance of a ray."""

    ox: float
    oy: float
    oz: float
    dx: float
    dy: float
    dz: float
    inverse_x: float
    inverse_y: float
    t_max: float


@leaf_kernel
def first_hit(
    grid: SeabedGrid,
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    t_max: float,
) -> tuple[float, int]:
    """Return distance and face of the first hit with 0 < t <= t_max, or (inf, -1).

    Distances count in lengths of the direction (a unit vector gives metres); ``t_max`` may be
    infinite. A ray that starts on a face may meet that face again at the distance of a rounding
    error: start it some micrometres above.
    """
    lowest = min(oz, oz + dz * t_max)
    if lowest > grid.z_high:
        return np.inf, -1
    along_x, along_y = dx * t_max, dy * t_max
    if abs(along_x) + abs(along_y) < grid.cell and _above_all_cells(
        grid, ox, oy, ox + along_x, oy + along_y, lowest
    ):
        return np.inf, -1
    return _traverse(grid, Ray(ox, oy, oz, dx, dy, dz, 1.0 / dx, 1.0 / dy, t_max))


@inlined_kernel
def _above_all_cells(
    grid: SeabedGrid, x_a: float, y_a: float, x_b: float, y_b: float, lowest: float
) -> bool:
    """Whether a segment shorter than an upper cell lies above all there is in its cells."""
    ix_a = _cell_index(x_a, grid.x0, grid.per_cell, grid.nx)
    ix_b = _cell_index(x_b, grid.x0, grid.per_cell, grid.nx)
    row_a = grid.nx * _cell_index(y_a, grid.y0, grid.per_cell, grid.ny)
    row_b = grid.nx * _cell_index(y_b, grid.y0, grid.per_cell, grid.ny)
    return bool(
        lowest > grid.upper_z[row_a + ix_a, 1]
        and lowest > grid.upper_z[row_a + ix_b, 1]
        and lowest > grid.upper_z[row_b + ix_a, 1]
        and lowest > grid.upper_z[row_b + ix_b, 1]
    )


@leaf_kernel
def _cell_index(x: float, origin: float, per_side: float, count: int) -> int:
    """Return the cell of a coordinate, the nearest one outside the grid."""
    return int(min(max((x - origin) * per_side, 0.0), count - 1.0))


@leaf_kernel
def _clip(
    origin: float,
    direction: float,
    inverse: float,
    low: float,
    high: float,
    t_in: float,
    t_out: float,
) -> tuple[float, float]:
    """Return the part of [t_in, t_out] within a slab; t_in > t_out when there is none."""
    if direction == 0.0:
        if origin < low or origin > high:
            return np.inf, -np.inf
        return t_in, t_out
    t_low, t_high = (low - origin) * inverse, (high - origin) * inverse
    return max(t_in, min(t_low, t_high)), min(t_out, max(t_low, t_high))


@leaf_kernel
def _t_leaving(
    origin: float, direction: float, inverse: float, low: float, side: float, index: int
) -> float:
    """Return where a ray leaves cell ``index`` along one axis."""
    if direction > 0.0:
        return (low + (index + 1) * side - origin) * inverse
    if direction < 0.0:
        return (low + index * side - origin) * inverse
    return np.inf


@inlined_kernel
def _traverse(grid: SeabedGrid, ray: Ray) -> tuple[float, int]:
    """Walk the upper cells under the ray, nearest first."""
    x0, y0, cell, nx, ny = grid.x0, grid.y0, grid.cell, grid.nx, grid.ny
    x1, y1 = x0 + nx * cell + PADDING, y0 + ny * cell + PADDING
    t, t_out = _clip(ray.oz, ray.dz, 1.0 / ray.dz, grid.z_low, grid.z_high, 0.0, ray.t_max)
    t, t_out = _clip(ray.ox, ray.dx, ray.inverse_x, x0 - PADDING, x1, t, t_out)
    t, t_out = _clip(ray.oy, ray.dy, ray.inverse_y, y0 - PADDING, y1, t, t_out)
    best, face = np.inf, -1
    if not t <= t_out:
        return best, face
    ix = _cell_index(ray.ox + ray.dx * t, x0, grid.per_cell, nx)
    iy = _cell_index(ray.oy + ray.dy * t, y0, grid.per_cell, ny)
    while 0 <= ix < nx and 0 <= iy < ny:
        t_x = _t_leaving(ray.ox, ray.dx, ray.inverse_x, x0, cell, ix)
        t_y = _t_leaving(ray.oy, ray.dy, ray.inverse_y, y0, cell, iy)
        t_next = min(t_x, t_y, t_out)
        z_a, z_b = ray.oz + ray.dz * t, ray.oz + ray.dz * t_next
        number = iy * nx + ix
        if min(z_a, z_b) <= grid.upper_z[number, 1] and max(z_a, z_b) >= grid.upper_z[number, 0]:
            best, face = _search_cell(grid, ray, ix, iy, t, t_next, best, face)
        if best <= t_next or t_next >= t_out:
            break
        t = t_next
        if t_x <= t_y:
            ix += 1 if ray.dx > 0.0 else -1
        else:
            iy += 1 if ray.dy > 0.0 else -1
    return best, face


@inlined_kernel
def _search_cell(
    grid: SeabedGrid,
    ray: Ray,
    upper_ix: int,
    upper_iy: int,
    t: float,
    t_out: float,
    best: float,
    face: int,
) -> tuple[float, int]:
    """Walk the lower cells of one upper cell between ``t`` and ``t_out``."""
    number = upper_iy * grid.nx + upper_ix
    first, n = grid.upper_parts[number, 0], grid.upper_parts[number, 1]
    x0, y0 = grid.x0 + upper_ix * grid.cell, grid.y0 + upper_iy * grid.cell
    side, per_side = grid.cell / n, grid.per_cell * n
    ix = _cell_index(ray.ox + ray.dx * t, x0, per_side, n)
    iy = _cell_index(ray.oy + ray.dy * t, y0, per_side, n)
    while 0 <= ix < n and 0 <= iy < n:
        t_x = _t_leaving(ray.ox, ray.dx, ray.inverse_x, x0, side, ix)
        t_y = _t_leaving(ray.oy, ray.dy, ray.inverse_y, y0, side, iy)
        t_next = min(t_x, t_y, t_out)
        z_a, z_b = ray.oz + ray.dz * t, ray.oz + ray.dz * t_next
        lower = first + iy * n + ix
        if min(z_a, z_b) <= grid.lower_z[lower, 1] and max(z_a, z_b) >= grid.lower_z[lower, 0]:
            best, face = _nearest_face(grid, ray, lower, best, face)
        if best <= t_next or t_next >= t_out:
            break
        t = t_next
        if t_x <= t_y:
            ix += 1 if ray.dx > 0.0 else -1
        else:
            iy += 1 if ray.dy > 0.0 else -1
    return best, face


@inlined_kernel
def _nearest_face(
    grid: SeabedGrid, ray: Ray, lower: int, best: float, face: int
) -> tuple[float, int]:
    """Return the nearer of ``best`` and the hits among the faces of one lower cell."""
    ox, oy, oz, dx, dy, dz = ray.ox, ray.oy, ray.oz, ray.dx, ray.dy, ray.dz
    if abs(dz) >= abs(dx) and abs(dz) >= abs(dy):
        kx, ky, kz, px, py, pz, qx, qy, qz = 0, 1, 2, ox, oy, oz, dx, dy, dz
    elif abs(dx) >= abs(dy):
        kx, ky, kz, px, py, pz, qx, qy, qz = 1, 2, 0, oy, oz, ox, dy, dz, dx
    else:
        kx, ky, kz, px, py, pz, qx, qy, qz = 2, 0, 1, oz, ox, oy, dz, dx, dy
    scale = 1.0 / qz
    shear_x, shear_y = qx * scale, qy * scale
    corners = grid.corners
    for i in range(grid.lower_start[lower], grid.lower_start[lower + 1]):
        f = grid.lower_faces[i]
        az, bz, cz = corners[f, 0, kz] - pz, corners[f, 1, kz] - pz, corners[f, 2, kz] - pz
        ax = corners[f, 0, kx] - px - shear_x * az
        ay = corners[f, 0, ky] - py - shear_y * az
        bx = corners[f, 1, kx] - px - shear_x * bz
        by = corners[f, 1, ky] - py - shear_y * bz
        cx = corners[f, 2, kx] - px - shear_x * cz
        cy = corners[f, 2, ky] - py - shear_y * cz
        u, v, w = cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax
        if (u < 0.0 or v < 0.0 or w < 0.0) and (u > 0.0 or v > 0.0 or w > 0.0):
            continue
        if u + v + w == 0.0:
            continue
        t = (u * az + v * bz + w * cz) * scale / (u + v + w)
        if 0.0 < t <= ray.t_max and t < best:
            best, face = t, int(f)
    return best, face


@kernel
def _cast_all(
    grid: SeabedGrid,
    origins: FloatArray,
    directions: FloatArray,
    t_max: FloatArray,
    t: FloatArray,
    face: NDArray[np.int64],
) -> None:
    for i in range(len(origins)):
        ox, oy, oz = origins[i, 0], origins[i, 1], origins[i, 2]
        dx, dy, dz = directions[i, 0], directions[i, 1], directions[i, 2]
        t[i], face[i] = first_hit(grid, ox, oy, oz, dx, dy, dz, t_max[i])


def cast_rays(
    grid: SeabedGrid,
    origins: FloatArray,
    directions: FloatArray,
    t_max: float | FloatArray = np.inf,
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return distance (n,) and face (n,) of the first hit of every ray; inf and -1 for none.

    Parameters
    ----------
    origins, directions : array (n, 3) or (3,)
        Local coordinates [m] and directions, broadcast against each other.
    t_max : float or array (n,)
        Longest distance, in lengths of the direction.

    Raises
    ------
    ValueError
        When an origin or a direction is not finite, or a direction is zero.

    Examples
    --------
    >>> import trimesh
    >>> cube = build_grid(trimesh.creation.box(extents=[2.0, 2.0, 2.0]))
    >>> t, face = cast_rays(cube, np.array([0.3, 0.2, 5.0]), np.array([[0, 0, -1.0], [0, 0, 1.0]]))
    >>> t
    array([ 4., inf])
    """
    origins, directions = np.broadcast_arrays(np.atleast_2d(origins), np.atleast_2d(directions))
    origins = np.ascontiguousarray(origins, dtype=np.float64)
    directions = np.ascontiguousarray(directions, dtype=np.float64)
    if not (np.isfinite(origins).all() and np.isfinite(directions).all()):
        raise ValueError("rays: origins and directions must be finite")
    if not directions.any(axis=1).all():
        raise ValueError("rays: a direction is the zero vector")
    limits = np.broadcast_to(np.asarray(t_max, dtype=np.float64), len(origins)).copy()
    t, face = np.empty(len(origins)), np.empty(len(origins), dtype=np.int64)
    _cast_all(grid, origins, directions, limits, t, face)
    return t, face

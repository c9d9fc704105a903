"""A two-level grid over the plan view of a triangle mesh: what a ray may hit, found in few steps.

The upper level has square cells of some metres, each with the range of elevations in it; most
short steps in the water end there. Every upper cell is cut into as many lower cells as its own
triangles ask for, so that a wreck of small triangles on a coarse seabed costs no more than the
seabed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from terrain.cell_binning import PADDING, bin_faces, elevation_ranges
from terrain.kernels import kernel

if TYPE_CHECKING:
    import trimesh

FloatArray = NDArray[np.float64]

FACES_PER_UPPER_CELL = 96
WIDEST_UPPER_CELL = 16.0  # [m]
MOST_UPPER_CELLS = 1_000_000
FINEST_DIVISION = 256
LOWER_CELLS_PER_FACE = 8


class SeabedGrid(NamedTuple):
    """The mesh and its grid, as compiled kernels take them.

    ``x0, y0`` corner, ``cell`` side, ``per_cell`` its inverse and ``nx, ny`` count of the upper
    cells; ``z_low, z_high`` range of the mesh [m]. ``upper_z`` (nx * ny, 2) range of elevation in
    every upper cell; ``upper_parts`` (nx * ny, 2) number of its first lower cell, and lower cells
    along a side. ``lower_z`` (n, 2) range in every lower cell; ``lower_start`` (n + 1) into
    ``lower_faces``. ``corners`` (faces, 3, 3) and ``normals`` (faces, 3) of the mesh.
    """

    x0: float
    y0: float
    cell: float
    per_cell: float
    nx: int
    ny: int
    z_low: float
    z_high: float
    upper_z: FloatArray
    upper_parts: NDArray[np.int64]
    lower_z: NDArray[np.float32]
    lower_start: NDArray[np.int64]
    lower_faces: NDArray[np.int32]
    corners: FloatArray
    normals: FloatArray


def build_grid(mesh: trimesh.Trimesh) -> SeabedGrid:
    """Return the grid of a mesh; at least one face, all vertices finite (else ValueError)."""
    corners = np.ascontiguousarray(mesh.triangles, dtype=np.float64)
    if len(corners) == 0 or not np.isfinite(corners).all():
        raise ValueError("seabed: the mesh needs at least one face and finite vertices")
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    cell = _upper_cell_side(high - low, len(corners))
    x0, y0 = low[:2] - 0.381 * cell  # off the lines of a raster, whose edges would count twice
    nx, ny = (int(n) for n in np.floor((high[:2] - [x0, y0]) / cell) + 1)
    members, start = bin_faces(
        corners, np.arange(len(corners), dtype=np.int32), x0, y0, cell, nx, ny
    )
    upper_z = np.empty((nx * ny, 2))
    elevation_ranges(corners, members, start, x0, y0, cell, nx, upper_z)
    upper_parts = _divide(corners, members, start, cell)
    lower_z, lower_start, lower_faces = _lower_cells(
        corners, members, start, upper_parts, x0, y0, cell, nx
    )
    return SeabedGrid(
        x0=float(x0),
        y0=float(y0),
        cell=cell,
        per_cell=1.0 / cell,
        nx=nx,
        ny=ny,
        z_low=float(low[2]) - PADDING,
        z_high=float(high[2]) + PADDING,
        upper_z=upper_z,
        upper_parts=upper_parts,
        lower_z=_widened_to_float32(lower_z),
        lower_start=lower_start,
        lower_faces=lower_faces,
        corners=corners,
        normals=_unit_normals(corners),
    )


def elevations_within(
    grid: SeabedGrid, *, west: float, east: float, south: float, north: float
) -> tuple[float, float, float]:
    """Return the lowest and highest elevation in a box, and the mean of its cells' tops [m].

    Cells that the box cuts count whole; -inf where there is no seabed.
    """
    first, last = (int(np.floor((x - grid.x0) * grid.per_cell)) for x in (west, east))
    below, above = (int(np.floor((y - grid.y0) * grid.per_cell)) for y in (south, north))
    cells = grid.upper_z.reshape(grid.ny, grid.nx, 2)
    inside = cells[max(0, below) : max(0, above + 1), max(0, first) : max(0, last + 1)]
    known = inside[np.isfinite(inside[..., 0])]
    if known.size == 0:
        return -np.inf, -np.inf, -np.inf
    return float(known[:, 0].min()), float(known[:, 1].max()), float(known[:, 1].mean())


def _upper_cell_side(extent: FloatArray, faces: int) -> float:
    width, height = max(extent[0], 1e-3), max(extent[1], 1e-3)
    wanted = min(np.sqrt(width * height * FACES_PER_UPPER_CELL / faces), WIDEST_UPPER_CELL)
    smallest = max(np.sqrt(width * height / MOST_UPPER_CELLS), (width + height) / MOST_UPPER_CELLS)
    return float(max(wanted, smallest))


def _unit_normals(corners: FloatArray) -> FloatArray:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: FloatArray = normals / np.where(length > 0.0, length, 1.0)
    return unit


def _widened_to_float32(ranges: FloatArray) -> NDArray[np.float32]:
    narrow = ranges.astype(np.float32)
    narrow[:, 0] = np.nextafter(narrow[:, 0], np.float32(-np.inf))
    narrow[:, 1] = np.nextafter(narrow[:, 1], np.float32(np.inf))
    narrow[ranges[:, 0] > ranges[:, 1]] = (np.inf, -np.inf)
    return narrow


@kernel
def _divide(
    corners: FloatArray, members: NDArray[np.int32], start: NDArray[np.int64], cell: float
) -> NDArray[np.int64]:
    """Return the first lower cell, and lower cells along a side, of every upper cell."""
    parts = np.zeros((start.size - 1, 2), dtype=np.int64)
    total = 0
    for number in range(start.size - 1):
        faces = members[start[number] : start[number + 1]]
        n = 1
        if faces.size > 2:
            spans = np.empty(faces.size)
            for i, face in enumerate(faces):
                xs, ys = corners[face, :, 0], corners[face, :, 1]
                spans[i] = max(xs.max() - xs.min(), ys.max() - ys.min())
            n = round(cell / max(np.median(spans), cell / FINEST_DIVISION))
            n = max(1, min(n, int(np.sqrt(LOWER_CELLS_PER_FACE * faces.size))))
        parts[number, 0], parts[number, 1] = total, n
        total += n * n
    return parts


@kernel
def _lower_cells(
    corners: FloatArray,
    members: NDArray[np.int32],
    start: NDArray[np.int64],
    parts: NDArray[np.int64],
    x0: float,
    y0: float,
    cell: float,
    nx: int,
) -> tuple[FloatArray, NDArray[np.int64], NDArray[np.int32]]:
    total = parts[-1, 0] + parts[-1, 1] ** 2
    ranges = np.empty((total, 2))
    lower_start = np.zeros(total + 1, dtype=np.int64)
    lower_faces = np.empty(2 * members.size + 16, dtype=np.int32)
    for number in range(start.size - 1):
        first, n = parts[number]
        x, y = x0 + (number % nx) * cell, y0 + (number // nx) * cell
        faces = members[start[number] : start[number + 1]]
        own, own_start = bin_faces(corners, faces, x, y, cell / n, n, n)
        elevation_ranges(corners, own, own_start, x, y, cell / n, n, ranges[first : first + n * n])
        used = lower_start[first]
        if used + own.size > lower_faces.size:
            roomier = np.empty(2 * (used + own.size), dtype=np.int32)
            roomier[:used] = lower_faces[:used]
            lower_faces = roomier
        lower_faces[used : used + own.size] = own
        lower_start[first + 1 : first + n * n + 1] = used + own_start[1:]
    return ranges, lower_start, lower_faces[: lower_start[-1]].copy()

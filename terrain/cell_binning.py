"""Which triangles lie, in plan, in which square cells, and how high they reach there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import kernel

FloatArray = NDArray[np.float64]

PADDING = 1e-6  # [m] by which cells overlap: far above rounding, far below any triangle


@kernel
def _cell_range(low: float, high: float, origin: float, side: float, count: int) -> tuple[int, int]:
    first = int(np.floor((low - PADDING - origin) / side))
    last = int(np.floor((high + PADDING - origin) / side))
    return max(first, 0), min(last, count - 1)


@kernel
def _outside_an_edge(corners: FloatArray, face: int, x: float, y: float, half: float) -> bool:
    """Whether an edge of the triangle, seen from above, parts it from a square about (x, y)."""
    for i in range(3):
        a, b, c = corners[face, i], corners[face, (i + 1) % 3], corners[face, (i + 2) % 3]
        nx, ny = a[1] - b[1], b[0] - a[0]
        inner = nx * (c[0] - a[0]) + ny * (c[1] - a[1])
        distance = nx * (x - a[0]) + ny * (y - a[1])
        reach = half * (abs(nx) + abs(ny))
        if inner == 0.0:
            distance = -abs(distance)
        elif inner < 0.0:
            distance = -distance
        if distance < -reach:
            return True
    return False


@kernel
def _bin_pass(
    corners: FloatArray,
    faces: NDArray[np.int32],
    x0: float,
    y0: float,
    side: float,
    nx: int,
    ny: int,
    cursor: NDArray[np.int64],
    out: NDArray[np.int32],
) -> None:
    """Advance ``cursor`` by one per face and cell, and write the face where ``out`` has room."""
    half = 0.5 * side + PADDING
    for face in faces:
        xs, ys = corners[face, :, 0], corners[face, :, 1]
        ix0, ix1 = _cell_range(xs.min(), xs.max(), x0, side, nx)
        iy0, iy1 = _cell_range(ys.min(), ys.max(), y0, side, ny)
        for iy in range(iy0, iy1 + 1):
            for ix in range(ix0, ix1 + 1):
                x, y = x0 + (ix + 0.5) * side, y0 + (iy + 0.5) * side
                if not _outside_an_edge(corners, face, x, y, half):
                    if out.size > 0:
                        out[cursor[iy * nx + ix]] = face
                    cursor[iy * nx + ix] += 1


@kernel
def bin_faces(
    corners: FloatArray,
    faces: NDArray[np.int32],
    x0: float,
    y0: float,
    side: float,
    nx: int,
    ny: int,
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Return the faces of every cell, one cell after the other, and where each cell starts."""
    start = np.zeros(nx * ny + 1, dtype=np.int64)
    _bin_pass(corners, faces, x0, y0, side, nx, ny, start[1:], np.empty(0, dtype=np.int32))
    start = np.cumsum(start)
    members = np.empty(start[-1], dtype=np.int32)
    _bin_pass(corners, faces, x0, y0, side, nx, ny, start[:-1].copy(), members)
    return members, start


@kernel
def _face_range(
    corners: FloatArray, face: int, x: float, y: float, half: float
) -> tuple[float, float]:
    """Return the elevations of a triangle's plane in a square, within those of the triangle."""
    a, b, c = corners[face, 0], corners[face, 1], corners[face, 2]
    low, high = min(a[2], b[2], c[2]), max(a[2], b[2], c[2])
    nx = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
    ny = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2])
    nz = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if abs(nz) > 1e-4 * (abs(nx) + abs(ny)):
        middle = a[2] - (nx * (x - a[0]) + ny * (y - a[1])) / nz
        spread = half * (abs(nx) + abs(ny)) / abs(nz)
        low, high = max(low, middle - spread), min(high, middle + spread)
    return low - PADDING, high + PADDING


@kernel
def elevation_ranges(
    corners: FloatArray,
    members: NDArray[np.int32],
    start: NDArray[np.int64],
    x0: float,
    y0: float,
    side: float,
    nx: int,
    out: FloatArray,
) -> None:
    half = 0.5 * side + PADDING
    for number in range(start.size - 1):
        x, y = x0 + (number % nx + 0.5) * side, y0 + (number // nx + 0.5) * side
        out[number, 0], out[number, 1] = np.inf, -np.inf
        for face in members[start[number] : start[number + 1]]:
            low, high = _face_range(corners, face, x, y, half)
            out[number, 0] = min(out[number, 0], low)
            out[number, 1] = max(out[number, 1], high)

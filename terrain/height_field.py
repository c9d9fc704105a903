"""Elevations on a lattice, made into triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import trimesh

FloatArray = NDArray[np.float64]


def triangulate(x: FloatArray, y: FloatArray, z: FloatArray) -> trimesh.Trimesh:
    """Return the mesh of a lattice of points, faces counter-clockwise seen from above.

    Parameters
    ----------
    x, y, z : array (rows, cols)
        Local coordinates [m]; a nan elevation leaves a hole, never a bridge.

    Raises
    ------
    ValueError
        When no three neighbours have an elevation.

    Examples
    --------
    >>> x, y = np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0])
    >>> len(triangulate(x, y, np.array([[0.0, 0.0, 0.0], [0.0, 0.0, np.nan]])).faces)
    3
    """
    import trimesh

    number = np.arange(z.size).reshape(z.shape)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    spare = np.stack([b, c, d, a, b, d], axis=-1).reshape(-1, 3)  # the other diagonal
    valid = np.isfinite(z).ravel()
    usable = valid[faces].all(axis=1).reshape(-1, 2)
    other = valid[spare].all(axis=1).reshape(-1, 2) & ~usable.any(axis=1, keepdims=True)
    chosen = np.concatenate([faces[usable.ravel()], spare[other.ravel()]])
    if len(chosen) == 0:
        raise ValueError("seabed: no three neighbouring cells have an elevation")
    if _turns_clockwise(x, y):
        chosen = chosen[:, ::-1]
    used, chosen = np.unique(chosen, return_inverse=True)
    vertices = np.column_stack([x.ravel(), y.ravel(), z.ravel()])[used]
    return trimesh.Trimesh(vertices, chosen.reshape(-1, 3), process=False)


def _turns_clockwise(x: FloatArray, y: FloatArray) -> bool:
    along_col = x[0, 1] - x[0, 0], y[0, 1] - y[0, 0]
    along_row = x[1, 0] - x[0, 0], y[1, 0] - y[0, 0]
    return bool(along_col[0] * along_row[1] - along_col[1] * along_row[0] < 0.0)


def refine(z: FloatArray, factor: int) -> FloatArray:
    """Return elevations at ``factor`` times as many points along each axis.

    Cubic convolution (Catmull-Rom) where all 16 neighbours are known, bilinear where the nearest
    four are, nan elsewhere. Given points keep their values; a plane stays a plane.

    Examples
    --------
    >>> refine(np.array([[0.0, 1.0], [2.0, 3.0]]), 2)
    array([[0. , 0.5, 1. ],
           [1. , 1.5, 2. ],
           [2. , 2.5, 3. ]])
    """
    cubic = _cubic(_cubic(z, factor).T, factor).T
    linear = _linear(_linear(z, factor).T, factor).T
    return np.where(np.isfinite(cubic), cubic, linear)


def _linear(z: FloatArray, factor: int) -> FloatArray:
    """Return linear interpolation along the first axis; nan beside an unknown value."""
    index, t = _places(len(z), factor)
    left, right = z[index], z[index + 1]
    between = np.where(t == 1.0, right, left + t * (right - left))
    return np.where(t == 0.0, left, between)


def _cubic(z: FloatArray, factor: int) -> FloatArray:
    """Return cubic convolution along the first axis; nan where one of four is unknown."""
    index, t = _places(len(z), factor)
    padded = np.pad(z, ((1, 1), (0, 0)), constant_values=np.nan)
    before, left, right, after = (padded[index + i] for i in range(4))
    slope = right - before
    second = 2.0 * before - 5.0 * left + 4.0 * right - after
    third = 3.0 * (left - right) + after - before
    between = left + 0.5 * t * (slope + t * (second + t * third))
    return np.where(t == 0.0, left, np.where(t == 1.0, right, between))


def _places(count: int, factor: int) -> tuple[NDArray[np.int64], FloatArray]:
    """Return the left neighbour of every new point and its distance from it, 0 to 1."""
    position = np.arange((count - 1) * factor + 1)
    index = np.minimum(position // factor, count - 2)
    return index, ((position - index * factor) / factor)[:, None]

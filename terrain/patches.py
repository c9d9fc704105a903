"""Patches of about a metre on the mesh, on which arrivals of two random walks are paired.

Every point of every face belongs to exactly one patch, whose area is exact: the pairing divides by
it. A large triangle is cut into equal similar triangles, found from the barycentric coordinates of
the point; small triangles of one lattice cell, of like normal and of one reflectance share a patch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import leaf_kernel

if TYPE_CHECKING:
    import trimesh

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

NORMAL_CLASSES_PER_SIDE = 3  # of each side of a cube about the normals: 25 degrees from its middle


class PatchTable(NamedTuple):
    """Patches of a mesh, as compiled kernels take them.

    ``cuts`` (faces,) sub-triangles along an edge of a large face, 0 for a face in a cluster;
    ``first`` (faces,) number of the face's first patch; ``corners`` (faces, 3, 3) and
    ``face_area`` (faces,) of the mesh; ``area`` (clusters,) and ``centre`` (clusters, 3) of the
    clusters, whose patches are the first; ``patches`` is the count of all.
    """

    cuts: IntArray
    first: IntArray
    corners: FloatArray
    face_area: FloatArray
    area: FloatArray
    centre: FloatArray
    patches: int


def patch_table(mesh: trimesh.Trimesh, *, patch_size: float, reflectance: FloatArray) -> PatchTable:
    """Return the patches of a mesh.

    Parameters
    ----------
    patch_size : float
        Longest edge of a cut-out triangle, and side of the lattice of the clusters [m].
    reflectance : array (faces,)
        Faces of unlike reflectance never share a patch.

    Raises
    ------
    ValueError
        When the size is not positive or the reflectances are not one per face.

    Examples
    --------
    >>> import trimesh
    >>> cube = trimesh.creation.box(extents=[2.0, 2.0, 2.0])
    >>> table = patch_table(cube, patch_size=1.0, reflectance=np.full(12, 0.2))
    >>> table.patches, int(table.cuts[0])
    (108, 3)
    """
    if not (np.isfinite(patch_size) and patch_size > 0.0):
        raise ValueError(f"patch_size: {patch_size} is not a positive length")
    corners = np.ascontiguousarray(mesh.triangles, dtype=np.float64)
    if np.shape(reflectance) != (len(corners),):
        raise ValueError(f"reflectance: {np.shape(reflectance)} is not one per face")
    edges = np.roll(corners, -1, axis=1) - corners
    longest = np.sqrt((edges**2).sum(axis=2).max(axis=1))
    normals = 0.5 * np.cross(edges[:, 0], edges[:, 1])
    face_area = np.sqrt((normals**2).sum(axis=1))
    cuts = np.where(longest > patch_size, np.ceil(longest / patch_size), 0.0).astype(np.int64)
    small = np.flatnonzero(cuts == 0)
    first = np.empty(len(corners), dtype=np.int64)
    centroids = corners[small].mean(axis=1)
    keys = _cluster_keys(centroids, normals[small], reflectance[small], patch_size)
    first[small], area, centre = _clusters(keys, centroids, face_area[small])
    ends = len(area) + np.cumsum(cuts**2)
    first[cuts > 0] = (ends - cuts**2)[cuts > 0]
    return PatchTable(cuts, first, corners, face_area, area, centre, int(ends[-1]))


def _cluster_keys(
    centroids: FloatArray, normals: FloatArray, reflectance: FloatArray, size: float
) -> IntArray:
    """Return rows (faces, 5): lattice cell, class of the normal, class of the reflectance."""
    cells = np.floor(centroids / size).astype(np.int64)
    shades = np.unique(reflectance, return_inverse=True)[1].reshape(-1)
    return np.column_stack([cells, _normal_class(normals), shades])


def _normal_class(normals: FloatArray) -> IntArray:
    """Return which ninth of which side of a cube a normal passes through."""
    rows = np.arange(len(normals))
    axis = np.abs(normals).argmax(axis=1)
    largest = normals[rows, axis]
    scale = np.where(largest == 0.0, 1.0, np.abs(largest))
    n = NORMAL_CLASSES_PER_SIDE
    ninths = []
    for shift in (1, 2):
        across = normals[rows, (axis + shift) % 3] / scale
        ninths.append(np.clip(np.floor((across + 1.0) * (n / 2)), 0, n - 1).astype(np.int64))
    side = 2 * axis + (largest < 0.0)
    classes: IntArray = (side * n + ninths[0]) * n + ninths[1]
    return classes


def _clusters(
    keys: IntArray, centroids: FloatArray, areas: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return cluster of each face, area of each cluster and its area-weighted centre."""
    if len(keys) == 0:
        return np.empty(0, dtype=np.int64), np.empty(0), np.empty((0, 3))
    number = np.unique(keys, axis=0, return_inverse=True)[1].reshape(-1)
    area = np.bincount(number, weights=areas)
    moments = [np.bincount(number, weights=areas * centroids[:, i]) for i in range(3)]
    centre = np.column_stack(moments) / area[:, None]
    return number.astype(np.int64), area.astype(np.float64), centre


@leaf_kernel
def patch_at(
    table: PatchTable, face: int, x: float, y: float, z: float
) -> tuple[int, float, float, float, float]:
    """Return patch, its area [m2] and its centre x, y, z [m] at a point of a face."""
    k = table.cuts[face]
    number = table.first[face]
    if k == 0:
        c = table.centre
        return number, table.area[number], c[number, 0], c[number, 1], c[number, 2]
    u, v = _barycentric(table.corners, face, x, y, z)
    i = int(min(max(np.floor(k * u), 0.0), k - 1.0))
    j = int(min(max(np.floor(k * v), 0.0), k - 1.0 - i))
    far = 1 if k * (u + v) > i + j + 1.0 and j < k - 1 - i else 0
    number += i * (2 * k - i) + 2 * j + far
    a = (i + (1 + far) / 3.0) / k
    b = (j + (1 + far) / 3.0) / k
    q = table.corners
    return (
        number,
        table.face_area[face] / (k * k),
        q[face, 0, 0] + a * (q[face, 1, 0] - q[face, 0, 0]) + b * (q[face, 2, 0] - q[face, 0, 0]),
        q[face, 0, 1] + a * (q[face, 1, 1] - q[face, 0, 1]) + b * (q[face, 2, 1] - q[face, 0, 1]),
        q[face, 0, 2] + a * (q[face, 1, 2] - q[face, 0, 2]) + b * (q[face, 2, 2] - q[face, 0, 2]),
    )


@leaf_kernel
def _barycentric(
    corners: FloatArray, face: int, x: float, y: float, z: float
) -> tuple[float, float]:
    """Return the weights of the second and the third corner at a point of the plane."""
    ax, ay, az = corners[face, 0, 0], corners[face, 0, 1], corners[face, 0, 2]
    ex, ey, ez = corners[face, 1, 0] - ax, corners[face, 1, 1] - ay, corners[face, 1, 2] - az
    fx, fy, fz = corners[face, 2, 0] - ax, corners[face, 2, 1] - ay, corners[face, 2, 2] - az
    px, py, pz = x - ax, y - ay, z - az
    ee, ff, ef = (
        ex * ex + ey * ey + ez * ez,
        fx * fx + fy * fy + fz * fz,
        ex * fx + ey * fy + ez * fz,
    )
    pe, pf = px * ex + py * ey + pz * ez, px * fx + py * fy + pz * fz
    determinant = ee * ff - ef * ef
    return (ff * pe - ef * pf) / determinant, (ee * pf - ef * pe) / determinant

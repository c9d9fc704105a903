"""Patches cover the mesh once, with the areas that the pairing of walks divides by."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from terrain.kernels import kernel
from terrain.patches import PatchTable, patch_at, patch_table


@kernel
def _all(table: PatchTable, faces: np.ndarray, points: np.ndarray, out: np.ndarray) -> None:
    for i in range(len(faces)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        patch, area, cx, cy, cz = patch_at(table, faces[i], x, y, z)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4] = patch, area, cx, cy, cz


def look_up(
    table: PatchTable, faces: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    out = np.empty((len(faces), 5))
    _all(table, faces, points, out)
    return out[:, 0].astype(int), out[:, 1], out[:, 2:]


def scene(large: bool) -> trimesh.Trimesh:
    """A rough seabed of 0.3 m or 5 m triangles with a fine ball and a coarse slab."""
    rng = np.random.default_rng(1)
    spacing, n = (5.0, 5) if large else (0.3, 50)
    x, y = np.meshgrid(np.arange(n) * spacing, np.arange(n) * spacing)
    z = -10.0 + 0.1 * spacing * rng.standard_normal(x.shape)
    k = np.arange(n * n).reshape(n, n)
    a, b, c, d = (q.ravel() for q in (k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]))
    faces = np.concatenate([np.c_[a, b, c], np.c_[a, c, d]])
    seabed = trimesh.Trimesh(np.c_[x.ravel(), y.ravel(), z.ravel()], faces, process=False)
    ball = trimesh.creation.icosphere(subdivisions=4, radius=2.0).apply_translation([4, 4, -6.0])
    slab = trimesh.creation.box(extents=[6.0, 2.0, 0.1]).apply_translation([9, 9, -8.0])
    return trimesh.util.concatenate([seabed, ball, slab])


def sample(
    mesh: trimesh.Trimesh, count: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    faces = rng.choice(len(mesh.faces), size=count, p=mesh.area_faces / mesh.area)
    r, s = np.sqrt(rng.random(count)), rng.random(count)
    weights = np.c_[1 - r, r * (1 - s), r * s]
    return faces, np.einsum("ni,nij->nj", weights, mesh.triangles[faces])


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("size", [0.5, 1.0, 2.3])
def test_areas_and_centres(large: bool, size: float) -> None:
    """Each patch once sums to the mesh; points fall in it as its area says; it is compact."""
    rng = np.random.default_rng(2)
    mesh = scene(large)
    table = patch_table(mesh, patch_size=size, reflectance=np.full(len(mesh.faces), 0.2))
    count = 400 * table.patches
    faces, points = sample(mesh, min(count, 800_000), rng)
    number, area, centre = look_up(table, faces, points)
    ids, index, hits = np.unique(number, return_index=True, return_counts=True)
    assert ids[0] >= 0
    assert ids[-1] < table.patches
    unseen = mesh.area - area[index].sum()  # a sliver may have got no point
    assert 0.0 - 1e-9 <= unseen < 1e-3 * mesh.area
    expected = area[index] / mesh.area * len(faces)
    chi_square = ((hits - expected) ** 2 / expected)[expected > 20]
    assert abs(chi_square.mean() - 1.0) < 5.0 * np.sqrt(2.0 / len(chi_square))
    assert chi_square.max() < 35.0
    reach = size if large else np.sqrt(3.0) * size + size
    assert np.linalg.norm(points - centre, axis=1).max() < reach + 1e-9


def test_the_centre_is_the_mean_of_the_points() -> None:
    rng = np.random.default_rng(3)
    triangle = trimesh.Trimesh([[0, 0, 0], [3, 0, 1], [0, 2, 0]], [[0, 1, 2]], process=False)
    table = patch_table(triangle, patch_size=1.0, reflectance=np.array([0.2]))
    assert table.cuts[0] == 4  # the longest edge is sqrt(14) m
    faces, points = sample(triangle, 400_000, rng)
    number, area, centre = look_up(table, faces, points)
    np.testing.assert_allclose(area, triangle.area / 16)
    assert set(number) == set(range(16))
    for patch in range(16):
        inside = number == patch
        np.testing.assert_allclose(points[inside].mean(axis=0), centre[inside][0], atol=0.01)


def test_corners_and_edges_belong_to_a_patch_of_their_face() -> None:
    triangle = trimesh.Trimesh([[0, 0, 0], [7, 0, 0], [0, 7, 0]], [[0, 1, 2]], process=False)
    table = patch_table(triangle, patch_size=1.0, reflectance=np.array([0.2]))
    s = np.linspace(0.0, 1.0, 141)[:, None]
    p = triangle.vertices
    rim = np.concatenate([p[a] + s * (p[b] - p[a]) for a, b in ((0, 1), (1, 2), (2, 0))])
    number, _, centre = look_up(table, np.zeros(len(rim), dtype=np.int64), rim)
    assert number.min() >= 0
    assert number.max() < table.patches == 100
    assert np.linalg.norm(rim - centre, axis=1).max() < 0.7


def test_two_sides_of_a_plate_and_two_shades_never_share_a_patch() -> None:
    plate = trimesh.creation.box(extents=[2.0, 2.0, 0.05]).subdivide().subdivide().subdivide()
    plate.apply_translation([0.0, 0.0, 0.5])
    shade = np.where(plate.triangles_center[:, 0] > 0.13, 0.1, 0.4)
    table = patch_table(plate, patch_size=1.0, reflectance=shade)
    number, _, _ = look_up(table, np.arange(len(plate.faces)), plate.triangles_center)
    for patch in np.unique(number):
        same = number == patch
        assert len(np.unique(shade[same])) == 1
        normals = plate.face_normals[same]
        assert (normals @ normals.T).min() > np.cos(np.radians(51))


def test_like_normals_are_within_25_degrees_of_the_class() -> None:
    rng = np.random.default_rng(4)
    centre = rng.uniform(0.2, 0.8, size=(4000, 1, 3))
    corners = centre + 0.02 * rng.standard_normal((4000, 3, 3))
    soup = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(12000).reshape(-1, 3), process=False)
    table = patch_table(soup, patch_size=1.0, reflectance=np.full(4000, 0.2))
    assert len(table.area) == 54
    number, _, _ = look_up(table, np.arange(4000), soup.triangles_center)
    for patch in range(54):
        normals = soup.face_normals[number == patch]
        mean = normals.mean(axis=0)
        assert (normals @ (mean / np.linalg.norm(mean))).min() > np.cos(np.radians(30))


def test_bad_arguments_are_named() -> None:
    box = trimesh.creation.box()
    with pytest.raises(ValueError, match="patch_size"):
        patch_table(box, patch_size=0.0, reflectance=np.ones(12))
    with pytest.raises(ValueError, match="one per face"):
        patch_table(box, patch_size=1.0, reflectance=np.ones(3))

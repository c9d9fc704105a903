"""Rays against triangle meshes: closed forms, an independent ray tracer, and no leak anywhere."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from terrain.raycast import build_grid, cast_rays

DOWN = np.array([0.0, 0.0, -1.0])


def raster_mesh(z: np.ndarray, spacing: float = 1.0) -> trimesh.Trimesh:
    rows, cols = z.shape
    x, y = np.meshgrid(np.arange(cols) * spacing, np.arange(rows) * spacing)
    n = np.arange(z.size).reshape(z.shape)
    a, b, c, d = (q.ravel() for q in (n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]))
    faces = np.concatenate([np.c_[a, b, c], np.c_[a, c, d]])
    return trimesh.Trimesh(np.c_[x.ravel(), y.ravel(), z.ravel()], faces, process=False)


def rough_with_wreck(rng: np.random.Generator) -> trimesh.Trimesh:
    seabed = raster_mesh(-10.0 + 0.3 * rng.standard_normal((80, 120)))
    hull = trimesh.creation.icosphere(subdivisions=5)
    hull.apply_scale([15.0, 3.0, 2.0])
    hull.apply_transform(trimesh.transformations.euler_matrix(0.4, 0.1, 0.7))
    hull.apply_translation([60.0, 40.0, -8.5])
    return trimesh.util.concatenate([seabed, hull])


def unit_vectors(rng: np.random.Generator, count: int) -> np.ndarray:
    v = rng.standard_normal((count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def test_agrees_with_embree_on_a_rough_seabed_with_a_wreck() -> None:
    """An own traversal may be wrong in its own way; embree is somebody else's."""
    embree = pytest.importorskip("trimesh.ray.ray_pyembree")
    rng = np.random.default_rng(1)
    mesh = rough_with_wreck(rng)
    origins = rng.uniform([1, 1, -9], [118, 78, 10], size=(100_000, 3))
    directions = unit_vectors(rng, len(origins))
    t, face = cast_rays(build_grid(mesh), origins, directions)
    theirs = embree.RayMeshIntersector(mesh).intersects_first(origins, directions)
    assert 0.3 < (face >= 0).mean() < 0.9
    assert (face != theirs).sum() < 20  # float32 may decide otherwise at an edge or a silhouette
    hit = face >= 0
    corners, normals = mesh.triangles[face[hit], 0], mesh.face_normals[face[hit]]
    points = origins[hit] + t[hit, None] * directions[hit]
    assert np.abs(((points - corners) * normals).sum(axis=1)).max() < 1e-9


@pytest.mark.parametrize("tilt", [0.0, 0.7, 1.3])
def test_no_ray_slips_through_vertices_and_edges(tilt: float) -> None:
    """A ray from above the highest to below the lowest point has to meet the sheet between."""
    rng = np.random.default_rng(2)
    mesh = raster_mesh(np.clip(-10.0 + 0.2 * rng.standard_normal((64, 64)), -10.8, -9.2))
    inner = rng.integers(8, 55, size=(150_000, 2))
    at_vertex = mesh.vertices[inner[:, 1] * 64 + inner[:, 0]]
    ends = mesh.vertices[mesh.edges_unique[rng.integers(len(mesh.edges_unique), size=250_000)]]
    ends = ends[(ends[:, :, :2].min(axis=(1, 2)) > 8) & (ends[:, :, :2].max(axis=(1, 2)) < 55)]
    on_edge = ends[:, 0] + rng.choice([0.5, 0.25, 0.1], (len(ends), 1)) * (ends[:, 1] - ends[:, 0])
    targets = np.concatenate([at_vertex, on_edge])
    azimuth = rng.integers(0, 8, len(targets)) * np.pi / 4
    level = np.c_[np.sin(azimuth) * np.sin(tilt), np.cos(azimuth) * np.sin(tilt)]
    directions = np.c_[level, np.full(len(targets), -np.cos(tilt))]
    origins = targets + (targets[:, 2:] + 9.0) / np.cos(tilt) * directions
    t, _ = cast_rays(build_grid(mesh), origins, directions, 2.0 / np.cos(tilt))
    assert np.isfinite(t).all()


def test_a_closed_body_lets_nothing_out() -> None:
    rng = np.random.default_rng(3)
    ball = trimesh.creation.icosphere(subdivisions=4, radius=7.0)
    directions = unit_vectors(rng, 300_000)
    directions[: len(ball.vertices)] = ball.vertices / 7.0
    t, _ = cast_rays(build_grid(ball), np.zeros(3), directions)
    assert t.max() <= 7.0 + 1e-9
    assert t.min() > 7.0 * np.cos(0.05)


def test_vertical_rays_on_a_lattice_of_whole_numbers() -> None:
    """Vertices, edges and cell borders coincide; elevations are those of the vertices."""
    rng = np.random.default_rng(4)
    z = rng.integers(-12, -8, size=(33, 33)).astype(float)
    x, y = np.meshgrid(np.arange(33.0), np.arange(33.0))
    t, _ = cast_rays(build_grid(raster_mesh(z)), np.c_[x.ravel(), y.ravel(), 0 * x.ravel()], DOWN)
    np.testing.assert_allclose(t, -z.ravel(), atol=1e-12)


def test_slanted_ray_on_a_plane_has_the_length_of_geometry() -> None:
    square = raster_mesh(np.full((2, 2), -10.0), spacing=1000.0)
    angles = np.radians([0.0, 1e-7, 30.0, 60.0, 88.0])
    directions = np.c_[np.sin(angles), 0 * angles, -np.cos(angles)]
    t, _ = cast_rays(build_grid(square), np.array([300.0, 400.0, 0.0]), directions)
    np.testing.assert_allclose(t, 10.0 / np.cos(angles), rtol=1e-12)


def test_longest_distance_is_kept() -> None:
    grid = build_grid(raster_mesh(np.full((20, 20), -10.0)))
    origin = np.array([5.3, 5.4, -7.0])
    t, face = cast_rays(grid, origin, np.tile(DOWN, (3, 1)), np.array([2.9999, 3.0, np.inf]))
    np.testing.assert_array_equal(face >= 0, [False, True, True])
    assert t[0] == np.inf
    level, _ = cast_rays(grid, origin, np.array([1.0, 0.0, 0.0]), np.inf)
    outside, _ = cast_rays(grid, np.array([-1.0, 5.0, 0.0]), DOWN)
    assert np.isinf([*level, *outside]).all()


def test_short_steps_find_what_long_rays_find() -> None:
    """The early out for short steps may only save time: cut a ray into steps, hit the same."""
    rng = np.random.default_rng(5)
    grid = build_grid(rough_with_wreck(rng))
    origins = rng.uniform([30, 20, -7], [90, 60, 0], size=(2000, 3))
    directions = unit_vectors(rng, len(origins))
    whole, face = cast_rays(grid, origins, directions, 40.0)
    found = np.full(len(origins), -1)
    for start in np.arange(0.0, 40.0, 0.5):
        t, hit = cast_rays(grid, origins + start * directions, directions, 0.5)
        first = (found < 0) & (hit >= 0)
        np.testing.assert_allclose(start + t[first], whole[first], atol=1e-9)
        found[first] = hit[first]
    np.testing.assert_array_equal(found >= 0, face >= 0)


def test_short_steps_between_columns_miss_none() -> None:
    """Columns high above a bottom: a step touches a coarse cell that holds neither of its ends."""
    rng = np.random.default_rng(6)
    places = rng.uniform(5, 95, size=(8, 2))
    columns = [trimesh.creation.box(extents=[0.3, 0.3, 8.0]) for _ in places]
    for column, (x, y) in zip(columns, places, strict=True):
        column.apply_translation([x, y, -8.0])
    bottom = raster_mesh(np.full((11, 11), -12.0), spacing=10.0)
    grid = build_grid(trimesh.util.concatenate([bottom, *columns]))
    azimuth = rng.uniform(0.0, 2 * np.pi, 200_000)
    directions = np.c_[np.sin(azimuth), np.cos(azimuth), 0.0 * azimuth]
    back = rng.uniform(0.3, grid.cell, size=(len(azimuth), 1))
    origins = np.c_[places[rng.integers(8, size=len(azimuth))], np.full(len(azimuth), -5.5)]
    origins -= back * directions
    whole, _ = cast_rays(grid, origins, directions)
    step = 0.69 * grid.cell
    stepped, _ = cast_rays(grid, origins, directions, step)
    assert 0.5 < np.isfinite(stepped).mean() < 0.9
    np.testing.assert_array_equal(stepped, np.where(whole <= step, whole, np.inf))


def test_under_an_overhang_the_deck_is_seen_from_both_sides() -> None:
    deck = trimesh.creation.box(extents=[4.0, 4.0, 0.2])
    deck.apply_translation([10.0, 10.0, -5.0])
    grid = build_grid(trimesh.util.concatenate([raster_mesh(np.full((20, 20), -10.0)), deck]))
    origins = np.array([[10.1, 10.2, 0.0], [10.1, 10.2, -7.0], [10.1, 10.2, -7.0]])
    t, _ = cast_rays(grid, origins, np.array([DOWN, -DOWN, DOWN]))
    np.testing.assert_allclose(t, [4.9, 1.9, 3.0], atol=1e-12)


def test_directions_that_are_none_are_refused() -> None:
    grid = build_grid(raster_mesh(np.zeros((2, 2))))
    with pytest.raises(ValueError, match="zero vector"):
        cast_rays(grid, np.zeros(3), np.zeros(3))
    with pytest.raises(ValueError, match="finite"):
        cast_rays(grid, np.array([np.nan, 0, 0]), DOWN)

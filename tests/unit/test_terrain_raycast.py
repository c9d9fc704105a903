"""Rays against triangle meshes: closed forms, an independent ray tracer, and no leak anywhere."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from terrain.bedforms import ripples
from terrain.boulder_field import BoulderField
from terrain.generators import Ground
from terrain.map_frame import MapFrame
from terrain.objects import cube, place, wreck
from terrain.pipeline import FreeSpan, pipeline
from terrain.raycast import build_grid, cast_rays
from terrain.roughness import Roughness
from terrain.seabed import Seabed

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


def cluttered_seabed() -> Seabed:
    """A rippled, rough bed with all that overhangs: wreck, free-spanning pipe, boulders, cubes."""
    frame = MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714)
    relief = Roughness(rms=0.1, spectral_slope=3.0, longest_wavelength=10.0, seed=2)
    ground = Ground(map_frame=frame, length=80.0, width=80.0, reflectance=0.1, roughness=relief)
    bed = ripples(ground=ground, depth=8.0, wavelength=6.0, height=0.4, spacing=0.25)
    field = BoulderField(
        length=60.0, width=60.0, density=0.01, least_diameter=0.5, mean_diameter=1.0,
        largest_diameter=3.0, burial=0.2, relief=0.15, seed=1,
    )  # fmt: skip
    route = np.array([[-35.0, -30.0], [0.0, -12.0], [35.0, -10.0]])
    spans = [FreeSpan(start=20.0, length=25.0, gap=1.0)]
    bodies = [
        place(wreck(), seabed=bed, east=5.0, north=12.0, heading=0.6, list_angle=0.4, burial=0.3),
        pipeline(seabed=bed, route=route, diameter=0.6, spans=spans),
        field.bodies(seabed=bed, east=0.0, north=0.0),
        *(place(cube(side=side), seabed=bed, east=-20.0, north=15.0 * side) for side in (1.0, 2.0)),
    ]
    for body in bodies:
        bed = bed.with_object(body, reflectance=0.1, source="")
    return bed


@pytest.mark.parametrize("count", [50_000, pytest.param(1_000_000, marks=pytest.mark.slow)])
def test_agrees_with_embree_under_overhangs(count: int) -> None:
    """Faces and distances, from above and from inside the clutter; Embree is single precision.

    Where the two differ the ray grazes an edge: they may take either of two faces that meet there,
    or one of them the silhouette and the other what lies behind.
    """
    embree = pytest.importorskip("trimesh.ray.ray_pyembree")
    rng = np.random.default_rng(7)
    bed = cluttered_seabed()
    origins = rng.uniform([-39, -39, -7.9], [39, 39, 0], size=(count, 3))
    directions = unit_vectors(rng, count)
    directions[: count // 2, 2] = -np.abs(directions[: count // 2, 2])
    t, face = cast_rays(bed.grid, origins, directions)
    theirs = embree.RayMeshIntersector(bed.mesh).intersects_first(origins, directions)
    assert 0.5 < (face >= 0).mean() < 0.95
    on_objects = face[face >= 0]
    assert bed.is_object[on_objects].mean() > 0.02
    down = bed.grid.normals[on_objects, 2] < -0.1
    assert (down & bed.is_object[on_objects]).sum() > 1e-3 * count  # seen from below
    differing = np.flatnonzero(face != theirs)
    assert len(differing) < 2e-4 * count
    both = differing[(face[differing] >= 0) & (theirs[differing] >= 0)]
    normal, corner = bed.grid.normals[theirs[both]], bed.grid.corners[theirs[both], 0]
    along = ((corner - origins[both]) * normal).sum(axis=1) / (directions[both] * normal).sum(
        axis=1
    )
    apart = np.abs(along - t[both]) > 1e-3
    assert len(differing) - len(both) + apart.sum() < 2e-5 * count


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

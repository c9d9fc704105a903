"""A seabed answers where its surface is, and refuses flights beyond it."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from terrain.height_field import refine, triangulate
from terrain.map_frame import MapFrame
from terrain.seabed import CoverageError, Seabed, uniform_seabed

FRAME = MapFrame(easting=500000.0, northing=6000000.0, epsg=25832, vertical_epsg=5714)


def seabed_of(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> Seabed:
    mesh = triangulate(x, y, z)
    return uniform_seabed(mesh, reflectance=0.2, map_frame=FRAME, source="A test.")


def tilted(hole: bool = False) -> Seabed:
    x, y = np.meshgrid(np.arange(0.0, 101.0, 5.0), np.arange(0.0, 51.0, 5.0))
    z = -10.0 - 0.05 * x + 0.02 * y
    if hole:
        z[4:7, 8:11] = np.nan
    return seabed_of(x, y, z)


def rectangle(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def test_elevation_is_that_of_the_plane_and_nan_outside() -> None:
    rng = np.random.default_rng(1)
    x, y = rng.uniform(0, 100, (7, 9)), rng.uniform(0, 50, (7, 9))
    z = tilted().elevation_at(x, y)
    np.testing.assert_allclose(z, -10.0 - 0.05 * x + 0.02 * y, atol=1e-12)
    assert np.isnan(tilted().elevation_at([-0.01, 50.0], [10.0, 50.01])).all()


def test_the_topmost_of_two_levels_counts() -> None:
    deck = trimesh.creation.box(extents=[4.0, 4.0, 0.2])
    deck.apply_translation([20.0, 20.0, -5.0])
    both = tilted().with_object(deck, reflectance=0.5, source="A deck.")
    assert both.elevation_at(20.3, 20.4) == pytest.approx(-4.9)
    assert both.is_object.sum() == 12
    assert both.is_object[-12:].all()
    np.testing.assert_array_equal(both.reflectance[[0, -1]], [0.2, 0.5])
    assert both.source == "A test. A deck."


@pytest.mark.parametrize(("flip_x", "flip_y"), [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_faces_look_up_whichever_way_the_lattice_runs(flip_x: int, flip_y: int) -> None:
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0))
    mesh = triangulate(x[:, ::flip_x], y[::flip_y], np.zeros((4, 5)))
    np.testing.assert_array_equal(mesh.face_normals[:, 2], 1.0)
    assert mesh.area == pytest.approx(12.0)


def test_an_unknown_cell_leaves_a_hole_of_its_size() -> None:
    """One nan of 5 m cells: the four quads about it lose their half towards it."""
    x, y = np.meshgrid(np.arange(5.0) * 5, np.arange(5.0) * 5)
    z = np.zeros((5, 5))
    z[2, 2] = np.nan
    mesh = triangulate(x, y, z)
    assert mesh.area == pytest.approx(400.0 - 4 * 12.5)
    assert np.isnan(seabed_of(x, y, z).elevation_at(10.0, 10.0))


def test_refining_keeps_points_and_planes_and_rounds_a_wave() -> None:
    x, y = np.meshgrid(np.arange(12.0), np.arange(9.0))
    fx, fy = np.meshgrid(np.linspace(0, 11, 45), np.linspace(0, 8, 33))
    np.testing.assert_allclose(refine(3 * x - 2 * y, 4), 3 * fx - 2 * fy, atol=1e-12)
    wave = refine(np.sin(x) * np.cos(y), 4)
    np.testing.assert_allclose(wave[::4, ::4], np.sin(x) * np.cos(y), atol=1e-12)
    inner = (slice(4, -4), slice(4, -4))
    error = np.abs(wave - np.sin(fx) * np.cos(fy))[inner].max()
    assert error < 0.06  # linear interpolation is 0.23 off
    gap = np.where((x == 5) & (y == 4), np.nan, 0.0)
    unknown = np.isnan(refine(gap, 4))
    np.testing.assert_array_equal(unknown, (np.abs(fx - 5) < 1) & (np.abs(fy - 4) < 1))


def test_a_flight_within_the_seabed_is_covered() -> None:
    tilted().require_coverage([rectangle(1, 1, 60, 49), rectangle(50, 1, 99, 49)])


@pytest.mark.parametrize("spacing", [1.0, 0.5])
def test_the_uncovered_extent_is_named_in_map_coordinates(spacing: float) -> None:
    with pytest.raises(CoverageError) as refused:
        tilted().require_coverage([rectangle(20, 10, 120, 30)], label="flight", spacing=spacing)
    message = str(refused.value)
    assert message.startswith("flight: 400 m2 (20 %) of the footprints lie outside the seabed")
    assert "easting 500100." in message
    assert "500120.0" in message
    assert "6000030.0 (EPSG:25832)" in message
    assert "\n" not in message


def test_a_gap_inside_is_found() -> None:
    with pytest.raises(CoverageError, match=r"easting 500035.\d and 500054.\d"):
        tilted(hole=True).require_coverage([rectangle(5, 5, 95, 45)])
    tilted(hole=True).require_coverage([rectangle(5, 5, 30, 45)])


def test_a_turned_footprint_is_judged_by_its_outline_not_its_box() -> None:
    """A triangle fits into a corner where its bounding box would too, a turned square does not."""
    x, y = np.meshgrid(np.arange(0.0, 41.0), np.arange(0.0, 41.0))
    z = np.where(x + y <= 40.0, -5.0, np.nan)
    corner = seabed_of(x, y, z)
    corner.require_coverage([np.array([[1.0, 1.0], [37.0, 1.0], [1.0, 37.0]])])
    with pytest.raises(CoverageError):
        corner.require_coverage([rectangle(1, 1, 37, 37)])


def test_faults_of_a_seabed_are_told_together() -> None:
    box = trimesh.creation.box()
    with pytest.raises(ValueError, match="reflectance") as refused:
        Seabed(
            mesh=box,
            reflectance=np.full(11, 1.5),
            is_object=np.zeros(12, dtype=bool),
            map_frame=FRAME,
            source="",
        )
    assert len(str(refused.value).splitlines()) == 2
    flat = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], process=False)
    with pytest.raises(ValueError, match="face 0 has no area"):
        uniform_seabed(flat, reflectance=0.1, map_frame=FRAME, source="")

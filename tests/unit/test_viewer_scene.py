"""From clouds to data sets, and from where they are looked at."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import trimesh

from survey.cloud.points import PointClass
from viewer import scene
from viewer.labels import round_length
from viewer.view import exaggeration, long_axis, oblique_view

WATER = {"water_level": 0.25, "exaggeration": 5.0}


def test_bottom_points_carry_unstretched_depth(small_survey: Any) -> None:
    data = scene.bottom_points(small_survey.bottom, **WATER)
    solid = small_survey.bottom.classification != PointClass.NO_BOTTOM_FOUND
    assert data.n_points == solid.sum()
    depth = 0.25 - small_survey.bottom.position[solid, 2]
    np.testing.assert_allclose(data[scene.DEPTH], depth)
    np.testing.assert_allclose(data.points[:, 2], 0.25 - 5.0 * depth, atol=1e-4)


def test_bottom_surface_follows_the_true_seabed(small_survey: Any) -> None:
    mesh = scene.bottom_surface(small_survey.bottom, small_survey.map_frame, **WATER)
    x, y = np.asarray(mesh.points)[:, :2].T
    error = mesh[scene.DEPTH] - (0.25 - small_survey.elevation_at(x, y))
    assert np.sqrt(np.mean(error**2)) < 0.25
    span = np.ptp(small_survey.bottom.position[:, :2], axis=0)
    assert np.all(np.ptp(np.asarray(mesh.points)[:, :2], axis=0) > span - 30.0)


def test_a_gap_between_lines_stays_open(survey_of: Any) -> None:
    apart = survey_of(lines=2, frames_per_line=4, spacing=91.2)
    mesh = scene.bottom_surface(apart.bottom, apart.map_frame, **WATER)
    joined = mesh.connectivity("all")
    assert joined["RegionId"].max() == 1
    assert mesh.area > 0.0


def test_contours_lie_at_their_depths(small_survey: Any) -> None:
    mesh = scene.bottom_surface(small_survey.bottom, small_survey.map_frame, **WATER)
    lines = scene.depth_contours(mesh, step=2.0, **WATER)
    depth = np.unique(np.round((0.25 - np.asarray(lines.points)[:, 2]) / 5.0, 3))
    np.testing.assert_allclose(depth, [0.0, 2.0, 4.0, 6.0, 8.0], atol=2e-3)


def test_level_ground_has_contours_without_warning(small_survey: Any) -> None:
    position = small_survey.bottom.position.copy()
    position[:, 2] = -5.0
    level = replace(small_survey.bottom, position=position)
    mesh = scene.bottom_surface(level, small_survey.map_frame, **WATER)
    assert scene.depth_contours(mesh, step=2.0, **WATER).n_points == 0


def test_true_seabed_is_stretched_about_the_water_level() -> None:
    mesh = trimesh.creation.box(extents=(2.0, 2.0, 2.0))
    data = scene.true_seabed(mesh, **WATER)
    assert data.n_cells == 12
    assert np.ptp(np.asarray(data.points)[:, 2]) == pytest.approx(10.0)
    assert sorted(set(data[scene.DEPTH])) == [-0.75, 1.25]


def test_sea_is_level_and_thinned(small_survey: Any) -> None:
    points = scene.surface_points(small_survey.surface, at_most=500, **WATER)
    again = scene.surface_points(small_survey.surface, at_most=500, **WATER)
    assert points.n_points == 500
    assert np.array_equal(points.points, again.points)
    sheet = scene.sea_sheet(small_survey.surface, water_level=0.25)
    assert np.all(np.asarray(sheet.points)[:, 2] == 0.25)
    hull_area = 160.0 * 700.0
    assert sheet.area == pytest.approx(hull_area, rel=0.1)


def test_flight_lines_do_not_join(small_survey: Any) -> None:
    positions = np.array([frame.pose.position for frame in small_survey.frames])
    line = np.array([frame.line for frame in small_survey.frames])
    lines = scene.flight_lines(positions, line)
    assert lines.n_lines == 4
    assert lines.compute_cell_sizes()["Length"].tolist() == pytest.approx([700.0] * 4)


def test_footprint_is_the_outline_of_a_flash(small_survey: Any) -> None:
    corners = scene.footprint(small_survey.bottom, 9)
    sides = np.linalg.norm((np.roll(corners, -1, axis=0) - corners)[:, :2], axis=1)
    np.testing.assert_allclose(sides, [96.0, 44.8, 96.0, 44.8], atol=0.5)
    centre = small_survey.frames[9].pose.position
    np.testing.assert_allclose(corners.mean(axis=0)[:2], centre[:2], atol=0.5)
    assert scene.footprint(small_survey.bottom, 999).shape == (0, 3)


def test_aircraft_points_along_its_heading() -> None:
    plane = scene.aircraft(np.array([10.0, 20.0, 200.0]), np.radians(90.0), length=4.0)
    x, y, z = np.asarray(plane.points).T
    assert x.max() == 12.0
    assert y[np.argmax(x)] == 20.0
    assert np.ptp(y) == pytest.approx(4.8)
    assert np.all(z == 200.0)


def test_light_cone_reaches_its_corners(small_survey: Any) -> None:
    corners = scene.footprint(small_survey.bottom, 9)
    sensor = small_survey.frames[9].pose.position
    cone = scene.light_cone(sensor, corners)
    assert cone.n_cells == 4
    np.testing.assert_allclose(cone.points, np.vstack([sensor, corners]), rtol=1e-6)


def test_long_axis_points_to_the_deep_end(small_survey: Any) -> None:
    solid = scene.solid_positions(small_survey.bottom)
    axis = long_axis(solid[:, :2], solid[:, 2])
    np.testing.assert_allclose(
        axis, [np.sin(np.radians(70.0)), np.cos(np.radians(70.0))], atol=0.02
    )


@pytest.mark.parametrize("size", [(1600, 1000), (600, 900)])
def test_view_holds_its_contents_within_the_margins(
    small_survey: Any, size: tuple[int, int]
) -> None:
    places = small_survey.bottom.position
    axis = long_axis(places[:, :2], places[:, 2])
    view = oblique_view(places, axis=axis, size=size, margins=(10, 20, 30, 40))
    low, high = view.pixels(places).min(axis=0), view.pixels(places).max(axis=0)
    assert np.all(low >= np.array([10, 30]) - 1e-6)
    assert np.all(high <= np.array(size) - [20, 40] + 1e-6)
    assert np.any(np.isclose(high - low, np.array(size) - [30, 70]))
    above = view.pixels(places[:1] + np.array([[0.0, 0.0, 10.0]])) - view.pixels(places[:1])
    assert above[0, 1] > 0.0
    assert above[0, 0] == pytest.approx(0.0, abs=1e-9)


def test_view_is_right_handed(small_survey: Any) -> None:
    places = small_survey.bottom.position
    view = oblique_view(places, axis=np.array([1.0, 0.0]), size=(100, 100), margins=(0, 0, 0, 0))
    np.testing.assert_allclose(np.cross(view.right, view.up), view.towards, atol=1e-12)
    assert view.right[0] > 0.0
    assert view.towards[2] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("relief", "length", "factor"), [(10.0, 800.0, 10.0), (100.0, 100.0, 1.0), (0.0, 50.0, 20.0)]
)
def test_exaggeration_is_a_round_number(relief: float, length: float, factor: float) -> None:
    assert exaggeration(relief, length) == factor


def test_scale_bar_is_a_round_length() -> None:
    assert [round_length(wanted) for wanted in (3.0, 55.0, 210.0)] == [10.0, 50.0, 200.0]

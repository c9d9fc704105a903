"""The scenarios of the gallery, flown with less work, show what they promise."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from survey.cloud.points import Outcome, PointClass, PointCloud
from survey.cloud.stitch import stitched
from survey.mission import fly_frame
from survey.preparation import Mission, prepare
from survey.scenario.load import load_scenario
from terrain.substrate import known_substrates

SUBSTRATES = known_substrates()
FloatArray = NDArray[np.float64]
LESS_WORK: dict[str, Any] = {
    "transport.walks_per_pixel": 32,
    "processing.correct_scattering": False,
}
BOTTOM = (PointClass.BATHYMETRIC, PointClass.SUBMERGED_OBJECT)


def flown(name: str, frames: slice, **changes: Any) -> tuple[Mission, list[PointCloud]]:
    mission = prepare(load_scenario(name).replace(**(LESS_WORK | changes)))
    return mission, [fly_frame(mission, frame).bottom for frame in mission.frames[frames]]


def bottom_errors(cloud: PointCloud) -> FloatArray:
    solid = cloud.select(np.isin(cloud.classification, BOTTOM))
    return np.asarray(solid.position[:, 2] - solid.true_elevation)


def share(cloud: PointCloud, *classes: PointClass) -> float:
    return float(np.isin(cloud.classification, classes).mean())


def test_measured_seabed_shows_beach_and_bottom() -> None:
    _, (beach, bar, deep) = flown("measured-seabed", slice(0, 9, 4))
    assert share(beach, PointClass.GROUND) > 0.5
    assert share(bar, PointClass.BATHYMETRIC) > 0.95
    assert share(deep, PointClass.BATHYMETRIC) > 0.9
    for cloud in (bar, deep):
        assert abs(bottom_errors(cloud).mean()) < 0.15
        assert np.percentile(np.abs(bottom_errors(cloud)), 95.0) < 0.5
    ground = beach.select(beach.classification == PointClass.GROUND)
    assert np.median(np.abs(ground.position[:, 2] - ground.true_elevation)) < 0.05


def test_sandbar_shows_crest_and_trough() -> None:
    _, clouds = flown("sandbar", slice(0, 5), **{"flight.lines": 1})
    cloud = stitched(clouds, cell_size=1.0)
    assert share(clouds[0], PointClass.GROUND) > 0.2
    solid = cloud.select(np.isin(cloud.classification, BOTTOM))
    offshore = solid.position[:, 0] - 20.0
    crest = solid.position[np.abs(offshore - 280.0) < 5.0, 2]
    trough = solid.position[np.abs(offshore - 190.0) < 5.0, 2]
    slope = np.tan(np.radians(0.7))
    assert np.median(crest) == pytest.approx(1.5 - 280.0 * slope, abs=0.2)
    assert np.median(trough) == pytest.approx(1.5 * np.exp(-4.5) - 190.0 * slope, abs=0.2)
    assert np.percentile(np.abs(bottom_errors(cloud)), 95.0) < 0.5


def edge_on_bed(place: float, tangent: float) -> tuple[float, float]:
    """Where a ray ``tangent`` ahead of nadir at ``place`` meets the bed of turned-footprint."""
    sine = tangent / np.hypot(1.0, tangent) / 1.3415
    in_water, gradient = sine / np.sqrt(1.0 - sine**2), np.tan(np.radians(0.57))
    surface = place + 200.0 * tangent
    depth = (2.0 + gradient * surface) / (1.0 - gradient * in_water)
    return surface + depth * in_water, depth


def test_turned_footprint_leaves_gaps_as_wide_as_refraction_makes_them() -> None:
    mission, clouds = flown("turned-footprint", slice(0, 8))
    cloud = stitched(clouds, cell_size=1.0)
    solid = cloud.select(cloud.classification == PointClass.BATHYMETRIC)
    outer = 15.5 * 0.008
    widths, depths = [], []
    for ahead, behind in zip(clouds[1:], clouds, strict=False):
        place = mission.frames[int(behind.frame[0])].pose.position[0]
        start, depth = edge_on_bed(place, outer)
        end, _ = edge_on_bed(place + 100.0, -outer)
        first = middle_of_row(behind, 0)
        last = middle_of_row(ahead, 31)
        widths.append(last - first)
        depths.append(depth)
        assert (first, last) == pytest.approx((start, end), abs=0.1)
        assert widths[-1] == pytest.approx(end - start, abs=0.15)
        inside = (solid.position[:, 0] > first + 1.6) & (solid.position[:, 0] < last - 1.6)
        assert not inside.any()
    assert depths[-1] - depths[0] > 5.0
    assert widths[0] - widths[-1] == pytest.approx(
        2.0 * (depths[-1] - depths[0]) * outer / 1.3415, abs=0.2
    )


def middle_of_row(cloud: PointCloud, row: int) -> float:
    chosen = (cloud.row == row) & (np.abs(cloud.column - 31.5) < 6.0)
    chosen &= cloud.classification == PointClass.BATHYMETRIC
    assert chosen.sum() > 8
    return float(np.median(cloud.position[chosen, 0]))


def test_wreck_stands_on_its_bed() -> None:
    mission, (cloud,) = flown("wreck", slice(1, 2))
    assert mission.seabed.is_object.any()
    on_wreck = cloud.true_classification == PointClass.SUBMERGED_OBJECT
    height = cloud.truth[:, 2] + 10.0
    called = cloud.classification == PointClass.SUBMERGED_OBJECT
    assert on_wreck.sum() > 60
    assert (called & on_wreck).sum() > 30
    assert called[on_wreck & (height > 2.0)].mean() > 0.6
    beside = np.linalg.norm(cloud.position[:, :2] - [15.0, 100.0], axis=1) > 25.0
    assert not called[beside].any()
    assert np.percentile(np.abs(bottom_errors(cloud.select(beside))), 95.0) < 0.5
    top = cloud.select(called & on_wreck)
    assert np.median(top.position[:, 2]) > -8.5
    assert np.median(np.abs(top.position[:, 2] - top.truth[:, 2])) < 0.6


def test_the_paper_s_mission_ends_where_coastal_water_hides_the_bottom() -> None:
    """P05 by day with a sixteenth of the pixels and of the pulse: over 20 m, and over 40 m."""
    part = {"camera.rows": 8, "camera.columns": 16, "laser.pulse_energy_j": 1.0 / 16.0}
    mission = prepare(load_scenario("paper-p05").replace(**LESS_WORK, **part))
    seen, unseen = (fly_frame(mission, mission.frames[number]).record for number in (4, 9))
    assert np.median(seen.true_depth) == pytest.approx(20.0, abs=0.5)
    assert (seen.outcome == Outcome.FOUND).mean() > 0.97
    assert np.median(seen.detection_probability) > 0.99
    assert np.median(unseen.true_depth) == pytest.approx(40.0, abs=0.5)
    assert (unseen.outcome == Outcome.FOUND).mean() < 0.02
    assert np.median(unseen.detection_probability) < 0.01


def test_rolling_aircraft_puts_points_beside_their_place_to_the_right() -> None:
    mission, clouds = flown("rolling-aircraft", slice(5, 11, 4))
    for cloud in clouds:
        solid = cloud.select(np.isin(cloud.classification, BOTTOM))
        pose = mission.frames[int(cloud.frame[0])].pose
        right = np.array([np.cos(pose.heading), -np.sin(pose.heading)])
        aside = (solid.position - solid.truth)[:, :2] @ right
        assert np.median(aside) == pytest.approx(200.0 * np.radians(0.1), abs=0.12)
        assert np.percentile(np.abs(bottom_errors(cloud)), 95.0) < 0.4
    assert share(clouds[0], PointClass.BATHYMETRIC) > 0.95


def test_area_survey_s_cross_line_agrees_with_the_lines_under_it() -> None:
    mission = prepare(load_scenario("area-survey").replace(**LESS_WORK))
    cross = next(f for f in mission.frames if f.line == 6)
    apart = [np.linalg.norm(f.pose.position - cross.pose.position) for f in mission.frames[:-3]]
    frames = (cross, mission.frames[int(np.argmin(apart))])
    clouds = [fly_frame(mission, frame).bottom for frame in frames]
    for cloud in clouds:
        assert share(cloud, PointClass.BATHYMETRIC) > 0.95
        assert np.percentile(np.abs(bottom_errors(cloud)), 95.0) < 0.5
    biases = [np.median(bottom_errors(cloud)) for cloud in clouds]
    assert biases[0] == pytest.approx(biases[1], abs=0.15)


@pytest.mark.slow
def test_harbor_wreck_shows_sand_and_objects_and_loses_the_seagrass() -> None:
    """Two frames: cubes and free span, then the wreck."""
    mission = prepare(load_scenario("harbor-wreck"))
    results = [fly_frame(mission, frame) for frame in mission.frames[1:3]]
    cloud = PointCloud.concatenate([result.bottom for result in results])
    found = np.concatenate([result.record.outcome.ravel() for result in results]) == Outcome.FOUND
    made_of = {name: cloud.substrate == substrate.code for name, substrate in SUBSTRATES.items()}
    assert found[made_of["sand"]].mean() > 0.9
    assert found[made_of["seagrass"]].mean() < 0.75 * found[made_of["sand"]].mean()
    objects = cloud.true_classification == PointClass.SUBMERGED_OBJECT
    wreck = objects & made_of["steel"]
    pipe_and_cubes = objects & made_of["concrete"]
    assert np.array_equal(objects, wreck | pipe_and_cubes)
    called = cloud.classification == PointClass.SUBMERGED_OBJECT
    assert called[wreck].mean() > 0.5
    cube = pipe_and_cubes & (np.abs(cloud.truth[:, 2] + 2.0) < 0.2)
    assert 3 < cube.sum() < 12
    assert called[cube].mean() > 0.5
    errors = (cloud.position[:, 2] - cloud.true_elevation)[found & made_of["sand"] & ~objects]
    assert np.median(errors) == pytest.approx(0.0, abs=0.1)


def dense_cells(cloud: PointCloud) -> float:
    """Return the share of the 2 x 2 m cells inside a cloud that hold 5 points/m2 of the bottom."""
    solid = cloud.position[np.isin(cloud.classification, BOTTOM), :2]
    low, high = np.ceil(solid.min(axis=0) / 2.0) * 2.0, np.floor(solid.max(axis=0) / 2.0) * 2.0
    edges = [np.arange(low[axis], high[axis] + 1.0, 2.0) for axis in (0, 1)]
    counts, _, _ = np.histogram2d(*solid.T, bins=edges)
    return float((counts >= 5.0 * 2.0 * 2.0).mean())


@pytest.mark.slow
def test_next_generation_is_dense_enough_where_the_paper_s_camera_is_not() -> None:
    """5 points/m2 in 80 % of cells; a 25th of the field and of the light, over a cube of 1 m."""
    middle = {"camera.rows": 32, "camera.columns": 48, "laser.pulse_energy_j": 0.005 / 25.0}
    _, (cloud,) = flown("next-generation", slice(2, 3), **middle, **{"seabed.margin_m": 60.0})
    assert dense_cells(cloud) > 0.9
    assert np.percentile(np.abs(bottom_errors(cloud)), 95.0) < 0.15
    assert abs(np.median(bottom_errors(cloud))) < 0.05
    beside = np.linalg.norm(cloud.truth[:, :2] - [4.0, 20.0], axis=1)
    top = (beside < 0.7) & (cloud.truth[:, 2] > -4.2)
    on_cube = top & (cloud.position[:, 2] > -4.3)
    assert on_cube.sum() >= 3
    assert np.median(cloud.position[on_cube, 2]) == pytest.approx(-4.0, abs=0.15)
    _, (paper,) = flown("sandbar", slice(3, 4), **{"flight.lines": 1})
    assert share(paper, *BOTTOM) > 0.9
    assert dense_cells(paper) == 0.0


@pytest.mark.slow
def test_too_deep_shows_nothing() -> None:
    _, clouds = flown("too-deep", slice(0, 4))
    assert share(PointCloud.concatenate(clouds), *BOTTOM) < 3e-3


@pytest.mark.slow
@pytest.mark.parametrize("known", [False, True])
def test_turbid_layer_is_a_false_floor_or_a_hole_over_the_troughs(known: bool) -> None:
    """At the scenario's own work: with less the layer's echo is within its Monte Carlo error."""
    part = {"camera.rows": 8, "camera.columns": 32, "laser.pulse_energy_j": 1.0 / 8.0}
    part |= {"transport.walks_per_pixel": 128}
    _, clouds = flown("turbid-layer", slice(0, 2), **part, **{"processing.expects_layers": known})
    cloud = stitched(clouds, cell_size=0.5)
    found = np.isin(cloud.classification, BOTTOM)
    crest, trough = cloud.truth[:, 2] > -8.4, cloud.truth[:, 2] < -10.0
    assert min(crest.sum(), trough.sum()) > 60
    assert found[crest].mean() > 0.97
    assert np.abs(np.median(bottom_errors(cloud.select(crest)))) < 0.1
    if known:
        assert found[trough].mean() < 0.02
    else:
        floor = cloud.position[trough & found, 2]
        assert found[trough].mean() > 0.9
        assert np.median(floor) == pytest.approx(-9.0, abs=0.2)

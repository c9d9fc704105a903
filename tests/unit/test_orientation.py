"""Which way is which, from the flight to the points: one sentence a test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from survey.cloud.frame_points import bottom_points, find_water
from survey.cloud.georeference import bend_at_surface, pixel_rays, place_in_air
from survey.cloud.points import PointCloud
from survey.cloud.scattering import Scattering
from survey.cloud.truth import true_targets
from survey.flight.navigation import Mounting, Navigation, NavigationError, navigated
from survey.flight.plan import FlightPlan
from survey.flight.pose import Frame, Pose
from survey.flight.trajectory import fly_lines, footprint
from survey.preparation import prepare
from survey.products.grids import grid_elevation
from survey.products.las_records import Views
from survey.scenario import components
from survey.scenario.scenario import Scenario
from survey.sensor.camera import Camera
from terrain.waves import Swell, WaveField, elevation_and_slopes
from terrain.waves.dispersion import wavenumber

Looks = Callable[..., Any]
FloatArray = NDArray[np.float64]
LONG_SIDES: tuple[Literal["along", "across"], ...] = ("along", "across")
HEADINGS = [(0.0, (0, 1)), (90.0, (1, 0)), (180.0, (0, -1)), (270.0, (-1, 0))]
PLAN = FlightPlan(
    start=(0.0, 0.0),
    heading=0.0,
    height=200.0,
    water_level=0.0,
    speed=100.0,
    flash_rate=1.0,
    frames_per_line=2,
    lines=2,
    swath=50.0,
    sidelap=0.2,
    turn="same",
    turn_time=60.0,
)


def camera(long_side: Literal["along", "across"] = "along") -> Camera:
    return Camera(rows=32, columns=64, pixel_tangent=0.008, long_side=long_side)


def pose(*, roll: float = 0.0, pitch: float = 0.0, heading: float = 0.0) -> Pose:
    """From 200 m, angles in degrees."""
    return Pose(
        position=np.array([0.0, 0.0, 200.0]),
        roll=np.radians(roll),
        pitch=np.radians(pitch),
        heading=np.radians(heading),
    )


def view_centre(at: Pose) -> FloatArray:
    """Where the middle of the camera looks on the water, east and north [m]."""
    rays = pixel_rays(camera=camera(), pose=at)[15:17, 31:33].reshape(-1, 3).mean(axis=0)
    return np.asarray(rays[:2] * 200.0 / -rays[2])


@pytest.mark.parametrize(("heading", "ahead"), HEADINGS)
def test_heading_0_flies_north_and_90_east(heading: float, ahead: tuple[int, int]) -> None:
    first, second = fly_lines(replace(PLAN, heading=np.radians(heading)))[:2]
    way = second.pose.position[:2] - first.pose.position[:2]
    assert way == pytest.approx(100.0 * np.array(ahead), abs=1e-9)
    nose = first.pose.body_to_map() @ [1.0, 0.0, 0.0]
    assert nose == pytest.approx([*ahead, 0.0], abs=1e-12)


@pytest.mark.parametrize(("heading", "ahead"), HEADINGS)
def test_the_next_line_lies_to_the_right(heading: float, ahead: tuple[int, int]) -> None:
    frames = fly_lines(replace(PLAN, heading=np.radians(heading)))
    step = frames[2].pose.position[:2] - frames[0].pose.position[:2]
    assert step == pytest.approx([40.0 * ahead[1], -40.0 * ahead[0]], abs=1e-9)


def test_positive_roll_lowers_the_right_wing_and_looks_to_the_left() -> None:
    rolled = pose(roll=5.0)
    assert (rolled.body_to_map() @ [0.0, 1.0, 0.0])[2] == pytest.approx(-np.sin(np.radians(5.0)))
    east, north = view_centre(rolled)
    assert east == pytest.approx(-200.0 * np.tan(np.radians(5.0)), rel=1e-3)
    assert north == pytest.approx(0.0, abs=1e-6)


def test_positive_pitch_lifts_the_nose_and_looks_ahead() -> None:
    pitched = pose(pitch=5.0)
    assert (pitched.body_to_map() @ [1.0, 0.0, 0.0])[2] == pytest.approx(np.sin(np.radians(5.0)))
    east, north = view_centre(pitched)
    assert north == pytest.approx(200.0 * np.tan(np.radians(5.0)), rel=1e-3)
    assert east == pytest.approx(0.0, abs=1e-6)


def test_more_heading_turns_the_front_of_the_view_to_the_right() -> None:
    before = footprint(camera(), pose(), 0.0)[:2].mean(axis=0)
    after = footprint(camera(), pose(heading=10.0), 0.0)[:2].mean(axis=0)
    assert before == pytest.approx([0.0, 51.2])
    assert after == pytest.approx(51.2 * np.array([np.sin(np.pi / 18), np.cos(np.pi / 18)]))


def test_roll_goes_with_the_aircraft_flying_east_it_looks_north() -> None:
    assert view_centre(pose(roll=5.0, heading=90.0)) == pytest.approx(
        [0.0, 200.0 * np.tan(np.radians(5.0))], abs=0.02
    )


@pytest.mark.parametrize("long_side", LONG_SIDES)
def test_pixel_0_0_looks_forward_left(long_side: Literal["along", "across"]) -> None:
    rays = pixel_rays(camera=camera(long_side), pose=pose())
    corners = [rays[0, 0], rays[0, -1], rays[-1, 0], rays[-1, -1]]
    east_north = [tuple(np.sign(ray[:2])) for ray in corners]
    by_columns = {"along": (-1, -1), "across": (1, 1)}[long_side]
    assert east_north[0] == (-1, 1)
    assert east_north[1] == by_columns
    assert east_north[2] == tuple(-np.array(by_columns))
    assert east_north[3] == (1, -1)


def test_a_bright_rock_ahead_on_the_left_lights_pixel_0_0(
    tables: dict[str, Any], tmp_path: Path
) -> None:
    tables["flight"] |= {"frames_per_line": 1, "heading_deg": 90.0}
    tables["camera"] = {"rows": 4, "columns": 8, "pixel_footprint_m": 8.0}
    tables["transport"] = {"walks_per_pixel": 16, "replicates": 4}
    place = {"easting_m": 500250.0 + 22.4, "northing_m": 6000750.0 + 9.6}
    rock = {"kind": "cube", "side_m": 12.0, "reflectance": 0.9, **place}
    tables["seabed"]["objects"] = [rock]
    mission = prepare(Scenario.from_tables(tables, name="rock.toml", folder=tmp_path))
    flash = mission.engine.flash(pose=mission.frames[0].pose, frame=0)
    light = flash.origin("bottom").sum(axis=-1)
    assert np.unravel_index(light.argmax(), light.shape) == (0, 0)
    assert light[0, 0] > 3.0 * light[2:, 3:].max()


def test_deeper_is_later(look_at: Looks) -> None:
    times = [look_at(depth=depth, gradient=0.0).targets.time for depth in (4.0, 6.0)]
    assert (times[1] > times[0]).all()
    assert (times[1] - times[0]).min() == pytest.approx(2 * 2.0 * 1.36 / 299_792_458.0, rel=1e-3)


def test_depth_counts_down_and_elevation_up(look_at: Looks) -> None:
    look = look_at(depth=6.0, gradient=0.0, level=0.4)
    assert look.targets.position[..., 2] == pytest.approx(-6.0)
    assert look.targets.depth == pytest.approx(6.4)


@pytest.mark.parametrize(("towards", "way"), HEADINGS)
def test_a_slope_falls_towards_its_downhill(
    tables: dict[str, Any], towards: float, way: tuple[int, int]
) -> None:
    tables["seabed"] = {"kind": "slope", "depth_m": 9.0, "slope_deg": 3.0, "downhill_deg": towards}
    bed = components.seabed(Scenario.from_tables(tables, name="bed.toml", folder=Path()))
    places = np.array([300.0, 750.0]) + 20.0 * np.outer([-1.0, 1.0], way)
    uphill, downhill = bed.elevation_at(*places.T)
    assert uphill - downhill == pytest.approx(40.0 * np.tan(np.radians(3.0)))


@pytest.mark.parametrize(("comes_from", "back"), HEADINGS)
def test_waves_run_away_from_where_they_come_from(comes_from: float, back: tuple[int, int]) -> None:
    swell = Swell(height=1.0, period=8.0, comes_from=np.radians(comes_from))
    field = WaveField.realised(wind_sea=None, swell=[swell], chance=np.random.default_rng(1))
    crest_speed = 2.0 * np.pi / 8.0 / wavenumber(8.0)
    run = -crest_speed * np.array(back)
    places = np.random.default_rng(2).uniform(-150.0, 150.0, (400, 2))

    def heights(at: FloatArray, time: float) -> FloatArray:
        box = dict(zip(("west", "east", "south", "north"), (-200.0, 200.0) * 2, strict=True))
        sheet = field.lattice(time=time, level=0.0, **box)
        return np.array([elevation_and_slopes(sheet, x, y)[0] for x, y in at])

    before = heights(places, 0.0)
    assert np.corrcoef(before, heights(places + 2.0 * run, 2.0))[0, 1] > 0.7
    assert np.corrcoef(before, heights(places - 2.0 * run, 2.0))[0, 1] < 0.0


def test_water_bends_the_view_towards_nadir() -> None:
    ray = np.array([0.6, 0.0, -0.8])
    path = bend_at_surface(
        position=np.array([0.0, 0.0, 200.0]), rays=ray, level=0.0, refractive_index=1.34
    )
    assert 0.0 < path.direction[0] < ray[0]
    straight = place_in_air(
        position=np.array([0.0, 0.0, 200.0]), rays=ray, time=path.air_time + np.array(50e-9)
    )
    assert straight[0] > path.entry[0] > 0.0


@pytest.mark.parametrize(("wind_to", "side"), [((-10.0, 0.0), 1), ((10.0, 0.0), -1)])
def test_wind_from_the_right_turns_the_nose_to_the_right(
    wind_to: tuple[float, float], side: int
) -> None:
    for frame in fly_lines(replace(PLAN, wind=wind_to))[:2]:
        crab = (frame.pose.heading + np.pi) % (2.0 * np.pi) - np.pi
        assert crab == pytest.approx(side * np.arctan(0.1))
        assert frame.pose.position[0] == 0.0


def georeferenced(look: Any, navigation: Navigation) -> PointCloud:
    """The points of a look whose echoes come from the true seabed, by what navigation says."""
    chances = [np.random.default_rng(i) for i in range(6)]
    (frame,) = navigated([look.frame], navigation, chances)
    true_rays = pixel_rays(camera=camera(), pose=frame.pose)
    targets = true_targets(
        seabed=look.seabed,
        surface=look.surface,
        water=look.water,
        pose=frame.pose,
        rays=true_rays,
    )
    at_surface = 2.0 * np.linalg.norm(targets.surface - frame.pose.position, axis=-1) / 299_792_458
    rays = pixel_rays(camera=camera(), pose=frame.measured)
    first, bottom = look.echo(at_surface), look.echo(targets.time)
    line = find_water(
        first=first,
        frame=frame,
        rays=rays,
        expected_level=look.surface.level,
        refractive_index=look.water.refractive_index,
    )
    return bottom_points(
        line=line,
        first=first,
        bottom=bottom,
        frame=frame,
        rays=rays,
        camera=camera(),
        targets=targets,
        seabed=look.seabed,
        group_index=look.water.group_index,
        scattering=Scattering.none(),
        calibration=look.calibration,
    )


def offset(look: Any, navigation: Navigation) -> FloatArray:
    """Mean of measured less true place, east, north, up [m]."""
    cloud = georeferenced(look, navigation)
    return np.asarray((cloud.position - cloud.truth).mean(axis=0))


def test_points_go_where_navigation_says_the_aircraft_is(look_at: Looks) -> None:
    look = look_at(heading_deg=70.0)
    assert offset(look, Navigation()) == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    wrong = Navigation(
        east=NavigationError(bias=0.5),
        north=NavigationError(bias=-0.2),
        up=NavigationError(bias=0.1),
    )
    assert offset(look, wrong) == pytest.approx([0.5, -0.2, 0.1], abs=1e-9)


def test_roll_that_is_told_too_large_puts_points_too_far_left(look_at: Looks) -> None:
    look = look_at(heading_deg=0.0, gradient=0.0)
    east, north, _ = offset(look, Navigation(roll=NavigationError(bias=np.radians(0.1))))
    assert east == pytest.approx(-200.0 * np.radians(0.1), rel=0.1)
    assert north == pytest.approx(0.0, abs=0.01)


def test_pitch_that_is_told_too_large_puts_points_too_far_ahead(look_at: Looks) -> None:
    look = look_at(heading_deg=0.0, gradient=0.0)
    east, north, _ = offset(look, Navigation(pitch=NavigationError(bias=np.radians(0.1))))
    assert north == pytest.approx(200.0 * np.radians(0.1), rel=0.15)
    assert east == pytest.approx(0.0, abs=0.01)


def test_a_boresight_that_nobody_knows_of_acts_as_the_opposite_of_a_false_roll(
    look_at: Looks,
) -> None:
    look = look_at(heading_deg=0.0, gradient=0.0)
    unknown = Navigation(mounting=Mounting(roll=np.radians(0.1)))
    assert offset(look, unknown)[0] == pytest.approx(200.0 * np.radians(0.1), rel=0.1)
    known = replace(unknown, believed_mounting=unknown.mounting)
    assert offset(look, known) == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def test_a_lever_arm_leads_forward_right_and_down_from_what_navigation_tells() -> None:
    arm = Mounting(lever_arm=(3.0, 2.0, 1.0))
    east = arm.sensor_pose(pose(heading=90.0))
    assert east.position == pytest.approx([3.0, -2.0, 199.0])
    assert (east.roll, east.pitch, east.heading) == pytest.approx((0.0, 0.0, np.pi / 2))
    banked = arm.sensor_pose(pose(roll=90.0))
    assert banked.position == pytest.approx([-1.0, 3.0, 198.0])


def test_the_scan_angle_of_las_is_positive_to_the_right(look_at: Looks) -> None:
    look = look_at(heading_deg=120.0, gradient=0.0)
    cloud = georeferenced(look, Navigation())
    frame: Frame = look.frame
    angle = Views.of([frame]).scan_angle_deg(cloud)
    assert (angle[cloud.row < 16] < 0.0).all()
    assert (angle[cloud.row >= 16] > 0.0).all()


def gridded(small_survey: Any) -> tuple[FloatArray, Any]:
    """The places of two points on the map, the second 60 m east and 30 m north, and their grid."""
    two = small_survey.bottom.select(np.arange(2))
    place = np.array([[0.0, 0.0, -3.0], [60.0, 30.0, -5.0]])
    two = replace(two, position=place, classification=np.full(2, 40, dtype=np.uint8))
    return place, grid_elevation(two, small_survey.map_frame, cell_size=10.0)


def test_the_first_row_of_a_raster_is_the_northernmost(small_survey: Any) -> None:
    place, grid = gridded(small_survey)
    assert np.nanmin(grid.elevation[0]) == place[1, 2]
    assert np.nanmin(grid.elevation[-1]) == place[0, 2]


def test_the_first_column_of_a_raster_is_the_westernmost(small_survey: Any) -> None:
    place, grid = gridded(small_survey)
    assert np.nanmin(grid.elevation[:, 0]) == place[0, 2]
    assert np.nanmin(grid.elevation[:, -1]) == place[1, 2]

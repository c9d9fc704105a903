"""The scenarios that come with the package are sound and show what they promise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from survey.flight.trajectory import fly_lines, footprint
from survey.optics.water import PAPER_COEFFICIENTS
from survey.planning.plan import make_plan
from survey.scenario import Scenario, ScenarioError, components, load_scenario
from survey.scenario.gallery import gallery
from survey.scenario.load import parse_overrides

ROOT = Path(__file__).parents[2]
PAPER = {"paper-p02": "clear", "paper-p05": "coastal", "paper-p07": "harbor"}


def outlines_on_map(scenario: Scenario) -> list[NDArray[np.float64]]:
    """Return the footprints (4, 2) at the water surface, line by line."""
    frame = components.map_frame(scenario)
    camera, level = components.camera(scenario), scenario.surface.water_level_m
    flashes = fly_lines(components.flight_plan(scenario))
    return [footprint(camera, flash.pose, level) + frame.origin[:2] for flash in flashes]


def sampled(scenario: Scenario, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the raster's elevation at places of the map (n, 2) [m]; nan outside."""
    import rasterio

    with rasterio.open(scenario.folder / getattr(scenario.seabed, "file")) as raster:  # noqa: B009
        return np.array([v[0] for v in raster.sample(places, masked=True)], dtype=float)


@pytest.mark.parametrize("name", sorted(gallery()))
def test_every_scenario_is_sound_and_says_what_to_expect(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.mission.title
    assert scenario.mission.description
    assert scenario.mission.expect
    assert scenario.receiver.source == scenario.detector.source == "assumed"


def test_the_gallery_is_complete() -> None:
    names = {"measured-seabed", "sandbar", "wreck", "turned-footprint", "too-deep"}
    names |= {"rolling-aircraft", "area-survey", "harbor-wreck", "reef-with-swell"}
    names |= {"turbid-layer", "next-generation", "special-order", "boresight", "every-effect"}
    assert names | PAPER.keys() <= gallery().keys()


def test_measured_seabed_is_flown_over_valid_cells_with_a_margin() -> None:
    scenario = load_scenario("measured-seabed")
    for outline in outlines_on_map(scenario):
        centre = outline.mean(axis=0)
        grown = centre + (outline - centre) * (1.0 + 20.0 / np.abs(outline - centre).max())
        sides = zip(grown, np.roll(grown, -1, axis=0), strict=True)
        rim = np.concatenate([np.linspace(a, b, 20) for a, b in sides])
        assert (sampled(scenario, rim) > -100.0).all()


def test_measured_seabed_runs_from_the_beach_to_9_m() -> None:
    scenario = load_scenario("measured-seabed")
    plan = components.flight_plan(scenario)
    assert plan.lines >= 4
    assert plan.frame_count >= 32
    outlines = np.array(outlines_on_map(scenario)).reshape(plan.lines, plan.frames_per_line, 4, 2)
    for number, line in enumerate(outlines):
        outward = line if number % 2 == 0 else line[::-1]
        depths = -sampled(scenario, outward.reshape(-1, 2)).reshape(-1, 4)
        assert depths[0].min() < -2.0
        assert depths[0].max() > 0.0
        assert depths[-1].max() == pytest.approx(9.0, abs=0.3)


def test_measured_seabed_gate_holds_land_and_depth() -> None:
    scenario = load_scenario("measured-seabed")
    receiver, plan = components.receiver(scenario), components.flight_plan(scenario)
    c = 299_792_458.0
    assert receiver.gate_start < 2.0 * (plan.height - 7.0) / c - 10e-9
    gate_end = receiver.gate_start + receiver.bins * receiver.bin_width
    corner = 2.0 * plan.height * np.hypot(1.0, np.hypot(0.256, 0.128)) / c
    assert gate_end > corner + 2.0 * 10.0 * 1.36 / c * 1.03 + 30e-9


def test_turned_footprint_leaves_gaps_of_49_m() -> None:
    first, second = outlines_on_map(load_scenario("turned-footprint"))[:2]
    assert second[:, 0].min() - first[:, 0].max() == pytest.approx(48.8)


def test_area_survey_covers_its_polygon_with_six_lines_and_a_cross_line() -> None:
    scenario = load_scenario("area-survey")
    frames = components.frames(scenario)
    headings = {frame.line: frame.pose.heading for frame in frames}
    turned = np.degrees(list(headings.values())) - 65.0
    assert np.cos(np.radians(turned)) == pytest.approx([1, -1, 1, -1, 1, -1, 0], abs=0.1)
    ring, origin = components.survey_area(scenario), components.map_frame(scenario).origin[:2]
    assert ring is not None
    cells = np.mgrid[0:800:5, 0:600:5].reshape(2, -1).T + ring.min(axis=0) + origin
    wanted = contains(ring + origin, cells)
    views = [footprint(components.camera(scenario), frame.pose, 0.0) + origin for frame in frames]
    seen = np.any([contains(view, cells) for view in views], axis=0)
    assert wanted.sum() * 25.0 == pytest.approx(1.4e5, rel=0.1)
    assert seen[wanted].mean() > 0.99


def contains(ring: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which places (n, 2) lie in a ring (corners, 2)."""
    from matplotlib.path import Path as Ring

    return np.asarray(Ring(ring).contains_points(places))


def test_rolling_aircraft_rolls_as_far_as_it_says_and_points_into_the_wind() -> None:
    scenario = load_scenario("rolling-aircraft")
    frames = components.frames(scenario)
    roll = np.degrees([frame.measured.roll for frame in frames])
    assert 0.7 < roll.std() < 3.0
    crab = np.degrees([frame.pose.heading for frame in frames]) - np.repeat([90.0, 270.0], 8)
    assert crab.reshape(2, 8).mean(axis=1) == pytest.approx([-6.8, 6.8], abs=0.8)
    error = np.degrees([frame.measured.roll - frame.pose.roll for frame in frames])
    assert error.mean() == pytest.approx(-0.1, abs=0.01)


def test_wreck_lies_under_the_flight() -> None:
    scenario = load_scenario("wreck")
    wreck = scenario.seabed.objects[0]
    place = np.array([wreck.easting_m, wreck.northing_m])
    seen = np.array(outlines_on_map(scenario)).reshape(-1, 2)
    assert (seen.min(axis=0) < place - 20.0).all()
    assert (seen.max(axis=0) > place + 20.0).all()


def test_harbor_wreck_s_line_sees_all_that_its_basin_is_made_of() -> None:
    scenario = load_scenario("harbor-wreck")
    seabed = components.seabed(scenario)
    outline = np.concatenate(outlines_on_map(scenario)) - seabed.map_frame.origin[:2]
    centre = seabed.mesh.triangles_center[:, :2]
    seen = ((centre > outline.min(axis=0)) & (centre < outline.max(axis=0))).all(axis=1)
    area = {
        name: float(seabed.mesh.area_faces[seen & (seabed.substrate == code)].sum())
        for code, name in seabed.substrate_names.items()
    }
    assert set(area) == {"sand", "seagrass", "rock", "steel", "concrete"}
    assert area["sand"] > 2500.0
    assert area["seagrass"] > 500.0
    assert area["rock"] > 400.0
    cubes = [part for part in scenario.seabed.objects if part.kind == "cube"]
    tops = [
        float(seabed.elevation_at(*(np.array([c.easting_m, c.northing_m]) - [5e5, 6e6])))
        for c in cubes
    ]
    assert tops == pytest.approx([-4.0 + cube.side_m for cube in cubes], abs=0.3)


def test_turbid_layer_has_its_troughs_in_the_layer_and_its_crests_above_it() -> None:
    scenario = load_scenario("turbid-layer")
    corners = np.concatenate(outlines_on_map(scenario)) - components.map_frame(scenario).origin[:2]
    east, north = np.meshgrid(*np.linspace(corners.min(axis=0), corners.max(axis=0), 100).T)
    bed = components.seabed(scenario).elevation_at(east.ravel(), north.ravel())
    assert (bed.min(), bed.max()) == pytest.approx((-10.25, -7.75), abs=0.05)
    _, layer = components.water(scenario).layers
    assert layer.top == 8.5
    assert 0.6 < (bed < -layer.top).mean() < 0.7
    assert components.expected_water(scenario).is_uniform


def test_next_generation_is_safe_to_look_up_at_and_denser_than_the_paper_s_camera() -> None:
    """The Norwegian specification for airborne lidar bathymetry 2025.1 asks for 5 points/m2."""
    scenario = load_scenario("next-generation")
    plan = make_plan(scenario)
    assert plan.eye.binocular_distance < 0.5 * plan.height
    assert plan.frame_density > 10.0
    assert plan.density > 25.0
    assert plan.expectation.run_day.depth > plan.depth[2]
    assert not plan.bottom.swath.gaps
    paper = make_plan(load_scenario("paper-p02").replace(**{"flight.frames_per_line": 2}))
    assert paper.density < 0.5
    assert scenario.laser.pulse_width_ns < 0.2 * load_scenario("paper-p02").laser.pulse_width_ns


@pytest.mark.parametrize(("name", "water"), PAPER.items())
def test_the_paper_s_mission_by_day_and_night_down_a_slope_and_flat(name: str, water: str) -> None:
    by_day = load_scenario(name)
    assert "impossible as hardware" in by_day.mission.description
    assert components.camera(by_day).half_tangents == (0.256, 0.128)
    medium = components.water(by_day).surface
    assert (medium.absorption, medium.scattering) == PAPER_COEFFICIENTS[water]
    assert components.background_radiance(by_day) == pytest.approx(51.8e6, rel=1e-3)
    by_night = by_day.replace(**parse_overrides(["sun.day=false"]))
    assert components.background_radiance(by_night) == pytest.approx(1e3)
    flat = parse_overrides(['seabed={kind="plane", depth_m=50, reflectance=0.1}'])
    assert flat["seabed"]["kind"] in by_day.mission.expect
    for scenario in (by_day, by_night.replace(**flat)):
        assert gate_end(scenario) > corner_echo(scenario, deepest(scenario)) + 10e-9


def deepest(scenario: Scenario) -> float:
    """Return the greatest depth that the frames see straight below their edges [m]."""
    corners = np.concatenate(outlines_on_map(scenario)) - components.map_frame(scenario).origin[:2]
    return float(-components.seabed(scenario).elevation_at(corners[:, 0], corners[:, 1]).min())


def gate_end(scenario: Scenario) -> float:
    receiver = components.receiver(scenario)
    return receiver.gate_start + receiver.bins * receiver.bin_width


def corner_echo(scenario: Scenario, depth: float) -> float:
    """Return the two-way time to a bottom that deep, seen by a corner pixel [s]."""
    slant = np.arctan(np.hypot(0.256, 0.128))
    refracted = np.arcsin(np.sin(slant) / 1.33)
    way = scenario.flight.height_m / np.cos(slant) + 1.33 * depth / np.cos(refracted)
    return float(2.0 * way / 299_792_458.0)


def test_the_readme_s_scenario_only_lacks_its_raster(tmp_path: Path) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    file = tmp_path / "reef.toml"
    file.write_text(readme.split("```toml\n")[1].split("```")[0], encoding="utf-8")
    with pytest.raises(ScenarioError) as caught:
        load_scenario(file)
    assert [fault.place for fault in caught.value.faults] == ["seabed.file"]
    assert caught.value.only_missing_files

"""Plans of the paper's mission and of others, by their numbers."""

from __future__ import annotations

from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.planning.plan import SurveyPlan, make_plan
from survey.planning.report import as_json, as_text
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario

PAPER = {
    "mission": {"title": "The paper's mission"},
    "flight": {
        "start_easting_m": 500250.0,
        "start_northing_m": 6000750.0,
        "heading_deg": 90.0,
        "frames_per_line": 4,
    },
    "receiver": {"aperture_radius_m": 0.005, "filter_width_nm": 1.0, "bins": 700},
    "detector": {"quantum_efficiency": 0.2, "dark_count_rate_hz": 1.0e4},
    "water": {"type": "clear", "refractive_index": 1.33, "group_index": 1.33},
    "surface": {"water_level_m": 0.0},
    "seabed": {"kind": "plane", "depth_m": 50.0},
}
"""200 m, 100 m/s, 1 Hz, 64 x 32 pixels over 50 m of water; the receiver is ours."""


def scenario(**changes: Any) -> Scenario:
    paper = Scenario.from_tables(deepcopy(PAPER), name="paper.toml", folder=Path())
    return paper.replace(**{key.replace("__", "."): value for key, value in changes.items()})


@cache
def plan(**changes: Any) -> SurveyPlan:
    return make_plan(scenario(**changes))


def found(**changes: Any) -> dict[str, Any]:
    return as_json(plan(**changes))


def test_overlaps_of_the_papers_mission() -> None:
    overlap = found()["overlap"]
    assert overlap["surface"]["forward_m"] == pytest.approx(2.4, abs=0.01)
    assert overlap["bottom"]["depth_m"] == pytest.approx(50.0)
    assert overlap["bottom"]["forward_percent"] == pytest.approx(17.6, abs=0.1)
    assert overlap["bottom_in_air"]["forward_percent"] == pytest.approx(21.9, abs=0.1)
    assert {gaps["count"] for gaps in found()["gaps"].values()} == {0}
    assert (found()["frames"], found()["flight_time_s"]) == (4, 3.0)


def test_gaps_of_the_papers_mission_with_the_footprint_turned() -> None:
    gaps = found(camera__long_side="across")["gaps"]
    assert gaps["surface"]["forward_m"] == pytest.approx(48.8, abs=0.01)
    assert gaps["bottom"]["forward_m"] == pytest.approx(39.3, abs=0.1)
    assert gaps["bottom_in_air"]["forward_m"] == pytest.approx(36.0, abs=0.01)
    assert gaps["surface"]["count"] == 3
    assert gaps["surface"]["area_m2"] == pytest.approx(3 * 48.8 * 102.4, rel=0.005)


def test_polygons_of_gaps_lie_on_the_map() -> None:
    gaps = found(camera__long_side="across")["gaps"]["surface"]["polygons"]
    rings = [np.array(gap["coordinates"][0]) for gap in gaps]
    for ring in rings:
        assert np.ptp(ring, axis=0) == pytest.approx([48.8, 102.4], abs=0.3)
    middles = sorted((0.5 * (ring.min(axis=0) + ring.max(axis=0))).tolist() for ring in rings)
    expected = [[500250.0 + 100.0 * step + 50.0, 6000750.0] for step in range(3)]
    assert np.array(middles) == pytest.approx(np.array(expected), abs=0.3)


def test_overlaps_do_not_depend_on_the_heading() -> None:
    turned = found(flight__heading_deg=37.0, flight__lines=2)
    straight = found(flight__lines=2)
    for ground in ("surface", "bottom"):
        for key in ("forward_m", "side_m"):
            mine, other = turned["overlap"][ground][key], straight["overlap"][ground][key]
            assert mine == pytest.approx(other, abs=0.01)
    assert straight["overlap"]["surface"]["side_m"] == pytest.approx(10.24, abs=0.01)
    assert straight["overlap"]["surface"]["side_percent"] == pytest.approx(20.0, abs=0.01)
    assert straight["flight_time_s"] == pytest.approx(66.0)


def test_a_rolling_aircraft_leaves_gaps_between_lines() -> None:
    still = load_scenario("sandbar")
    swing = [{"rms_deg": 5.0, "period_s": 7.0}]
    rolled = as_json(make_plan(still.replace(**{"motion": {"roll": swing}})))
    assert rolled["overlap"]["surface"]["side_least_m"] < 0.0
    assert rolled["gaps"]["surface"]["count"] > 0
    assert any("between lines" in line for line in rolled["warnings"])


def test_density_is_that_of_pixels_on_the_seabed() -> None:
    outline = plan().bottom.views.outline[0]
    length, width = np.ptp(outline[:, :2], axis=0)
    assert (length, width) == pytest.approx((121.4, 60.7), abs=0.1)
    assert found()["density_of_a_frame_per_m2"] == pytest.approx(0.278, abs=0.001)
    flown = 300.0 + length
    assert found()["density_per_m2"] == pytest.approx(4 * 2048 / (flown * width), rel=0.01)


def test_night_sees_deeper_and_turbid_water_less_deep() -> None:
    limits = {water: found(water__type=water)["depth_limit_m"] for water in ("clear", "coastal")}
    for limit in limits.values():
        assert 0.0 < limit["day"] <= limit["night"] < limit["gate"]
        assert limit["run_day"] <= limit["day"]
        assert limit["run_night"] <= limit["night"]
    assert limits["clear"]["night"] > limits["clear"]["day"] + 1.0
    assert limits["clear"]["day"] > limits["coastal"]["day"] + 5.0


def test_a_scenario_by_night_has_the_same_limits() -> None:
    limits, by_night = (found(**sun)["depth_limit_m"] for sun in ({}, {"sun__day": False}))
    assert by_night == limits


def test_a_seabed_deeper_than_sight_or_gate_is_warned_of() -> None:
    assert any("is all but deeper than the limit by day" in line for line in found()["warnings"])
    short = found(receiver__bins=300)
    assert any("take more bins" in line for line in short["warnings"])
    assert "the gate ends there" in as_text(plan(receiver__bins=300))


def test_another_water_is_marked_as_an_estimate() -> None:
    traced = found(water__type="coastal")
    other = found(water__type="coastal", water__absorption_per_m=0.2)
    assert (traced["depth_limit_is_estimate"], other["depth_limit_is_estimate"]) == (False, True)
    assert "estimate from K_d" in other["depth_limit_basis"]
    assert 0.8 < other["depth_limit_m"]["day"] / traced["depth_limit_m"]["day"] < 1.0


def test_laser_hazard_of_the_papers_flood() -> None:
    hazard = found()["laser_hazard"]
    assert hazard["nohd_m"] == pytest.approx(63.0, abs=0.1)
    assert hazard["is_safe_at_water"]
    assert not hazard["is_safe_at_water_through_binoculars"]
    assert "IEC 60825-1:2014" in hazard["source"]
    low = found(flight__height_m=50.0)
    assert any("hazard to eyes at the water" in line for line in low["warnings"])


def test_size_and_time_grow_with_the_work() -> None:
    one, more = found(), found(flight__lines=2)
    assert more["output_mb"] == pytest.approx(2.0 * one["output_mb"], rel=0.1)
    assert more["run_time_s"] > one["run_time_s"]
    walks = found(transport__walks_per_pixel=640)
    assert walks["run_time_s"] > 4.0 * one["run_time_s"]
    assert walks["depth_limit_m"]["run_day"] > one["depth_limit_m"]["run_day"]


def test_land_has_no_depth() -> None:
    dry = found(seabed__depth_m=-3.0)
    assert dry["seabed_depth_m"]["median"] is None
    assert dry["overlap"]["bottom"]["forward_m"] < dry["overlap"]["surface"]["forward_m"]
    assert "dry" in as_text(plan(seabed__depth_m=-3.0))


def test_a_flight_off_its_seabed_is_warned_of() -> None:
    aside = load_scenario("measured-seabed").replace(**{"flight.start_easting_m": 902600.0})
    (fault,) = (line for line in as_json(make_plan(aside))["warnings"] if "refuse" in line)
    assert "outside the seabed" in fault


def test_a_sea_of_waves_is_said_to_be_taken_as_level() -> None:
    swell = [{"height_m": 1.0, "period_s": 8.0, "from_deg": 290.0}]
    rough = make_plan(scenario(surface__swell=swell))
    assert as_json(rough)["wave_height_left_out_m"] == pytest.approx(1.0)
    assert "taken as level: waves of 1.0 m (significant)" in as_text(rough)
    assert found()["wave_height_left_out_m"] == 0.0
    assert "taken as level" not in as_text(plan())

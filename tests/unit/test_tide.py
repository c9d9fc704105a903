"""The tide: every flash meets the sea at its own level, and the survey expects one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import PointClass
from survey.mission import fly_frame
from survey.preparation import prepare
from survey.products.frame_file import FrameResult
from survey.scenario import Scenario, ScenarioError, components

HOUR = 3600.0
TIDE = {"amplitude_m": 1.0, "period_h": 12.0, "high_water_h": 0.0}


@pytest.fixture
def make(tables: dict[str, Any], tmp_path: Path) -> Any:
    """Return the maker of scenarios over a slope with another sea, and other values."""

    def made(tide: dict[str, Any] | None = None, **changes: Any) -> Scenario:
        tables["camera"] = {"rows": 8, "columns": 16}
        tables["transport"] = {"walks_per_pixel": 32}
        tables["seabed"] = {"kind": "slope", "depth_m": 4.0, "slope_deg": 3.0, "downhill_deg": 90.0}
        tables["surface"] = {"water_level_m": 0.5} | ({"tide": tide} if tide else {})
        made = Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)
        return made.replace(**changes)

    return made


def test_the_sea_rises_and_falls_about_its_mean_level(make: Any) -> None:
    sea = components.sea_surface(make(TIDE))
    levels = [sea.at(hour * HOUR).level for hour in (0.0, 3.0, 6.0, 8.0, 12.0)]
    assert levels == pytest.approx([1.5, 0.5, -0.5, 0.0, 1.5])
    assert (sea.level, sea.lowest_level) == (0.5, -0.5)
    still = components.sea_surface(make())
    assert still.at(6.0 * HOUR) is still
    assert still.lowest_level == 0.5
    later = components.sea_surface(make(TIDE | {"high_water_h": 3.0}))
    assert later.at(0.0).level == pytest.approx(0.5)


def first_frame(scenario: Scenario) -> FrameResult:
    mission = prepare(scenario)
    return fly_frame(mission, mission.frames[0])


def test_high_water_is_a_sea_that_stands_higher(make: Any) -> None:
    """The same aircraft over the same bed: 200 m above mean level, 199 m above the higher one."""
    tidal = first_frame(make(TIDE))
    higher = first_frame(make(**{"surface.water_level_m": 1.5, "flight.height_m": 199.0}))
    for name in ("true_position", "true_depth"):
        assert getattr(tidal.record, name) == pytest.approx(getattr(higher.record, name), abs=1e-9)
    assert np.median(tidal.surface.truth[:, 2]) == pytest.approx(1.5)
    assert np.median(tidal.surface.position[:, 2]) == pytest.approx(1.5, abs=0.05)
    found = tidal.bottom.classification == PointClass.BATHYMETRIC
    assert found.mean() > 0.9
    apart = np.abs(tidal.bottom.depth - higher.bottom.depth)[found]
    assert np.median(apart) < 0.05  # gates differ, and with them the light paths that are drawn
    error = (tidal.bottom.position[:, 2] - tidal.bottom.true_elevation)[found]
    assert abs(np.median(error)) < 0.1


def test_the_survey_measures_the_level_where_it_expects_a_wrong_one(make: Any) -> None:
    scenario = make(TIDE, **{"processing.water_level_error_m": 0.4})
    mission = prepare(scenario)
    assert mission.expected_level(0.0) == pytest.approx(1.9)
    assert mission.expected_level(6.0 * HOUR) == pytest.approx(-0.1)
    assert mission.sea.at(6.0 * HOUR).level == pytest.approx(-0.5)
    found = fly_frame(mission, mission.frames[0])
    solid = found.bottom.classification == PointClass.BATHYMETRIC
    error = (found.bottom.position[:, 2] - found.bottom.true_elevation)[solid]
    assert abs(np.median(error)) < 0.1


def test_thresholds_are_those_of_the_expected_level(make: Any) -> None:
    """Light from a level that lies 1 m lower comes 6.7 ns later."""
    mission = prepare(make(TIDE))
    pose = mission.frames[0].measured
    high, low = (
        mission.noise_at(pose, time=hour * HOUR).bottomless_light[4, 8] for hour in (0.0, 6.0)
    )
    steady = mission.noise.steady_light
    times = mission.noise.bin_start + np.arange(len(high)) * mission.noise.bin_width
    surface = [
        float(np.sum(times[:40] * (light - steady)[:40]) / np.sum((light - steady)[:40]))
        for light in (high, low)
    ]
    assert surface[1] - surface[0] == pytest.approx(4.0 / 2.998e8, rel=0.15)


def test_the_gate_holds_low_and_high_water(make: Any) -> None:
    with pytest.raises(ScenarioError) as caught:
        make(TIDE | {"amplitude_m": 6.0})
    (line,) = caught.value.lines
    assert line.startswith("reef.toml: receiver.gate_start_ns: 1304.26 is after the water surface")


def test_every_fault_of_a_tide_has_its_line(make: Any) -> None:
    with pytest.raises(ScenarioError) as caught:
        make({"amplitude_m": 0.0, "period_h": 0.1, "high_water": 3.0})
    assert [line.removeprefix("reef.toml: surface.tide.") for line in caught.value.lines] == [
        "amplitude_m: 0.0 is out of bounds. It must be greater than 0.",
        "period_h: 0.1 is out of bounds. It must be at least 1.",
        "high_water: unknown key. Did you mean 'high_water_h'?",
    ]

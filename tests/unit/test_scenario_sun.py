"""The sun of a scenario: which words change the background, and which do not go together."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from survey.scenario import components
from survey.scenario.faults import ScenarioError
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario
from survey.scenario.sun import sun_notes


@pytest.fixture
def scenario(tables: dict[str, Any]) -> Scenario:
    return Scenario.from_tables(tables, name="reef.toml", folder=Path())


def radiance(scenario: Scenario, changes: dict[str, Any]) -> float:
    """W/(m2 um sr)."""
    return components.background_radiance(scenario.replace(**changes)) * 1e-6


def test_the_default_is_the_paper_s_day(scenario: Scenario) -> None:
    assert radiance(scenario, {}) == pytest.approx(51.789461627, rel=1e-9)


def test_the_models(scenario: Scenario) -> None:
    """200 m of air of 3e-5 1/m take 0.6 % and add haze; without air T_down alone is left."""
    layered = {"sun.model": "layered"}
    clear = radiance(scenario, layered | {"sun.air_extinction_per_m": 0.0})
    assert clear == pytest.approx(50.94, abs=0.01)
    assert radiance(scenario, layered) == pytest.approx(51.31, abs=0.01)
    stated = radiance(scenario, layered | {"sun.air_extinction_per_m": 3e-5})
    assert stated == pytest.approx(radiance(scenario, layered), rel=1e-12)
    above = {"flight.height_m": 15_000.0, "receiver.bins": 5000}
    assert radiance(scenario, above | layered) == pytest.approx(72.44, abs=0.01)
    high = above | {"sun.model": "high_flight"}
    assert radiance(scenario, high) == pytest.approx(86.49, abs=0.01)


def test_glint_by_slopes_knows_wind_sun_and_water(scenario: Scenario) -> None:
    upwind = {"sun.glint": "cox_munk", "sun.azimuth_deg": 30, "surface.wind_from_deg": 30}
    glint = components.sky(scenario.replace(**upwind)).glint
    assert glint is not None
    assert glint.sun_azimuth == pytest.approx(math.pi / 6)
    assert radiance(scenario, upwind) == pytest.approx(45.7, abs=0.1)
    across = upwind | {"surface.wind_from_deg": 120}
    assert radiance(scenario, across) == pytest.approx(38.3, abs=0.1)
    other_water = upwind | {"water.refractive_index": 1.33}
    assert radiance(scenario, other_water) == pytest.approx(43.6, abs=0.1)


def test_the_filter_sees_the_spectrum(scenario: Scenario) -> None:
    """Over 10 nm 1.891 instead of 1.95 W/(m2 nm)."""
    wide = radiance(scenario, {"sun.spectrum": "astm_g173", "receiver.filter_width_nm": 10.0})
    assert wide / radiance(scenario, {}) == pytest.approx(1.891 / 1.95, rel=2e-4)
    other = scenario.replace(**{"sun.spectrum": "astm_g173", "laser.wavelength_nm": 517.0})
    assert components.sky(other).solar_irradiance < 1.75e9  # the sun's magnesium lines


def test_the_water_s_light(scenario: Scenario) -> None:
    by_type = [
        components.sky(
            scenario.replace(**{"sun.water_light": "by_water_type", "water.type": water})
        ).water_reflectance
        for water in ("clear", "coastal", "harbor")
    ]
    assert by_type == [0.0097, 0.0109, 0.0121]
    stated = scenario.replace(**{"sun.water_reflectance": 0.03})
    assert components.sky(stated).water_reflectance == 0.03


def test_a_stated_radiance_comes_before_every_model(scenario: Scenario) -> None:
    """And the rules of sun glint do not hinder it, nor a night."""
    still = {"sun.glint": "cox_munk", "surface.wind_speed_m_s": 0.0}
    assert radiance(scenario, still | {"sun.radiance_w_m2_um_sr": 50.0}) == pytest.approx(50.0)
    assert radiance(scenario, still | {"sun.day": False}) == pytest.approx(1e-3)


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"sun.model": "layered"},
        {"sun.model": "layered", "flight.height_m": 12_000.0, "receiver.bins": 5000},
        {"sun.spectrum": "astm_g173", "sun.glint": "cox_munk", "sun.water_light": "by_water_type"},
    ],
)
def test_resolved_text_says_every_number_once(
    scenario: Scenario, tmp_path: Path, keys: dict[str, Any]
) -> None:
    flown = scenario.replace(**keys)
    (tmp_path / "again.toml").write_text(flown.to_toml(), encoding="utf-8")
    again = load_scenario(tmp_path / "again.toml")
    assert again.to_toml() == flown.to_toml()
    assert components.sky(again) == components.sky(flown)
    if not keys:
        assert again.sun.solar_irradiance_w_m2_nm == 1.95
        assert again.sun.water_reflectance == 0.0097


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        (
            {"sun.glint": "coxmunk"},
            "sun.glint: 'coxmunk' is not one of paper, cox_munk. Did you mean 'cox_munk'?",
        ),
        ({"sun.glitter": "paper"}, "sun.glitter: unknown key. Did you mean 'glint'?"),
        (
            {"sun.radiance_w_m2_um_sr": -1.0},
            "sun.radiance_w_m2_um_sr: -1.0 is out of bounds. It must be at least 0.",
        ),
        (
            {"sun.spectrum": "astm_g173", "sun.solar_irradiance_w_m2_nm": 1.9},
            'sun.solar_irradiance_w_m2_nm: sun.spectrum = "astm_g173" already says it. '
            "Leave one of them out.",
        ),
        (
            {"sun.water_light": "by_water_type", "sun.water_reflectance": 0.01},
            'sun.water_reflectance: sun.water_light = "by_water_type" already says it. '
            "Leave one of them out.",
        ),
        (
            {"sun.air_extinction_per_m": 1e-4},
            'sun.air_extinction_per_m: sun.model = "low_flight" has no use for it. '
            'Take "layered" or leave it out.',
        ),
        (
            {"sun.air_extinction_per_m": 2e-3, "sun.model": "layered"},
            "sun.air_extinction_per_m: over 200 m it makes an optical thickness of 0.4, more "
            "than sun.optical_thickness 0.3 of all the air. Lower it.",
        ),
        (
            {"sun.model": "high_flight"},
            'sun.model: "high_flight" holds from 10000 m up, flight.height_m is 200. '
            'Take "low_flight" or "layered".',
        ),
        (
            {"sun.glint": "cox_munk", "surface.wind_speed_m_s": 0.5},
            "surface.wind_speed_m_s: 0.5 is outside 1 to 14 m/s, in which "
            'sun.glint = "cox_munk" was measured. Change it or take sun.glint = "paper".',
        ),
        (
            {"sun.glint": "cox_munk", "sun.legendre_moment": -2.5},
            "sun.legendre_moment: -2.5 can leave the sky a negative irradiance in equation (5), "
            'and sun.glint = "cox_munk" mirrors it. Take -2 or more.',
        ),
        (
            {"sun.spectrum": "astm_g173", "receiver.filter_width_nm": 310.0},
            "receiver.filter_width_nm: 310 nm around 532 nm leaves the tabled spectrum, "
            '380 to 760 nm. Narrow it or take sun.spectrum = "stated".',
        ),
    ],
)
def test_words_that_do_not_go_together(scenario: Scenario, keys: dict[str, Any], line: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        scenario.replace(**keys)
    assert caught.value.lines == (f"reef.toml: {line}",)


def test_all_contradictions_come_at_once(scenario: Scenario) -> None:
    keys = {
        "sun.model": "high_flight",
        "sun.air_extinction_per_m": 1e-4,
        "sun.spectrum": "astm_g173",
        "sun.solar_irradiance_w_m2_nm": 1.9,
    }
    with pytest.raises(ScenarioError) as caught:
        scenario.replace(**keys)
    assert [fault.place for fault in caught.value.faults] == [
        "sun.solar_irradiance_w_m2_nm",
        "sun.air_extinction_per_m",
        "sun.model",
    ]


@pytest.mark.parametrize(
    ("keys", "noted"),
    [
        ({}, False),
        ({"surface.wind_speed_m_s": 2.0}, False),
        ({"surface.wind_speed_m_s": 8.0}, True),
        ({"sun.zenith_deg": 45.0}, True),
        ({"sun.zenith_deg": 45.0, "sun.glint": "cox_munk"}, False),
        ({"sun.zenith_deg": 45.0, "sun.day": False}, False),
        ({"sun.zenith_deg": 45.0, "sun.radiance_w_m2_um_sr": 50.0}, False),
    ],
)
def test_the_paper_s_glint_beyond_its_numbers_is_noted(
    scenario: Scenario, keys: dict[str, Any], noted: bool
) -> None:
    flown = scenario.replace(**keys)
    lines = list(sun_notes(flown.sun, flown.surface))
    assert len(lines) == noted
    assert all('"cox_munk" knows others' in line for line in lines)


def test_a_mixed_water_s_reflectance_must_be_stated(tables: dict[str, Any]) -> None:
    tables["water"] = {"type": "stated", "absorption_per_m": 0.1, "scattering_per_m": 0.2}
    tables["water"]["phase_function"] = "average_particle"
    tables["sun"] = {"water_light": "by_water_type"}
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_tables(tables, name="reef.toml", folder=Path())
    assert [fault.place for fault in caught.value.faults] == ["sun.water_light"]

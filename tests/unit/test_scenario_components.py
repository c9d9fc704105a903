"""The parts of a mission carry SI units and radians."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.scenario import components
from survey.scenario.scenario import Scenario


@pytest.fixture
def scenario(tables: dict[str, Any]) -> Scenario:
    return Scenario.from_tables(tables, name="reef.toml", folder=Path())


def test_laser(scenario: Scenario) -> None:
    laser = components.laser(scenario)
    assert (laser.pulse_energy, laser.wavelength, laser.pulse_fwhm) == (
        1.0,
        pytest.approx(532e-9),
        pytest.approx(10e-9),
    )


def test_a_pixel_is_2_m_at_250_m(scenario: Scenario) -> None:
    camera = components.camera(scenario)
    assert camera.pixel_tangent * 250.0 == pytest.approx(2.0)
    assert camera.shape == (32, 64)
    turned = components.camera(scenario.replace(**{"camera.long_side": "across"}))
    assert turned.half_tangents == camera.half_tangents[::-1]


def test_the_gate_opens_30_ns_before_the_surface(scenario: Scenario) -> None:
    receiver = components.receiver(scenario)
    surface = 2.0 * 200.0 / 299_792_458.0
    assert receiver.gate_start == pytest.approx(surface - 30e-9, abs=1e-15)
    assert (receiver.bin_width, receiver.bins) == (pytest.approx(1e-9), 300)
    assert receiver.filter_width == pytest.approx(1e-9)
    assert receiver.aperture_radius == 0.005


def test_detector(scenario: Scenario) -> None:
    detector = components.detector(scenario)
    assert detector.quantum_efficiency == 0.2
    assert detector.dark_count_rate == 1.0e4


def test_water_keeps_the_paper_unless_told_otherwise(scenario: Scenario) -> None:
    assert components.water(scenario).surface.absorption == 0.179
    changed = components.water(scenario.replace(**{"water.absorption_per_m": 0})).surface
    assert (changed.absorption, changed.scattering) == (0.0, 0.219)


def test_sea_surface(scenario: Scenario) -> None:
    sea = components.sea_surface(scenario.replace(**{"surface.wind_from_deg": 90}))
    assert sea.level == 0.5
    assert sea.wind_from == pytest.approx(np.pi / 2)
    assert sea.slope_variance == pytest.approx(0.003 + 5.08e-3 * 5.0)


def test_the_flight_lies_in_the_local_frame(scenario: Scenario) -> None:
    plan, frame = components.flight_plan(scenario), components.map_frame(scenario)
    on_map = frame.to_map(np.array([*plan.start, 0.0]))
    assert on_map[:2] == pytest.approx([500250.0, 6000750.0])
    assert plan.start == (250.0, 750.0)
    assert plan.heading == pytest.approx(np.pi / 2)
    assert plan.swath == pytest.approx(51.2)
    assert plan.altitude == 200.5


def test_transport_takes_the_illumination_from_the_laser(scenario: Scenario) -> None:
    settings = components.transport_settings(scenario.replace(**{"laser.illumination": "isolated"}))
    assert settings.illumination == "isolated"
    assert settings.split_angle == pytest.approx(np.pi / 4)


def test_a_stated_radiance_comes_before_sun_and_night(scenario: Scenario) -> None:
    night = scenario.replace(**{"sun.day": False})
    assert components.background_radiance(night) == pytest.approx(1e-3 / 1e-6)
    stated = night.replace(**{"sun.radiance_w_m2_um_sr": 2.0})
    assert components.background_radiance(stated) == pytest.approx(2.0e6)


def test_ranging_waits_one_pulse_unless_told_otherwise(scenario: Scenario) -> None:
    assert components.ranging_settings(scenario).gate == pytest.approx(10e-9)
    changed = scenario.replace(**{"processing.echo_gate_ns": 6})
    assert components.ranging_settings(changed).gate == pytest.approx(6e-9)

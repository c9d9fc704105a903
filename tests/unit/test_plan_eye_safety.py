"""Exposure limits by hand, and the distances that follow."""

from __future__ import annotations

from dataclasses import replace

import pytest

from survey.planning.eye_safety import (
    exposure_limit,
    eye_safety,
    pulse_limit,
    train_factor,
)
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser

LASER = Laser(pulse_energy=1.0, wavelength=532e-9, pulse_fwhm=10e-9)
CAMERA = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
FLIGHT = {"height": 200.0, "speed": 100.0, "flash_rate": 1.0, "burst": 1, "burst_rate": 1e5}


@pytest.mark.parametrize(
    ("duration", "limit"),
    [(1e-12, 1e-3), (1e-9, 2e-3), (5e-6, 2e-3), (1e-3, 0.1012), (0.25, 6.364), (10.0, 101.2)],
)
def test_limit_of_one_exposure(duration: float, limit: float) -> None:
    assert exposure_limit(duration) == pytest.approx(limit, rel=1e-3)


def test_limit_is_continuous_where_heat_begins_to_spread() -> None:
    assert exposure_limit(5.0001e-6) == pytest.approx(2e-3, rel=0.06)


def test_many_pulses_lower_the_limit_of_each() -> None:
    assert train_factor(pulses=1e6, duration=0.2) == 1.0
    assert train_factor(pulses=2000, duration=1.0) == pytest.approx(5.0 * 2000**-0.25)
    assert train_factor(pulses=1e9, duration=1.0) == 0.4


def test_pulses_within_five_microseconds_count_as_one() -> None:
    train = {"pulse_duration": 1e-9, "flashes": 1, "dwell": 0.1}
    one = pulse_limit(burst=1, burst_rate=1e6, **train)
    assert pulse_limit(burst=5, burst_rate=1e6, **train) == pytest.approx(one / 5.0)


def test_the_train_as_a_whole_has_its_limit() -> None:
    """10,000 flashes within 1 s: 18 J/m2 shared out among them is stricter than C5."""
    found = pulse_limit(pulse_duration=1e-9, burst=1, burst_rate=1e5, flashes=10_000, dwell=1.0)
    assert found == pytest.approx(min(18.0 / 10_000, 2e-3 * 0.5))


def test_distances_go_with_the_root_of_energy_and_of_field() -> None:
    base = eye_safety(laser=LASER, camera=CAMERA, **FLIGHT)
    weak = eye_safety(laser=replace(LASER, pulse_energy=0.25), camera=CAMERA, **FLIGHT)
    assert weak.distance == pytest.approx(0.5 * base.distance)
    assert base.at_water == pytest.approx(1.0 / (102.4 * 51.2 * 0.9613), rel=1e-3)
    assert base.binocular_distance == pytest.approx(7.0 * base.distance)
    assert base.at_water * (200.0 / base.distance) ** 2 == pytest.approx(base.limit)

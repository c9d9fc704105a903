"""The whole result of `bathyflash paper`, held to what the paper's digest expects of it."""

from __future__ import annotations

import time

import pytest

from survey.paper.reproduce import reproduce

pytestmark = pytest.mark.slow

# Seed 1, full work: changes beyond the errors need a reason.
STORED = {
    "day": {"P02": 28.78, "P05": 17.31, "P07": 8.61},
    "night": {"P02": 41.81, "P05": 24.36, "P07": 12.38},
}


@pytest.fixture(scope="module")
def result():
    begun = time.perf_counter()
    findings = reproduce(seed=2)
    return findings, time.perf_counter() - begun


def test_six_depths_of_isolated_pixels(result):
    """Within 8 % r.m.s. and 13 % at worst, by two parameters, each depth to less than 0.2 m."""
    fit = result[0].isolated
    assert fit.rms < 0.08
    assert abs(fit.worst) < 0.13
    for sun, waters in STORED.items():
        for name, stored in waters.items():
            assert fit.errors[sun][name] < 0.2
            assert fit.depths[sun][name] == pytest.approx(stored, abs=5.0 * fit.errors[sun][name])


def test_flood_and_apparent_depth_fit_worse(result):
    findings = result[0]
    assert findings.flood.rms == pytest.approx(0.23, abs=0.02)
    assert abs(findings.flood.worst) == pytest.approx(0.34, abs=0.02)
    assert findings.apparent.rms > findings.isolated.rms + 0.01


def test_the_receiver_cannot_exist(result):
    findings = result[0]
    assert findings.isolated.receiver.aperture_radius == pytest.approx(0.375, abs=0.015)
    assert findings.isolated.receiver.filter_width == pytest.approx(1.67e-9, abs=0.15e-9)
    assert not findings.verdict.can_exist
    assert findings.verdict.etendue_ratio > 1e4
    assert findings.verdict.sun_per_gate == pytest.approx(1.9e4, rel=0.1)


def test_within_three_minutes(result):
    assert result[1] < 180.0

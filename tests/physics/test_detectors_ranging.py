"""Ranging behind every detector: false alarms as rare as stated, echoes as likely as told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr
from scipy.stats import binom, norm

from survey.cloud.noise import NoiseModel, RangingSettings, gate_sums
from survey.cloud.ranging import (
    bottom_detection_probability,
    first_echo,
    last_echo,
    surface_walk,
)
from survey.sensor.apd import LinearApd
from survey.sensor.detector import Detector
from survey.sensor.ideal import IdealCounter
from survey.sensor.photon_counting import firing_threshold
from survey.sensor.pmt import Pmt
from survey.sensor.spad import Look, Spad
from survey.transport.waveforms import pulse_taps

FloatArray = NDArray[np.float64]
NS = 1e-9
BINS, ROWS, COLUMNS = 240, 16, 32
START = 1300.0 * NS
SIGMA = 10.0 / 2.3548200450309493
RATE = 2e-2


def spad(**changes: Any) -> Spad:
    values: dict[str, Any] = {
        "quantum_efficiency": 0.4,
        "fill_factor": 1.0,
        "dark_count_rate": 0.0,
        "dead_time": 30.0 * NS,
        "afterpulse_probability": 0.0,
        "afterpulse_lifetime": 20.0 * NS,
        "crosstalk_probability": 0.0,
        "jitter_sigma": 0.1 * NS,
        "max_counts_per_bin": 65_535,
        "bin_width": NS,
        "looks": (Look(armed=np.ones((1, 1, BINS), np.bool_), pulses=60),),
    }
    return Spad(**(values | changes))


DETECTORS: dict[str, Detector] = {
    "ideal": IdealCounter(
        quantum_efficiency=0.2, dark_count_rate=0.0, max_counts_per_bin=65_535, pulses=3
    ),
    "spad": spad(),
    "spad, afterpulses": spad(
        dead_time=4.0 * NS, afterpulse_probability=0.08, crosstalk_probability=0.01
    ),
    "spad, first photon": spad(dead_time=1e-6),
    "apd": LinearApd(
        quantum_efficiency=0.6,
        dark_count_rate=0.0,
        gain=100.0,
        ionisation_ratio=0.02,
        amplifier_noise=2e-12,
        bandwidth=200e6,
        full_scale=1e6,
        bin_width=NS,
    ),
    "photodiode": LinearApd(
        quantum_efficiency=0.6,
        dark_count_rate=0.0,
        gain=1.0,
        ionisation_ratio=0.0,
        amplifier_noise=2e-14,
        bandwidth=200e6,
        full_scale=1e6,
        bin_width=NS,
    ),
    "pmt": Pmt(
        quantum_efficiency=0.3,
        dark_count_rate=0.0,
        gain=1e6,
        secondary_emission=4.0,
        rc=2.0 * NS,
        amplifier_noise=3e-11,
        transit_time_sigma=0.3 * NS,
        full_scale=1e6,
        bin_width=NS,
    ),
}


def pulse(centre: float, photons: float) -> FloatArray:
    edges = np.arange(BINS + 1.0)
    return np.asarray(photons * np.diff(ndtr((edges - centre) / SIGMA)))


def bottomless(surface: float, steady: float) -> FloatArray:
    time = np.arange(BINS) - 40.0
    column = 0.02 * surface * np.exp(-time / 30.0) * (time > 0.0)
    light = pulse(40.5, surface) + column + steady
    return np.broadcast_to(light, (ROWS, COLUMNS, BINS)).copy()


def noise_over(detector: Detector, light: FloatArray, steady: float) -> NoiseModel:
    return NoiseModel.build(
        settings=RangingSettings(false_alarm_rate=RATE, gate=10.0 * NS),
        detector=detector,
        steady_light=steady,
        bottomless_light=light,
        flash_variance=np.zeros_like(light),
        model_flashes=4,
        pulse=pulse_taps(sigma=SIGMA, width=1.0, pad=13),
        bin_start=START,
        bin_width=NS,
    )


@pytest.mark.parametrize("name", DETECTORS)
@pytest.mark.parametrize(("surface", "steady"), [(0.0, 0.02), (20.0, 0.15), (3e4, 0.02)])
def test_false_echoes_are_no_more_than_stated(name: str, surface: float, steady: float) -> None:
    detector, light = DETECTORS[name], bottomless(surface, steady)
    noise, chance = noise_over(detector, light, steady), np.random.default_rng(1)
    before = np.full((ROWS, COLUMNS), START - 11.0 * NS)
    bottoms = surfaces = 0
    for _ in range(4):
        over_water = detector.read(light, chance).counts
        in_the_dark = detector.read(np.full_like(light, steady), chance).counts
        bottoms += last_echo(counts=over_water, noise=noise, surface_time=before).found.sum()
        surfaces += first_echo(counts=in_the_dark, noise=noise).found.sum()
    most = binom.isf(1e-6, 4 * ROWS * COLUMNS, RATE)
    assert bottoms <= most
    assert surfaces <= most


CLEAR = {"apd": 120.0, "photodiode": 100.0, "pmt": 40.0, "ideal": 20.0}
PALE = {"surface": 20.0, "steady": 0.02}
PALE_SPAD = {"surface": 0.1, "steady": 0.002}


@pytest.mark.parametrize("name", DETECTORS)
def test_echoes_fire_as_often_as_told(name: str) -> None:
    """From nothing to sure; where readings are not Poisson's, told to a tenth."""
    detector, over = DETECTORS[name], PALE_SPAD if "spad" in name else PALE
    light = bottomless(**over)
    noise = noise_over(detector, light, over["steady"])
    strength = np.linspace(0.0, CLEAR.get(name, 1.0), COLUMNS)
    bottom = np.broadcast_to(np.stack([pulse(130.5, each) for each in strength]), light.shape)
    told = bottom_detection_probability(bottom=bottom, noise=noise).mean(axis=0)
    chance, fires, frames = np.random.default_rng(2), np.zeros(COLUMNS), 12
    for _ in range(frames):
        sums = gate_sums(detector.read(light + bottom, chance).counts, noise.gate_bins)
        fires += (sums >= noise.bottom_threshold)[..., 130].mean(axis=0) / frames
    spread = np.sqrt(told * (1.0 - told) / (frames * ROWS))
    approximation = 0.0 if name == "ideal" else 0.1
    assert np.all(np.abs(fires - told) < 4.5 * spread + approximation + 1e-3)
    assert told[0] < 0.02
    assert told[-1] > 0.9


@pytest.mark.parametrize("name", DETECTORS)
def test_a_clear_echo_is_ranged_behind_every_detector(name: str) -> None:
    """To a fifth of a bin on average; a SPAD sees first photons and ranges early."""
    detector, over = DETECTORS[name], PALE_SPAD if "spad" in name else PALE
    light = bottomless(**over)
    noise = noise_over(detector, light, over["steady"])
    bottom = pulse(130.5, 3.0 * CLEAR.get(name, 1.0))
    counts = detector.read(light + bottom, np.random.default_rng(3)).counts
    before = np.full((ROWS, COLUMNS), START + 40.5 * NS)
    echo = last_echo(counts=counts, noise=noise, surface_time=before)
    assert echo.found.mean() > 0.99
    late = np.nanmean((echo.time - START) / NS) - 130.5
    if "spad" in name:
        assert -5.0 < late < -0.5
    else:
        assert abs(late) < 0.2


def test_too_little_surface_light_makes_no_bottoms_of_a_spad_that_recovers() -> None:
    """The model's error counts both ways: a paler surface leaves a SPAD more alive behind it."""
    light, looks = bottomless(4.0, 0.03), (Look(armed=np.ones((1, 1, BINS), np.bool_), pulses=600),)
    detector = spad(dead_time=1e-6, looks=looks)
    error = 0.2 * light
    sure = noise_over(detector, light, 0.03)
    noise = NoiseModel.build(
        settings=RangingSettings(false_alarm_rate=RATE, gate=10.0 * NS),
        detector=detector,
        steady_light=0.03,
        bottomless_light=light,
        flash_variance=error**2 / 1.25,
        model_flashes=4,
        pulse=sure.pulse,
        bin_start=START,
        bin_width=NS,
    )
    paler = gate_sums(detector.mean(light - error) - sure.bottomless, noise.gate_bins)
    wanted = gate_sums(sure.bottomless, noise.gate_bins) + norm.isf(RATE / BINS) * paler
    threshold = firing_threshold(false_alarm=RATE / BINS, noise=wanted[..., 100:])
    assert np.array_equal(noise.bottom_threshold[..., 100:], threshold)
    counts = detector.read(light - 1.5 * error, np.random.default_rng(4)).counts
    before = np.full((ROWS, COLUMNS), START + 41.0 * NS)
    found = last_echo(counts=counts, noise=noise, surface_time=before).found.sum()
    assert found <= binom.isf(1e-6, ROWS * COLUMNS, RATE)


def test_the_early_surface_of_a_spad_is_calibrated_away() -> None:
    """Fourteen photo-electrons a pulse: first photons come 7 ns early; 1 ns is left of it."""
    light = bottomless(14.0, 0.001)
    detector = spad(dead_time=20.0 * NS)
    noise = noise_over(detector, light, 0.001)
    walk = surface_walk(noise)
    assert np.all((walk < -5.0 * NS) & (walk > -9.0 * NS))
    counts = detector.read(light, np.random.default_rng(5)).counts
    told = first_echo(counts=counts, noise=replace(noise, surface_walk=walk))
    assert abs((told.time - START).mean() / NS - 40.5) < 1.2
    counter = noise_over(DETECTORS["ideal"], light, 0.001)
    assert np.abs(surface_walk(counter)).max() < 1e-6 * NS

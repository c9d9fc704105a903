"""The matched filter: false alarms as rare as stated, more echoes, and when they came."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr
from scipy.stats import binom

from survey.cloud.bottom_search import MatchedSearch, ThresholdSearch
from survey.cloud.noise import NoiseModel, RangingSettings
from survey.cloud.ranging import bottom_detection_probability
from survey.cloud.tails import TailTable
from survey.ranging_curves import curves
from survey.sensor.detector import Detector
from survey.sensor.ideal import IdealCounter
from survey.transport.waveforms import pulse_taps
from tests.physics.test_detectors_ranging import DETECTORS

FloatArray = NDArray[np.float64]
NS = 1e-9
START = 1300.0 * NS
ROWS, COLUMNS, BINS = 24, 40, 200
SIGMA = 10.0 / 2.3548200450309493
SURFACE = 30
COUNTER = IdealCounter(quantum_efficiency=0.2, dark_count_rate=0.0, max_counts_per_bin=10**9)


def pulse(centre: FloatArray, photons: float) -> FloatArray:
    edges = np.arange(BINS + 1.0)
    return np.asarray(photons * np.diff(ndtr((edges - centre[..., None]) / SIGMA), axis=-1))


def water(strength: float, steady: float) -> FloatArray:
    """Surface echo and column over a tilted row of pixels: two bins later from each to the next."""
    surface = SURFACE + 0.5 + 1.5 * np.arange(COLUMNS) * np.ones((ROWS, 1))
    behind = np.arange(BINS) + 0.5 - surface[..., None]
    column = 0.05 * strength * np.exp(-behind / 25.0) * (behind > 0.0)
    return np.asarray(pulse(surface, strength) + column + steady)


def surface_time() -> FloatArray:
    late = SURFACE + 0.5 + 1.5 * np.arange(COLUMNS) * np.ones((ROWS, 1))
    return np.asarray(START + late * NS)


def noise_over(
    light: FloatArray, steady: float, *, rate: float = 1e-2, detector: Detector = COUNTER
) -> NoiseModel:
    return NoiseModel.build(
        settings=RangingSettings(false_alarm_rate=rate, gate=10.0 * NS),
        detector=detector,
        steady_light=steady,
        bottomless_light=light,
        flash_variance=np.zeros_like(light),
        model_flashes=4,
        pulse=pulse_taps(sigma=SIGMA, width=1.0, pad=13),
        bin_start=START,
        bin_width=NS,
    )


def search_over(
    noise: NoiseModel, error: float | FloatArray = 0.0, *, time: FloatArray | None = None
) -> MatchedSearch:
    variance = np.broadcast_to(np.square(error), noise.bottomless.shape)
    at = surface_time() if time is None else time
    return MatchedSearch.over(noise=noise, variance=variance, surface_time=at)


@pytest.mark.parametrize("gain_variance", [0.0, 1.5])
@pytest.mark.parametrize("rate", [0.003, 0.3, 60.0])
def test_sums_of_weighted_counts_pass_their_threshold_as_often_as_stated(
    gain_variance: float, rate: float
) -> None:
    """By drawing: half to one and a fifth of the stated share, as sums of few counts are steps."""
    weights = np.exp(-0.5 * (np.arange(-9, 10) / 3.0) ** 2)
    table = TailTable.build(weights=weights, false_alarm=1e-3, gain_variance=gain_variance)
    chance, number = np.random.default_rng(1), 60_000
    total = np.zeros(number)
    for weight in weights:
        mean = chance.gamma(rate / gain_variance, gain_variance, number) if gain_variance else rate
        total += weight * chance.poisson(mean, number)
    variance = rate * (1.0 + gain_variance) * (weights**2).sum()
    passed = (total - rate * weights.sum() >= table.above(np.array([variance]))).sum()
    assert binom.ppf(1e-4, number, 0.5e-3) <= passed <= binom.isf(1e-4, number, 1.2e-3)


@pytest.mark.parametrize(
    ("strength", "steady", "least"), [(0.0, 0.003, 0.1), (20.0, 0.1, 0.1), (1e6, 1.0, 0.0)]
)
def test_bottomless_water_has_no_more_bottoms_than_stated(
    strength: float, steady: float, least: float
) -> None:
    """Nor many times fewer, unless the doubt of the column is far above the chance of counts."""
    light = water(strength, steady)
    noise, chance = noise_over(light, steady, rate=0.05), np.random.default_rng(2)
    search = search_over(noise)
    false = sum(int(search.echo(chance.poisson(light)).found.sum()) for _ in range(4))
    pixels = 4 * ROWS * COLUMNS
    assert least * 0.05 * pixels <= false <= binom.isf(1e-4, pixels, 0.05)


@pytest.mark.parametrize(
    "name", ["apd", "pmt", pytest.param("spad, afterpulses", marks=pytest.mark.slow)]
)
def test_false_bottoms_behind_other_detectors_are_no_more_than_stated(name: str) -> None:
    light, chance = np.ascontiguousarray(water(20.0, 0.05)[:, :, :]), np.random.default_rng(3)
    detector = DETECTORS[name]
    if "spad" in name:
        looks = tuple(
            replace(look, armed=np.ones((1, 1, BINS), np.bool_)) for look in detector.looks
        )
        detector = replace(detector, looks=looks)
        light = light / 50.0
    noise = noise_over(light, float(light.min()), rate=0.02, detector=detector)
    false = search_over(noise).echo(detector.read(light, chance).counts).found.sum()
    assert false <= binom.isf(1e-5, ROWS * COLUMNS, 0.02)


@pytest.mark.parametrize("scale", [0.95, 1.05])
def test_a_column_a_few_per_cent_off_makes_no_bottoms(scale: float) -> None:
    light = water(1e6, 1.0)
    noise = noise_over(light, 1.0, rate=1e-3)
    counts = np.random.default_rng(4).poisson(light * scale)
    assert search_over(noise).echo(counts).found.sum() <= 3


def test_errors_of_the_monte_carlo_make_no_bottoms() -> None:
    """Of 8 %, alike over a pulse and apart from pixel to pixel, where shot noise is a tenth."""
    light, chance = water(1e6, 1.0), np.random.default_rng(5)
    noise = noise_over(light, 1.0)
    rough = np.repeat(chance.normal(size=(ROWS, COLUMNS, BINS // 10)), 10, axis=-1)
    false = search_over(noise, 0.08 * light).echo(chance.poisson(light * (1.0 + 0.08 * rough)))
    assert false.found.sum() <= binom.isf(1e-4, ROWS * COLUMNS, 1e-2)


def test_one_bright_path_is_no_bottom_of_its_neighbours_nor_of_its_own() -> None:
    light = water(20.0, 0.1)
    path = np.zeros_like(light)
    path[10, 10] = pulse(np.array(130.0), 5000.0)
    search = search_over(noise_over(light, 0.1, rate=1e-6), path / 1.7)
    assert not search.echo(np.random.default_rng(6).poisson(light + path)).found.any()


def test_weak_echoes_are_found_with_their_neighbours_on_a_slope() -> None:
    """A bed that falls 10 degrees along the rows: six counts a pixel over nine of noise in a gate.

    The threshold finds under half of them at five times the false-alarm rate.
    """
    light = water(20.0, 0.8)
    noise, chance = noise_over(light, 0.8, rate=1e-3), np.random.default_rng(7)
    place = SURFACE + 90.5 + 1.5 * np.arange(COLUMNS) + 2.5 * np.arange(ROWS)[:, None] - 30.0
    bottom = pulse(place, 9.0)
    counts = chance.poisson(light + bottom)
    echo = search_over(noise).echo(counts)
    plain = ThresholdSearch.over(
        noise=noise.at_rate(5e-3), variance=np.zeros_like(light), surface_time=surface_time()
    ).echo(counts)
    off = (echo.time - START) / NS - place
    right = np.abs(off) < 9.0
    assert plain.found.mean() < 0.2
    assert right.mean() > 0.8
    assert (echo.found & ~right).mean() < 0.02
    assert abs(np.median(off[right])) < 0.5


def test_a_pixel_without_an_echo_of_its_own_is_not_found_with_its_neighbours() -> None:
    light = water(20.0, 0.8)
    place = np.full((ROWS, COLUMNS), 150.5)
    bottom = pulse(place, 20.0)
    bottom[10, 20] = 0.0
    counts = np.random.default_rng(8).poisson(light + bottom)
    counts[10, 20] = np.round(light[10, 20])
    echo = search_over(noise_over(light, 0.8, rate=1e-3)).echo(counts)
    assert echo.found[9:12, 19:22].sum() >= 7
    assert not echo.found[10, 20]


def test_a_weak_tail_does_not_hide_the_strong_echo_before_it() -> None:
    """A five-hundredth of the bottom, three and a half gates later: afterpulses, or the water."""
    light = water(20.0, 0.1)
    place = SURFACE + 50.5 + 1.5 * np.arange(COLUMNS) * np.ones((ROWS, 1))
    bottom = pulse(place, 30_000.0) + pulse(place + 35.0, 60.0)
    counts = np.random.default_rng(12).poisson(light + bottom)
    echo = search_over(noise_over(light, 0.1)).echo(counts)
    assert echo.found.all()
    assert np.abs((echo.time - START) / NS - place).max() < 0.5


@pytest.mark.parametrize("times", [2.0, 3.0])
@pytest.mark.parametrize("later", [32.0, 38.0])
def test_a_valley_parts_a_bottom_from_a_surface_brighter_than_the_model(
    times: float, later: float
) -> None:
    """Under a bright wave the surface's flank is above the threshold all the way to the bottom."""
    surface = (surface_time() - START) / NS
    light = water(1200.0, 20.0) + pulse(surface, 50_000.0)
    flash = light + pulse(surface, 50_000.0 * (times - 1.0)) + pulse(surface + later, 5000.0)
    counts = COUNTER.read(flash, np.random.default_rng(29)).counts
    echo = search_over(noise_over(light, 20.0), 5.0).echo(counts)
    assert echo.found.all()
    assert np.abs((echo.time - START) / NS - surface - later).max() < 0.5


def test_land_and_nothing_at_all_have_no_bottom() -> None:
    light, time = water(20.0, 0.1), surface_time()
    time[:, :5] = np.nan
    noise = noise_over(light, 0.1)
    counts = np.random.default_rng(9).poisson(light + pulse(np.full((ROWS, COLUMNS), 150.5), 300.0))
    found = search_over(noise, time=time).echo(counts).found
    assert not found[:, :5].any()
    assert found[:, 5:].all()
    assert not search_over(noise).echo(np.zeros_like(counts)).found.any()


@pytest.mark.parametrize("photons", [60.0, 3000.0])
def test_times_scatter_as_their_stated_error_says(photons: float) -> None:
    """To a tenth; the bound of Cramer and Rao is reached, and no time is off on average."""
    light = water(20.0, 0.1)
    place = SURFACE + 90.3 + 1.5 * np.arange(COLUMNS) * np.ones((ROWS, 1))
    counts = np.random.default_rng(10).poisson(light + pulse(place, photons))
    search = search_over(noise_over(light, 0.1))
    plain = ThresholdSearch.over(
        noise=search.noise, variance=np.zeros_like(light), surface_time=surface_time()
    )
    for echo in (search.echo(counts), plain.echo(counts)):
        pull = (echo.time - START - place * NS) / echo.time_error
        assert echo.found.all()
        assert abs(pull.mean()) < 0.2
        assert 0.9 < pull.std() < 1.12


def test_the_least_error_of_time_is_that_of_counted_pulses() -> None:
    """Over no noise, sigma / sqrt(n)."""
    light = np.full((1, 1, BINS), 1e-9)
    noise = noise_over(light, 1e-9)
    counts = np.round(pulse(np.full((1, 1), 100.5), 1e6))
    echo = search_over(noise, time=np.full((1, 1), START + 30.0 * NS)).echo(counts)
    assert echo.time_error[0, 0] == pytest.approx(SIGMA * NS / 1e3, rel=0.03)
    assert (echo.time[0, 0] - START) / NS == pytest.approx(100.5, abs=0.02)


def test_the_probability_is_about_the_share_that_is_found() -> None:
    """To a fifth, from nothing to sure, and never far under the plain threshold's."""
    light = water(20.0, 0.8)
    noise = noise_over(light, 0.8, rate=1e-3)
    search, chance = search_over(noise), np.random.default_rng(11)
    for photons in (0.0, 5.0, 8.0, 14.0, 40.0):
        bottom = pulse(SURFACE + 90.5 + 1.5 * np.arange(COLUMNS) * np.ones((ROWS, 1)), photons)
        told = search.probability(bottom)[3:-3, 3:-3].mean()
        found = search.echo(chance.poisson(light + bottom)).found[3:-3, 3:-3].mean()
        plain = bottom_detection_probability(bottom=bottom, noise=noise)[3:-3, 3:-3].mean()
        assert abs(told - found) < 0.2, photons
        assert told > plain - 0.02


@pytest.mark.slow
@pytest.mark.parametrize("water", ["coastal", "clear"])
@pytest.mark.parametrize("day", [True, False])
def test_the_matched_filter_finds_a_third_more_at_no_more_false_alarms(
    water: str, day: bool
) -> None:
    """In every depth bin where the threshold, as often false, finds a fifth to a half."""
    found = curves(water, day=day, frames=7, draws=1)
    assert found["matched_false_alarms"] <= found["threshold_false_alarms"]
    most = binom.isf(1e-3, found["bottomless_pixels"], found["matched_stated_rate"])
    assert found["matched_false_alarms"] <= most
    bins = [row for row in found["by_depth_m"] if 0.2 <= row["threshold"] <= 0.5]
    assert bins
    assert all(row["matched"] >= 1.3 * row["threshold"] for row in bins)

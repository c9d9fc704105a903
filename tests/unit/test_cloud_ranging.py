"""Echoes found in made counts, whose times and strengths are known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr
from scipy.stats import binom, norm, poisson

from survey.cloud.noise import NoiseModel, RangingSettings, gate_sums
from survey.cloud.ranging import (
    Echo,
    blind_at,
    bottom_detection_probability,
    first_echo,
    last_echo,
)
from survey.sensor.ideal import IdealCounter
from survey.transport.waveforms import pulse_taps

FloatArray = NDArray[np.float64]
NS = 1e-9
START = 1300.0 * NS
BINS = 300
SIGMA = 10.0 * NS / 2.3548200450309493
GATE = 11
CALM_SURFACE = START + 40.0 * NS
COUNTER = IdealCounter(quantum_efficiency=0.2, dark_count_rate=0.0, max_counts_per_bin=65_535)


def pulse(
    time: float | FloatArray, photons: float | FloatArray = 1.0, bins: int = BINS
) -> FloatArray:
    """A pulse of 10 ns at times [s], as counts expected in each bin."""
    edges = START + np.arange(bins + 1) * NS
    return np.asarray(photons)[..., None] * np.diff(
        ndtr((edges - np.asarray(time)[..., None]) / SIGMA), axis=-1
    )


def column(bins: int = BINS) -> FloatArray:
    """Surface echo and water column that fade away."""
    time = (np.arange(bins) - 40.0) * NS
    return pulse(CALM_SURFACE, 3000.0, bins) + 40.0 * np.exp(-time / (30.0 * NS)) * (time > 0.0)


def noise_model(
    bottomless: FloatArray, *, steady: float = 0.02, rate: float = 1e-3, variance: float = 0.0
) -> NoiseModel:
    return NoiseModel.build(
        settings=RangingSettings(false_alarm_rate=rate, gate=10.0 * NS),
        detector=COUNTER,
        steady_light=steady,
        bottomless_light=bottomless,
        flash_variance=np.full(bottomless.shape, variance),
        model_flashes=4,
        pulse=pulse_taps(sigma=SIGMA, width=NS, pad=13),
        bin_start=START,
        bin_width=NS,
    )


def whole(expected: FloatArray) -> NDArray[np.int32]:
    return np.round(expected).astype(np.int32)


def last(counts: NDArray[np.int32], noise: NoiseModel, surface: float = CALM_SURFACE) -> Echo:
    return last_echo(counts=counts, noise=noise, surface_time=np.full(counts.shape[:-1], surface))


def test_gate_sums_are_those_of_a_box_about_each_bin() -> None:
    values = np.random.default_rng(1).integers(0, 9, (3, 4, 50)).astype(float)
    box = np.apply_along_axis(np.convolve, -1, values, np.ones(7), mode="same")
    assert np.array_equal(gate_sums(values, 7), box)
    assert np.array_equal(gate_sums(values, 1), values)
    assert gate_sums(np.array([0.1, 0.2, 1e9, 0.0, 0.0, 0.0, 0.0]), 3).min() == 0.0


@pytest.mark.parametrize("rate", [1e-1, 1e-3, 1e-6])
def test_thresholds_are_the_least_counts_that_noise_reaches_seldom_enough(rate: float) -> None:
    bottomless = np.random.default_rng(2).gamma(0.3, 8.0, (2, 3, BINS)) + 0.02
    noise = noise_model(bottomless, rate=rate)
    counts = np.arange(2000)
    for threshold, mean in (
        (noise.surface_threshold, np.full(bottomless.shape, 0.02 * GATE)),
        (noise.bottom_threshold, gate_sums(bottomless, GATE)),
    ):
        rare = poisson.sf(counts - 1, mean[..., None]) <= rate / BINS
        assert np.array_equal(threshold, rare.argmax(axis=-1))


def test_thresholds_are_raised_by_the_monte_carlo_error_of_model_and_flash() -> None:
    bottomless, variance = np.full((3, 3, BINS), 5.0), 0.09
    noise = noise_model(bottomless, variance=variance)
    error = GATE * np.sqrt(variance * (1.0 + 1.0 / 4.0))
    mean = GATE * 5.0 + norm.isf(1e-3 / BINS) * error
    wanted = noise_model(np.full((1, 1, BINS), mean / GATE)).bottom_threshold[0, 0, BINS // 2]
    assert noise.bottom_threshold[1, 1, BINS // 2] == wanted
    assert wanted > noise_model(bottomless).bottom_threshold[1, 1, BINS // 2] + 5


def test_a_flash_that_errs_more_than_the_model_raises_its_thresholds() -> None:
    """By 4.5 deviations of what 11 bins of twice the error have more, the model's share too."""
    light = np.full((9, 9, BINS), 20.0)
    noise = noise_model(light, variance=4.0)
    assert np.array_equal(noise.of_flash(light * 0.2).bottom_threshold, noise.bottom_threshold)
    assert np.array_equal(noise.of_flash(light * 0.0).bottom_threshold, noise.bottom_threshold)
    raised = noise.of_flash(light * 0.8).bottom_threshold - noise.bottom_threshold
    wanted = norm.isf(1e-3 / BINS) * 11 * (4.0 - 2.0) * 1.25**0.5
    assert raised[..., 20:-20] == pytest.approx(wanted, rel=1e-6)


def test_a_bright_path_of_one_pixel_is_no_bottom() -> None:
    """A pulse that came by one replicate of four: its error is its own size over 1.7."""
    light = np.full((30, 30, BINS), 20.0)
    path = np.zeros_like(light)
    path[15, 15] = pulse(CALM_SURFACE + 100.0 * NS, 300.0)
    noise, counts = noise_model(light), whole(light + path)
    found = last(counts, noise).found
    assert found[15, 15]
    assert found.sum() == 1
    assert not last(counts, noise.of_flash((path / 1.7) ** 2)).found.any()
    assert last(counts, noise.of_flash((path / 4.0) ** 2 * 0.01)).found[15, 15]


@pytest.mark.parametrize(("gate_ns", "bins"), [(10.0, 11), (9.0, 9), (6.0, 7), (1.0, 1)])
def test_a_gate_is_odd_in_bins(gate_ns: float, bins: int) -> None:
    noise = NoiseModel.build(
        settings=RangingSettings(false_alarm_rate=1e-3, gate=gate_ns * NS),
        detector=COUNTER,
        steady_light=0.1,
        bottomless_light=np.full((1, 1, BINS), 0.1),
        flash_variance=np.zeros((1, 1, BINS)),
        model_flashes=4,
        pulse=np.ones(1),
        bin_start=START,
        bin_width=NS,
    )
    assert noise.gate_bins == bins


def test_echo_times_are_good_to_a_fiftieth_of_a_bin() -> None:
    times = START + (150.0 + np.linspace(0.0, 2.0, 41)) * NS
    steady = np.full((1, 41, BINS), 0.02)
    counts = whole(pulse(times, 1e6)[None] + steady)
    first = first_echo(counts=counts, noise=noise_model(steady))
    assert np.abs(first.time[0] - times).max() < 0.02 * NS
    late = last(whole(pulse(times, 1e6)[None] + column()), noise_model(steady + column()))
    assert np.abs(late.time[0] - times).max() < 0.02 * NS


def test_echo_times_scatter_no_more_than_the_counts_make_them() -> None:
    photons, time = 2000.0, START + 150.3 * NS
    bottomless = np.broadcast_to(column() + 0.02, (20, 50, BINS))
    counts = np.random.default_rng(3).poisson(bottomless + pulse(time, photons))
    echo = last(counts.astype(np.int32), noise_model(bottomless))
    limit = SIGMA / np.sqrt(photons)
    error = echo.time - time
    assert abs(error.mean()) < 4.0 * limit / np.sqrt(error.size)
    assert limit * 0.9 < error.std() < 1.25 * limit


def test_an_echo_has_its_counts_above_the_noise_and_their_ratio_to_chance() -> None:
    bottomless = (column() + 0.02)[None, None]
    time = START + 120.5 * NS
    echo = last(whole(bottomless + pulse(time, 1e5)), noise_model(bottomless))
    inside = 1e5 * (2.0 * ndtr(0.5 * GATE * NS / SIGMA) - 1.0)
    everything = inside + gate_sums(bottomless, GATE)[0, 0, 120]
    assert echo.counts[0, 0] == pytest.approx(inside, abs=GATE)
    assert echo.snr[0, 0] == pytest.approx(inside / np.sqrt(everything), rel=1e-3)


def test_noise_under_an_echo_lowers_its_ratio() -> None:
    bottomless = np.full((1, 1, BINS), 40.0)
    echo = last(whole(bottomless + pulse(START + 120.5 * NS, 1000.0)), noise_model(bottomless))
    inside = 1000.0 * (2.0 * ndtr(0.5 * GATE * NS / SIGMA) - 1.0)
    assert echo.counts[0, 0] == pytest.approx(inside, abs=GATE)
    assert echo.snr[0, 0] == pytest.approx(inside / np.sqrt(inside + 40.0 * GATE), rel=0.02)


def test_the_first_echo_is_the_surface_and_the_last_one_the_bottom() -> None:
    surface, bottom = START + 60.0 * NS, START + 130.0 * NS
    counts = whole(pulse(surface, 500.0) + pulse(bottom, 9000.0))[None, None]
    noise = noise_model(np.full((1, 1, BINS), 0.02))
    assert first_echo(counts=counts, noise=noise).time[0, 0] == pytest.approx(surface, abs=NS)
    assert last(counts, noise, surface).time[0, 0] == pytest.approx(bottom, abs=NS)


def test_of_several_echoes_the_last_one_counts_even_if_weaker() -> None:
    fish, bottom = START + 100.0 * NS, START + 140.0 * NS
    counts = whole(pulse(fish, 5000.0) + pulse(bottom, 400.0))[None, None]
    found = last(counts, noise_model(np.full((1, 1, BINS), 0.02)))
    assert found.time[0, 0] == pytest.approx(bottom, abs=0.5 * NS)


def test_the_tail_of_an_echo_is_no_later_echo() -> None:
    time = START + 150.0 * NS
    behind = (np.arange(BINS) - 150.0) * NS
    tail = 10.0 * np.exp(-np.maximum(behind, 0.0) / (8.0 * NS)) * (behind > 0.0)
    steady = np.full((40, 50, BINS), 0.3)
    counts = np.random.default_rng(4).poisson(steady + tail + pulse(time, 500.0))
    echo = last(counts.astype(np.int32), noise_model(steady, steady=0.3))
    assert echo.found.all()
    assert (np.abs(echo.time - time) > 9.0 * NS).mean() < 5e-3


def test_nothing_is_found_within_a_gate_behind_the_surface() -> None:
    noise = noise_model(np.full((1, 1, BINS), 0.02))
    for gap in (0.0, 5.0, 10.0):
        counts = whole(pulse(CALM_SURFACE + gap * NS, 1e4))[None, None]
        assert not last(counts, noise).found.any()
    counts = whole(pulse(CALM_SURFACE + (GATE + 2.0) * NS, 1e4))[None, None]
    assert last(counts, noise).found.all()


def test_a_pixel_without_water_has_no_bottom() -> None:
    counts = whole(pulse(START + 150.0 * NS, 1e4))[None, None]
    noise = noise_model(np.full((1, 1, BINS), 0.02))
    assert not last(counts, noise, np.nan).found.any()


def test_no_counts_are_no_echo() -> None:
    counts = np.zeros((2, 3, BINS), np.int32)
    noise = noise_model(np.full((2, 3, BINS), 0.02))
    for echo in (first_echo(counts=counts, noise=noise), last(counts, noise)):
        assert not echo.found.any()
        assert np.isnan(echo.time).all()
        assert np.isnan(echo.counts).all()
        assert np.isnan(echo.snr).all()


def test_echoes_at_the_ends_of_the_gate_are_found_where_they_are() -> None:
    noise = noise_model(np.full((1, 1, BINS), 0.02))
    late = START + (BINS - 6.0) * NS
    assert last(whole(pulse(late, 1e5))[None, None], noise).time[0, 0] == pytest.approx(
        late, abs=2.0 * NS
    )
    early = START + 6.0 * NS
    echo = first_echo(counts=whole(pulse(early, 1e5))[None, None], noise=noise)
    assert echo.time[0, 0] == pytest.approx(early, abs=2.0 * NS)


@pytest.mark.parametrize("steady", [0.02, 1.0])
def test_noise_alone_fires_no_more_often_than_stated(steady: float) -> None:
    rate, draws = 0.05, 5
    bottomless = np.broadcast_to(column() + steady, (40, 60, BINS))
    noise = noise_model(bottomless, steady=steady, rate=rate)
    chance = np.random.default_rng(5)
    surface = bottom = 0
    for _ in range(draws):
        counts = chance.poisson(bottomless).astype(np.int32)
        bottom += int(last(counts, noise, START - 11.0 * NS).found.sum())
        dark = chance.poisson(steady, bottomless.shape).astype(np.int32)
        surface += int(first_echo(counts=dark, noise=noise).found.sum())
    pixels = draws * 40 * 60
    most = binom.isf(1e-6, pixels, rate)
    assert pixels * rate / 30.0 < surface <= most
    assert pixels * rate / 30.0 < bottom <= most


def test_the_probability_of_firing_is_the_share_of_gates_that_fire() -> None:
    strength = np.linspace(0.0, 60.0, 60)
    bottom = np.broadcast_to(pulse(START + 120.0 * NS, strength), (800, 60, BINS))
    bottomless = np.broadcast_to(column() + 0.02, bottom.shape[1:])[None]
    noise = noise_model(bottomless)
    probability = bottom_detection_probability(bottom=bottom[:1], noise=noise)[0]
    counts = np.random.default_rng(6).poisson(bottom + bottomless).astype(np.int32)
    fires = (gate_sums(counts, GATE)[..., 120] >= noise.bottom_threshold[0, :, 120]).mean(axis=0)
    spread = np.sqrt(probability * (1.0 - probability) / 800.0)
    assert np.all(np.abs(fires - probability) < 4.5 * spread + 1e-3)
    assert probability[0] < 1e-3
    assert probability[-1] > 0.98
    found = last_echo(
        counts=counts,
        noise=noise,
        surface_time=np.full(counts.shape[:2], CALM_SURFACE),
    ).found.mean(axis=0)
    assert np.all(found >= probability - 4.5 * spread - 1e-3)
    assert np.all(found <= probability + 0.2)


def test_a_pixel_is_blind_where_its_gate_holds_a_blind_bin() -> None:
    noise = noise_model(np.full((1, 4, BINS), 0.02))
    blind = np.zeros((1, 4, BINS), np.bool_)
    blind[0, :3, 100] = True
    times = START + (np.array([[100.5, 105.5, 106.5, 100.5]])) * NS
    assert blind_at(blind=blind, time=times, noise=noise).tolist() == [[True, True, False, False]]
    assert not blind_at(blind=blind, time=np.full((1, 4), np.nan), noise=noise).any()

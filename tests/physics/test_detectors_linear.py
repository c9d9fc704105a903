"""Avalanche photodiode and photomultiplier against closed forms, and thresholds against tails."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.constants import e as elementary_charge
from scipy.stats import gamma, nbinom, norm, poisson

from survey.sensor.apd import LinearApd, gaussian_response, mcintyre_excess_noise
from survey.sensor.pmt import Pmt, dynode_excess_noise
from survey.sensor.response import bin_shares, spread
from survey.sensor.scatter import Scatter

NS = 1e-9
SHAPE = (40, 50, 60)


def apd(**changes: Any) -> LinearApd:
    values: dict[str, Any] = {
        "quantum_efficiency": 0.6,
        "dark_count_rate": 0.0,
        "gain": 100.0,
        "ionisation_ratio": 0.02,
        "amplifier_noise": 0.0,
        "bandwidth": 1e12,
        "full_scale": 1e9,
        "bin_width": NS,
    }
    return LinearApd(**(values | changes))


def pmt(**changes: Any) -> Pmt:
    values: dict[str, Any] = {
        "quantum_efficiency": 0.3,
        "dark_count_rate": 0.0,
        "gain": 1e6,
        "secondary_emission": 5.0,
        "rc": 2.0 * NS,
        "amplifier_noise": 0.0,
        "transit_time_sigma": 0.0,
        "full_scale": 1e9,
        "bin_width": NS,
    }
    return Pmt(**(values | changes))


def counts_of(detector: LinearApd | Pmt, light: Any, seed: int = 1) -> Any:
    return detector.read(light, np.random.default_rng(seed)).counts.astype(np.float64)


@pytest.mark.parametrize(
    ("gain", "ratio", "wanted"), [(1.0, 0.3, 1.0), (50.0, 0.0, 1.98), (50.0, 1.0, 50.0)]
)
def test_mcintyre_at_its_limits(gain: float, ratio: float, wanted: float) -> None:
    assert mcintyre_excess_noise(gain=gain, ionisation_ratio=ratio) == pytest.approx(wanted)


def test_mcintyre_without_holes_is_a_birth_process() -> None:
    """Electrons that alone multiply make a geometric number: F = 2 - 1/M."""
    gain = 20.0
    made = np.random.default_rng(1).geometric(1.0 / gain, 400_000).astype(float)
    excess = np.mean(made**2) / np.mean(made) ** 2
    assert excess == pytest.approx(mcintyre_excess_noise(gain=gain, ionisation_ratio=0.0), rel=0.01)


def test_dynodes_are_a_branching_of_poisson_numbers() -> None:
    chance, made = np.random.default_rng(2), np.ones(200_000, np.int64)
    for _ in range(8):
        made = chance.poisson(4.0 * made)
    excess = np.mean(made.astype(float) ** 2) / np.mean(made) ** 2
    assert excess == pytest.approx(dynode_excess_noise(4.0), rel=0.01)


@pytest.mark.parametrize("light", [0.05, 3.0, 1e6])
@pytest.mark.parametrize("pulses", [1, 7])
def test_an_apd_reads_the_light_with_its_excess_noise(light: float, pulses: int) -> None:
    detector = apd(pulses=pulses)
    counts = counts_of(detector, np.full(SHAPE, light))
    variance = pulses * light * detector.excess_noise_factor
    assert abs(counts.mean() - pulses * light) < 4.0 * np.sqrt(variance / counts.size)
    assert counts.var() == pytest.approx(variance, rel=0.1)
    even = np.full((1, 1, 5), light)
    scatter = detector.scatter(even, detector.mean(even))
    assert scatter.variance == pytest.approx(variance, rel=1e-3)


def test_amplifier_noise_in_the_dark() -> None:
    """Over T: i_n^2 T / (2 e^2 M^2), whatever the low-pass does from bin to bin."""
    density, gate = 3e-12, 40
    for bandwidth in (1e12, 300e6):
        detector = apd(amplifier_noise=density, bandwidth=bandwidth)
        counts = counts_of(detector, np.zeros((200, 200, 60)))
        sums = counts[..., 10 : 10 + gate].sum(axis=-1)
        wanted = (density / (elementary_charge * 100.0)) ** 2 * gate * NS / 2.0
        assert sums.var() == pytest.approx(wanted, rel=0.03)
        told = detector.scatter(np.zeros((1, 1, gate)), np.zeros((1, 1, gate))).added_variance.sum()
        assert told == pytest.approx(wanted)


def test_bandwidth_halves_the_power_and_keeps_the_centre() -> None:
    bandwidth, sigma = 200e6, gaussian_response(200e6)
    frequency_response = np.exp(-2.0 * (np.pi * sigma * bandwidth) ** 2)
    assert frequency_response**2 == pytest.approx(0.5)
    light = np.zeros((1, 1, 61))
    light[..., 30] = 1e4
    detector = apd(bandwidth=bandwidth)
    mean = detector.mean(light)[0, 0]
    place = np.arange(61)
    assert mean.sum() == pytest.approx(1e4)
    assert np.sum(mean * place) / 1e4 == pytest.approx(30.0)
    width = np.sqrt(np.sum(mean * (place - 30.0) ** 2) / 1e4) * NS
    assert width == pytest.approx(np.hypot(sigma, NS / np.sqrt(6.0)), rel=1e-3)
    assert np.array_equal(detector.added(light, light, light), detector.mean(light))


def test_an_amplifier_clips_and_is_blind_then() -> None:
    light = np.full((2, 2, 20), 10.0)
    light[..., 10] = 1e5
    readings = apd(full_scale=500.0, pulses=2).read(light, np.random.default_rng(1))
    assert readings.counts.max() == 1000.0
    assert readings.blind[..., 10].all()
    assert readings.blind.sum() == 4


@pytest.mark.parametrize("sigma", [0.05, 0.4, 3.0])
def test_spreading_moves_a_share_of_every_bin(sigma: float) -> None:
    """As even numbers of a bin do when a normal one is added: sigma / sqrt(2 pi) if it is small."""
    shares, reach = bin_shares(sigma), bin_shares(sigma).size // 2
    chance = np.random.default_rng(4)
    moved = np.floor(chance.random(400_000) + sigma * chance.standard_normal(400_000))
    drawn = np.array([(moved == place).mean() for place in range(-reach, reach + 1)])
    assert np.abs(shares - drawn).max() < 4.0 * np.sqrt(0.25 / 400_000)
    assert shares.sum() == pytest.approx(1.0, abs=1e-6)
    if sigma == 0.05:
        assert shares[reach + 1] == pytest.approx(sigma / np.sqrt(2.0 * np.pi))
    assert spread(np.ones(80), sigma=sigma)[20:60] == pytest.approx(1.0, abs=1e-6)


def test_a_photomultiplier_counts_up_to_1_over_rc() -> None:
    """1 / rate >= R C: counts, less those that come within R C; beyond, a current of all."""
    bins, rc = 60, 2.0 * NS
    detector = pmt(rc=rc, pulses=100)
    for rate, counted in ((1e6, True), (1e8, True), (0.499e9, True), (0.501e9, False)):
        light = np.full((20, 20, bins), rate * NS)
        counts = counts_of(detector, light)[..., 10:50]
        mean = 100.0 * rate * NS * (np.exp(-rate * rc) if counted else 1.0)
        variance = mean * (1.0 if counted else detector.excess_noise_factor)
        assert abs(counts.mean() - mean) < 4.0 * np.sqrt(variance / counts.size)
        assert counts.var() == pytest.approx(variance, rel=0.05)
        whole = np.array_equal(counts, np.round(counts))
        assert whole == counted
        told = detector.scatter(light, detector.mean(light))
        assert told.mean[..., 10:50] == pytest.approx(mean)
        assert told.variance[..., 10:50] == pytest.approx(variance)


def test_counting_loss_is_that_of_a_paralyzable_counter() -> None:
    """Counted one by one: a pulse counts when the line was quiet for R C before it."""
    rate, rc = 0.2, 3.0
    times = np.cumsum(np.random.default_rng(3).exponential(1.0 / rate, 400_000))
    resolved = np.mean(np.diff(times) >= rc) * rate
    detector = pmt(rc=rc * NS)
    told = detector.mean(np.full((1, 1, 40), rate))[0, 0, 20]
    assert told == pytest.approx(resolved, rel=0.01)


def test_light_that_turns_counts_into_a_current_is_added_as_it_reads() -> None:
    detector, light = pmt(), np.full((1, 1, 20), 0.4)
    mean = detector.mean(light)
    more = np.zeros_like(light)
    more[..., 10] = 5.0
    grown = detector.added(light, more, mean)
    assert grown == pytest.approx(detector.mean(light + more) - mean)
    assert detector.added(light, -light, mean) == pytest.approx(-mean)


def tail_of_amplified_counts(threshold: float, *, mean: float, variance: float) -> float:
    """P(R >= T) of a Poisson number of gamma gains, summed."""
    number = np.arange(1, 400)
    shares = gamma.sf(threshold, number / variance, scale=variance)
    return float(np.sum(poisson.pmf(number, mean) * shares))


def tail_of_clusters(threshold: float, *, mean: float, variance: float) -> float:
    """P(R >= T) of a Poisson number of geometric clusters, summed."""
    p = variance / (2.0 + variance)
    clusters = np.arange(1, 400)
    rest = np.ceil(threshold) - clusters
    shares = np.where(rest <= 0, 1.0, nbinom.sf(rest - 1, clusters, 1.0 - p))
    return float(np.sum(poisson.pmf(clusters, mean * (1.0 - p)) * shares))


@pytest.mark.parametrize("tail", [tail_of_amplified_counts, tail_of_clusters])
@pytest.mark.parametrize("mean", [0.05, 1.5, 30.0])
@pytest.mark.parametrize("variance", [0.1, 0.5, 3.0])
@pytest.mark.parametrize("false_alarm", [1e-3, 3e-6, 1e-9])
def test_thresholds_keep_the_false_alarm_rate_of_their_tails(
    tail: Any, mean: float, variance: float, false_alarm: float
) -> None:
    """The bound is never below the true threshold, and above the noise not twice as high."""
    noise = Scatter(
        mean=np.array([mean]), gain_variance=np.array([variance]), added_variance=np.zeros(1)
    )
    threshold = float(noise.threshold(false_alarm)[0])
    assert tail(threshold, mean=mean, variance=variance) <= false_alarm
    if mean > 1.0:
        half_way = 0.5 * (mean + threshold)
        assert tail(half_way, mean=mean, variance=variance) > false_alarm


def test_gaussian_noise_has_its_own_threshold() -> None:
    noise = Scatter(mean=np.zeros(1), gain_variance=np.zeros(1), added_variance=np.full(1, 9.0))
    for false_alarm in (1e-3, 1e-9):
        threshold = float(noise.threshold(false_alarm)[0])
        exact = 3.0 * norm.isf(false_alarm)
        assert exact < threshold < 1.25 * exact
    fires = noise.firing_probability(np.array([3.0]))
    assert fires[0] == pytest.approx(norm.sf(1.0))


def test_plain_counts_have_the_threshold_of_equation_11() -> None:
    noise = Scatter.poisson(np.array([0.3, 40.0]))
    assert noise.threshold(1e-4).tolist() == (poisson.isf(1e-4, noise.mean) + 1).tolist()

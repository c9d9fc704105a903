"""Equations (8) to (11) against decimal arithmetic of 60 digits, and their inverses."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal, getcontext
from typing import Any

import numpy as np
import pytest
from scipy.stats import poisson

from survey.sensor.photon_counting import (
    count_probability,
    firing_probability,
    firing_threshold,
    least_signal,
    photo_electron_rate,
    signal_to_noise,
)

getcontext().prec = 60
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494")
MEANS = [1e-6, 1e-3, 0.3, 1.0, 17.5, 1e3, 1e6, 1e9]


def exact_probability(count: int, mean: float) -> float:
    """Equation (9) as printed; n! by Stirling's series where it is long."""
    n, m = Decimal(count), Decimal(mean)
    if count < 200:
        logarithm = sum((Decimal(k).ln() for k in range(2, count + 1)), Decimal(0))
    else:
        series = 1 / (12 * n) - 1 / (360 * n**3) + 1 / (1260 * n**5) - 1 / (1680 * n**7)
        series += 1 / (1188 * n**9) - Decimal(691) / (360360 * n**11)
        logarithm = n * n.ln() - n + (2 * PI * n).ln() / 2 + series
    return float((n * m.ln() - m - logarithm).exp())


@pytest.mark.parametrize("mean", MEANS)
def test_probability_of_a_count_is_exact(mean: float) -> None:
    deviations = np.array([-6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 6.0])
    for count in {max(0, round(mean + k * mean**0.5)) for k in deviations} | {0, 1, 2, 30}:
        wanted = exact_probability(count, mean)
        got = count_probability(count=count, mean=mean)
        assert got == pytest.approx(wanted, rel=3e-11, abs=1e-300), (count, mean)


def test_probabilities_of_all_counts_sum_to_one() -> None:
    for mean in (1e-6, 0.3, 17.5, 1e4):
        total = count_probability(count=np.arange(int(mean + 12 * mean**0.5) + 20), mean=mean)
        assert total.sum() == pytest.approx(1.0, abs=1e-12)
    assert count_probability(count=np.array([0, 1, 5]), mean=0.0).tolist() == [1.0, 0.0, 0.0]


@pytest.mark.parametrize("mean", MEANS)
def test_probability_of_firing_is_what_equation_9_leaves(mean: float) -> None:
    """Sum the rarer side of equation (9): from the threshold up, or below it."""
    deviations = (-4.0, 0.5, 4.0, 5.0, 9.0)
    for threshold in {max(1, round(mean + k * mean**0.5)) for k in deviations} | {1, 3}:
        above = threshold > mean
        reach = int(12.0 * mean**0.5) + 40
        low = threshold if above else max(0, threshold - reach)
        counts = np.arange(low, threshold + reach if above else threshold)
        side = count_probability(count=counts, mean=mean).sum()
        got = firing_probability(threshold=threshold, mean=mean)
        assert got == pytest.approx(side if above else 1.0 - side, rel=1e-8)


@pytest.mark.parametrize("false_alarm", [0.5, 1e-3, 1e-9, 1e-15, 1e-100])
def test_threshold_is_the_least_that_noise_reaches_seldom_enough(false_alarm: float) -> None:
    noise = np.concatenate([[0.0], np.geomspace(1e-6, 1e9, 61)])
    threshold = firing_threshold(false_alarm=false_alarm, noise=noise)
    assert np.all(threshold == np.round(threshold))
    assert np.all(firing_probability(threshold=threshold, mean=noise) <= false_alarm)
    more = threshold > 1
    one_less = firing_probability(threshold=threshold[more] - 1, mean=noise[more])
    assert np.all(one_less > false_alarm)


def test_thresholds_keep_the_shape_of_the_noise() -> None:
    noise = np.array([[0.1, 5.0], [5.0, 40.0]])
    wanted = poisson.isf(1e-4, noise) + 1
    assert np.array_equal(firing_threshold(false_alarm=1e-4, noise=noise), wanted)


@pytest.mark.parametrize("probability", [1e-7, 0.01, 0.5, 0.9, 0.9999])
def test_least_signal_fires_with_the_probability_asked_for(probability: float) -> None:
    threshold = np.array([1.0, 2.0, 10.0, 1e4, 1e7, 1e9])
    signal = least_signal(probability=probability, threshold=threshold, noise=1e-9)
    fires = firing_probability(threshold=threshold, mean=signal + 1e-9)
    assert fires == pytest.approx(probability, rel=1e-6)
    assert least_signal(probability=0.01, threshold=2, noise=50.0) == 0.0


def test_rate_and_signal_to_noise_are_as_printed() -> None:
    photon = 6.62607015e-34 * 299_792_458.0 / 532e-9
    rate = photo_electron_rate(power=1e-9, quantum_efficiency=0.3, photon_energy=photon)
    assert rate == pytest.approx(0.3e-9 / photon, rel=1e-15)
    ratio = signal_to_noise(signal=3e8, background=np.array([0.0, 5e8]), internal=1e8, time=1e-8)
    assert ratio == pytest.approx([9e16 * 1e-8 / 4e8, 9e16 * 1e-8 / 9e8])
    amplitude = 3e8 * 1e-8 / np.sqrt(4e8 * 1e-8)
    assert ratio[0] == pytest.approx(amplitude**2)


RATES = {"signal": 1.0, "background": 1.0, "internal": 1.0, "time": 1.0}


@pytest.mark.parametrize(
    ("function", "arguments", "fault"),
    [
        (firing_probability, {"threshold": 0.5, "mean": 1.0}, "threshold is below 1"),
        (firing_probability, {"threshold": 1, "mean": -1.0}, "mean is below 0"),
        (firing_threshold, {"false_alarm": 0.0, "noise": 1.0}, "false_alarm is not above 0"),
        (firing_threshold, {"false_alarm": 1e-3, "noise": -1.0}, "noise is below 0"),
        (firing_threshold, {"false_alarm": 1e-3, "noise": np.nan}, "noise is below 0"),
        (least_signal, {"probability": 1.0, "threshold": 1}, "probability is not above 0"),
        (least_signal, {"probability": 0.5, "threshold": 0}, "threshold is below 1"),
        (count_probability, {"count": -1, "mean": 1.0}, "count is below 0"),
        (signal_to_noise, RATES | {"background": -1.0}, "a rate is below 0"),
        (signal_to_noise, dict.fromkeys(RATES, 0.0) | {"time": 1.0}, "neither signal nor noise"),
        (signal_to_noise, RATES | {"time": 0.0}, "time is not above 0"),
        (
            photo_electron_rate,
            {"power": 1.0, "quantum_efficiency": 1.1, "photon_energy": 1.0},
            "quantum_efficiency is not above 0 and at most 1",
        ),
        (
            photo_electron_rate,
            {"power": -1.0, "quantum_efficiency": 0.5, "photon_energy": 1.0},
            "power is below 0 W",
        ),
    ],
)
def test_what_cannot_be_is_refused(
    function: Callable[..., Any], arguments: dict[str, Any], fault: str
) -> None:
    with pytest.raises(ValueError, match=fault):
        function(**arguments)

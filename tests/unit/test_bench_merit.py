"""The comparison of two engines by repeated flashes, from flashes of known scatter."""

from __future__ import annotations

import numpy as np
import pytest

from survey.bench_merit import Replicates, compared

EXPECTED = np.array([50.0, 100.0, 200.0])


def flashes(*, error, seconds, seed, bias=1.0):
    """Thirty flashes of three pixels of that relative error each, one apart from the other."""
    noise = np.random.default_rng(seed).normal(size=(30, 3))
    return Replicates(EXPECTED * (bias + error * noise), seconds)


def test_known_errors_give_the_known_ratio():
    """Errors 1:10 and times 1:20 make 2,000; 30 flashes each tell it to about a factor of two."""
    found = compared(
        fast=flashes(error=0.005, seconds=1.0, seed=1),
        textbook=flashes(error=0.05, seconds=20.0, seed=2),
        expected=EXPECTED,
    )
    parts = found["figure_of_merit"]
    assert found["figure_of_merit_ratio"] == pytest.approx(2000.0, rel=0.6)
    assert parts["per_pixel_ratio"] == pytest.approx(2000.0, rel=0.4)
    assert parts["fast"]["error_per_pixel"] == pytest.approx(0.005, rel=0.2)
    weights = EXPECTED / EXPECTED.sum()
    assert parts["textbook"]["error"] == pytest.approx(0.05 * np.linalg.norm(weights), rel=0.4)
    assert parts["textbook"]["answer"] == pytest.approx(EXPECTED.sum(), rel=0.03)


def test_the_lower_bound_is_below_the_truth_as_often_as_it_says():
    """In 200 repetitions the bound of 97.5 % exceeds the true ratio in at most 7.5 %."""
    above = 0
    for seed in range(200):
        found = compared(
            fast=flashes(error=0.005, seconds=1.0, seed=2 * seed),
            textbook=flashes(error=0.05, seconds=20.0, seed=2 * seed + 1),
            expected=EXPECTED,
        )
        above += found["figure_of_merit"]["pooled_ratio_lower_95"] > 2000.0
    assert above <= 15


@pytest.mark.parametrize(("error", "bias"), [(0.3, 1.0), (0.05, 1.1)])
def test_no_verdict(error, bias):
    """A textbook error of 17 % (pooled), or answers 10 % apart, say nothing."""
    found = compared(
        fast=flashes(error=0.005, seconds=1.0, seed=3),
        textbook=flashes(error=error, seconds=20.0, seed=4, bias=bias),
        expected=EXPECTED,
    )
    assert found["figure_of_merit_ratio"] is None
    assert found["figure_of_merit_ratio_lower_95"] is None
    assert found["figure_of_merit"]["pooled_ratio"] > 0.0

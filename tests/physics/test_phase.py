"""Phase functions: integral, mean cosine, sampler against density."""

from __future__ import annotations

import numpy as np
import pytest

from survey.optics.phase import henyey_greenstein, petzold, petzold_scattering

FUNCTIONS = [petzold("clear"), petzold("coastal"), petzold("harbor"), henyey_greenstein(0.75)]


@pytest.mark.parametrize("phase", FUNCTIONS, ids=lambda phase: phase.name)
def test_integrates_to_one(phase):
    """By a quadrature of its own: logarithmic in the angle down to 1e-9 rad."""
    angle = np.geomspace(1e-9, np.pi, 400_000)
    inside = np.trapezoid(2 * np.pi * phase.density(angle) * np.sin(angle), angle)
    assert inside == pytest.approx(1.0, abs=2e-4)


@pytest.mark.parametrize(
    ("water", "scattering", "mean_cosine", "backscatter"),
    [
        ("clear", 0.0372, 0.8715, 0.0442),
        ("coastal", 0.2189, 0.9470, 0.0134),
        ("harbor", 1.821, 0.9198, 0.0200),
    ],
)
def test_petzold_integrals(water, scattering, mean_cosine, backscatter):
    """The three integrals that the tables' source gives."""
    phase = petzold(water)
    assert petzold_scattering(water) == pytest.approx(scattering, rel=1e-3)
    assert phase.mean_cosine == pytest.approx(mean_cosine, abs=1e-4)
    assert phase.backscatter_fraction == pytest.approx(backscatter, abs=1e-4)


@pytest.mark.parametrize("phase", FUNCTIONS, ids=lambda phase: phase.name)
def test_sampler_follows_the_density(phase):
    """Shares of the sampler within cones equal the integral of the density to 1e-4."""
    table = phase.sampler_table()
    uniform = (np.arange(2_000_000) + 0.5) / 2_000_000
    place = uniform * (len(table) - 1)
    low = place.astype(int)
    one_minus_cos = table[low] + (place - low) * (table[low + 1] - table[low])
    assert np.all((one_minus_cos >= 0.0) & (one_minus_cos <= 2.0))
    for degrees in (0.05, 0.1, 0.5, 2.0, 10.0, 30.0, 90.0, 150.0, 175.0):
        cone = 2.0 * np.sin(0.5 * np.radians(degrees)) ** 2
        share = np.mean(one_minus_cos <= cone)
        grid = np.geomspace(1e-9, np.radians(degrees), 100_000)
        integral = np.trapezoid(2 * np.pi * phase.density(grid) * np.sin(grid), grid)
        assert share == pytest.approx(integral, abs=2.5e-4)
    assert 1.0 - one_minus_cos.mean() == pytest.approx(phase.mean_cosine, abs=1e-5)


def test_cosine_table_holds_the_wide_angles():
    phase = petzold("coastal")
    table = phase.cosine_table()
    for degrees in (20.0, 31.0, 47.0, 90.0, 135.0, 179.0):
        at = 0.5 * (np.cos(np.radians(degrees)) + 1.0) * (len(table) - 1)
        value = np.interp(at, np.arange(len(table)), table)
        assert value == pytest.approx(float(phase.density(np.radians(degrees))), rel=2e-3)

"""Phase functions: integral, mean cosine, backscatter, sampler against density, extremes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2

from survey.optics.phase import (
    average_particle,
    fournier_forand,
    fournier_forand_of_backscatter,
    henyey_greenstein,
    mixture,
    molecular,
    petzold,
    petzold_scattering,
    tabled_phase_function,
    two_term_henyey_greenstein,
)
from survey.optics.phase.fournier_forand import closed_backscatter_fraction
from survey.transport.directions import drawn

TWO_TERM = {"forward_share": 0.97, "forward_asymmetry": 0.93, "backward_asymmetry": -0.4}
FUNCTIONS = [
    petzold("clear"),
    petzold("coastal"),
    petzold("harbor"),
    average_particle(),
    average_particle("mobley 1993"),
    fournier_forand(particle_index=1.10, size_slope=3.5835),
    fournier_forand_of_backscatter(0.0442),
    molecular(),
    molecular(0.09),
    henyey_greenstein(0.0),
    henyey_greenstein(0.75),
    two_term_henyey_greenstein(**TWO_TERM),
    mixture([(average_particle(), 0.2), (molecular(), 0.002)]),
    tabled_phase_function(name="table", angle=[0.0, 0.2, 1.0, np.pi], value=[9.0, 5.0, 1.0, 2.0]),
]
EXTREMES = [
    henyey_greenstein(0.99999),
    henyey_greenstein(-0.98),
    two_term_henyey_greenstein(forward_share=0.0, forward_asymmetry=0.9, backward_asymmetry=-0.9),
    two_term_henyey_greenstein(forward_share=1.0, forward_asymmetry=0.999, backward_asymmetry=0.0),
    fournier_forand(particle_index=1.001, size_slope=3.01),
    fournier_forand(particle_index=1.001, size_slope=4.99),
    fournier_forand(particle_index=1.35, size_slope=3.01),
    fournier_forand(particle_index=1.35, size_slope=4.99),
    molecular(0.0),
    molecular(1.0),
    mixture([(petzold("coastal"), 1e-12), (molecular(), 1.0), (henyey_greenstein(0.999), 0.0)]),
    tabled_phase_function(
        name="steep", angle=[0.1, np.pi], value=[1e300, 1e-5], small_angle_slope=0.0
    ),
]
by_name = pytest.mark.parametrize("phase", FUNCTIONS, ids=lambda phase: phase.name)
extreme_too = pytest.mark.parametrize("phase", FUNCTIONS + EXTREMES, ids=lambda phase: phase.name)


def integral(phase, low, high, weight=lambda angle: 1.0):
    """Integrate over solid angle by a quadrature of its own, logarithmic in the angle."""
    angle = np.geomspace(low, high, 400_000)
    values = 2.0 * np.pi * phase.density(angle) * np.sin(angle) * weight(angle)
    return float(np.trapezoid(values, angle))


@by_name
def test_integrates_to_one(phase):
    assert integral(phase, 1e-12, np.pi) == pytest.approx(1.0, abs=1e-4)


@by_name
def test_moments_agree_with_quadrature(phase):
    """Mean cosine and backscatter fraction to 1e-5, beside the integral's own error."""
    whole = integral(phase, 1e-12, np.pi)
    assert integral(phase, 1e-12, np.pi, np.cos) / whole == pytest.approx(
        phase.mean_cosine, abs=1e-4
    )
    assert integral(phase, 0.5 * np.pi, np.pi) == pytest.approx(
        phase.backscatter_fraction, abs=1e-5
    )


@pytest.mark.parametrize("angle", [1e-8, 1e-6, 1e-4, 0.1])
@by_name
def test_light_within_a_cone(phase, angle):
    """Below the grid of angles too, where the power law goes on: to 2 % (flat below 1e-12)."""
    assert phase.fraction_within(angle) == pytest.approx(
        integral(phase, 1e-40, angle), rel=0.02, abs=1e-30
    )


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


@pytest.mark.parametrize(
    ("edition", "angle", "tabled"),
    [
        ("web book", 0.1, 1772.0),
        ("web book", 0.50119, 201.8),
        ("web book", 90.0, 4.305e-3),
        ("web book", 180.0, 3.163e-3),
        ("mobley 1993", 0.50119, 218.839),
        ("mobley 1993", 90.0, 4.29232e-3),
    ],
)
def test_average_particle(edition, angle, tabled):
    """The tables integrate to 0.993-0.994 and are raised by as much; b_b / b = 0.0183."""
    phase = average_particle(edition)
    assert tabled / float(phase.density(np.radians(angle))) == pytest.approx(0.9935, abs=7e-4)
    assert phase.backscatter_fraction == pytest.approx(0.0183, abs=1e-4)


@pytest.mark.parametrize("index", [1.02, 1.0905, 1.1549, 1.3])
@pytest.mark.parametrize("slope", [3.05, 3.5, 3.9, 4.6])
def test_fournier_forand_is_what_was_published(index, slope):
    """Normalised by itself, and its backscatter is that of the closed form: to 2e-6."""
    phase = fournier_forand(particle_index=index, size_slope=slope)
    s, d = 0.5, 2.0 / (3.0 * (index - 1.0) ** 2)
    nu, d180 = 0.5 * (3.0 - slope), 2.0 * d
    bracket = nu * (1 - d) - (1 - d**nu) + (d * (1 - d**nu) - nu * (1 - d)) / s
    published = bracket / (4 * np.pi * (1 - d) ** 2 * d**nu)
    published -= (1 - d180**nu) / (16 * np.pi * (d180 - 1) * d180**nu)
    assert float(phase.density(0.5 * np.pi)) == pytest.approx(published, rel=1e-5)
    closed = closed_backscatter_fraction(particle_index=index, size_slope=slope)
    assert phase.backscatter_fraction == pytest.approx(closed, rel=2e-6)


def test_fournier_forand_where_d_is_one():
    """The formula is 0 / 0 there; the density runs through smoothly."""
    angle = henyey_greenstein(0.0).angle
    place = 7000
    index = 1.0 + np.sqrt(4.0 / 3.0) * np.sin(0.5 * angle[place])
    phase = fournier_forand(particle_index=float(index), size_slope=3.5835)
    steps = np.diff(np.log(phase.density_on_grid[place - 50 : place + 51]))
    assert np.all(np.abs(np.diff(steps)) < 0.01 * np.abs(steps).mean())


@pytest.mark.parametrize(
    ("water", "backscatter", "index", "slope", "share_at_180"),
    [
        ("clear", 0.0442, 1.1328, 3.797, 0.55),
        ("coastal", 0.0134, 1.0905, 3.522, 0.44),
        ("harbor", 0.0200, 1.1028, 3.602, 1.00),
    ],
)
def test_fournier_forand_of_petzold_backscatter(water, backscatter, index, slope, share_at_180):
    """The one-parameter family: index, slope and P(180 deg) over the table's."""
    phase = fournier_forand_of_backscatter(backscatter)
    assert phase.backscatter_fraction == pytest.approx(backscatter, rel=1e-5)
    found = [float(part.split("=")[1]) for part in phase.name.split(",")]
    assert found == [pytest.approx(index, abs=1.5e-4), pytest.approx(slope, abs=5e-4)]
    ratio = float(phase.density(np.pi) / petzold(water).density(np.pi))
    assert ratio == pytest.approx(share_at_180, abs=0.006)


def test_molecules_of_sea_water():
    """b = (8 pi / 3) beta90 (2 + d) / (1 + d) and beta(0) = beta90 2 / (1 + d)."""
    for d in (0.0, 0.039, 0.09):
        phase = molecular(d)
        at_90 = float(phase.density(0.5 * np.pi))
        assert 8 * np.pi / 3 * at_90 * (2 + d) / (1 + d) == pytest.approx(1.0, rel=1e-6)
        assert float(phase.density(0.0)) == pytest.approx(2 * at_90 / (1 + d), rel=1e-6)
        assert phase.mean_cosine == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("g", [-0.98, -0.75, 0.0, 0.25, 0.9, 0.999, 0.99999])
def test_henyey_greenstein_moments(g):
    """Mean cosine g; backscatter (1 - g) / (2 g) [(1 + g) / sqrt(1 + g^2) - 1]: to 2e-6."""
    phase = henyey_greenstein(g)
    assert phase.mean_cosine == pytest.approx(g, abs=2e-6)
    closed = (1 - g) / (2 * g) * ((1 + g) / np.sqrt(1 + g * g) - 1) if g else 0.5
    assert phase.backscatter_fraction == pytest.approx(closed, abs=2e-6)


def test_two_terms_add():
    phase = two_term_henyey_greenstein(**TWO_TERM)
    assert phase.mean_cosine == pytest.approx(0.97 * 0.93 - 0.03 * 0.4, abs=1e-6)
    parts = 0.97 * henyey_greenstein(0.93).density(2.5) + 0.03 * henyey_greenstein(-0.4).density(
        2.5
    )
    assert float(phase.density(2.5)) == pytest.approx(float(parts), rel=1e-5)


def test_mixture_weighs_by_scattering():
    """Moments and cores are the weighted means, in whatever order and unit."""
    parts = [(petzold("coastal"), 0.3), (petzold("clear"), 0.1), (molecular(), 0.1)]
    phase = mixture(parts)
    for name in ("mean_cosine", "backscatter_fraction"):
        expected = sum(b * getattr(part, name) for part, b in parts) / 0.5
        assert getattr(phase, name) == pytest.approx(expected, abs=1e-6)
    for angle in (1e-7, 1e-6, 1e-3, 0.3, np.pi):
        expected = sum(b * part.fraction_within(angle) for part, b in parts) / 0.5
        assert phase.fraction_within(angle) == pytest.approx(expected, rel=0.02)
    scaled = mixture([(part, 1e3 * b) for part, b in reversed(parts)])
    assert np.allclose(scaled.density_on_grid, phase.density_on_grid, rtol=1e-12)


@by_name
def test_sampler_follows_the_density(phase):
    """Shares of the sampler within cones equal the integral of the density to 2.5e-4."""
    one_minus_cos = sampled(phase, (np.arange(2_000_000) + 0.5) / 2_000_000)
    assert np.all((one_minus_cos >= 0.0) & (one_minus_cos <= 2.0))
    for degrees in (0.05, 0.1, 0.5, 2.0, 10.0, 30.0, 90.0, 150.0, 175.0):
        cone = 2.0 * np.sin(0.5 * np.radians(degrees)) ** 2
        share = np.mean(one_minus_cos <= cone)
        assert share == pytest.approx(integral(phase, 1e-12, np.radians(degrees)), abs=2.5e-4)
    assert 1.0 - one_minus_cos.mean() == pytest.approx(phase.mean_cosine, abs=1e-5)


@by_name
def test_sampled_angles_pass_chi_square(phase):
    """100,000 angles in 40 cells of equal share; false alarms 1e-4 a function, seed fixed."""
    draws, cells = 100_000, 40
    one_minus_cos = sampled(phase, np.random.default_rng(7).random(draws))
    edges = np.interp(np.linspace(0.0, 1.0, cells + 1)[1:-1], phase.cumulative_on_grid, phase.angle)
    counts = np.bincount(
        np.searchsorted(2.0 * np.sin(0.5 * edges) ** 2, one_minus_cos), minlength=cells
    )
    # Where the first grid angle holds more than a cell, the cells are uneven: use their true share.
    share = np.diff([0.0, *(phase.fraction_within(edge) for edge in edges), 1.0]) * draws
    assert share.min() > 100.0
    assert np.sum((counts - share) ** 2 / share) < chi2.ppf(1.0 - 1e-4, cells - 1)


@extreme_too
def test_ends_of_the_sampler(phase):
    """Numbers 0 and 1 - 2^-53 and all angles give numbers, the density is never negative."""
    table = phase.sampler_table()
    assert np.all(np.isfinite(table))
    assert np.all(np.diff(table) >= 0.0)
    assert table[0] == pytest.approx(0.0, abs=1e-12)
    assert table[-1] == pytest.approx(2.0)
    ends = sampled(phase, np.array([0.0, 2.0**-53, 0.5, 1.0 - 2.0**-53]))
    assert np.all((ends >= 0.0) & (ends <= 2.0))
    density = phase.density(np.concatenate([[0.0, np.pi], np.geomspace(1e-12, np.pi, 1001)]))
    assert np.all(np.isfinite(density) & (density >= 0.0))
    assert 0.0 <= phase.backscatter_fraction <= 1.0 + 1e-12
    assert abs(phase.mean_cosine) <= 1.0


@pytest.mark.parametrize(("g", "forward"), [(0.99999, True), (-0.98, False)])
def test_orientation(g, forward):
    """A forward peak sends nearly all forward, a backward one back."""
    share = np.mean(sampled(henyey_greenstein(g), (np.arange(10_000) + 0.5) / 10_000) < 1.0)
    assert share > 0.99 if forward else share < 0.01


def test_kernel_draws_what_the_table_says():
    """The compiled draw over a real stream gives the mean cosine within five standard errors."""
    phase = petzold("harbor")
    table, state = phase.sampler_table(), np.array([12345, 67891], np.uint64)
    cosines = np.array([1.0 - drawn(table, 1.0, state) for _ in range(20_000)])
    error = cosines.std() / np.sqrt(len(cosines))
    assert abs(cosines.mean() - phase.mean_cosine) < 5.0 * error


def test_cosine_table_holds_the_wide_angles():
    phase = petzold("coastal")
    table = phase.cosine_table()
    for degrees in (20.0, 31.0, 47.0, 90.0, 135.0, 179.0):
        at = 0.5 * (np.cos(np.radians(degrees)) + 1.0) * (len(table) - 1)
        value = np.interp(at, np.arange(len(table)), table)
        assert value == pytest.approx(float(phase.density(np.radians(degrees))), rel=2e-3)


def sampled(phase, uniform):
    """Return 1 - cos as the kernels draw it from uniform numbers."""
    table = phase.sampler_table()
    place = uniform * (len(table) - 1)
    low = place.astype(int)
    return table[low] + (place - low) * (table[low + 1] - table[low])

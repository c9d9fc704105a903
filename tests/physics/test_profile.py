"""Light at depths against the model comparison of Mobley et al. 1993, and what holds exactly."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.special import expn

from survey.optics.phase import average_particle, henyey_greenstein, molecular, petzold
from survey.optics.water import PAPER_COEFFICIENTS
from survey.transport.profile import cone_average, light_profile

# 99.9 % two-sided, 63 degrees of freedom.
QUANTILE = 3.45
PUBLISHED = Path(__file__).parent / "data" / "mobley1993_benchmarks.csv"
QUANTITIES = {"Ed": "downward", "Eou": "upward_scalar", "Lu": "upward_radiance"}
DEPTHS = (1.0, 5.0, 10.0)


def published(problem, albedo):
    """Return {(quantity, depth): (mean of the models, coefficient of variation)}."""
    with PUBLISHED.open() as file:
        return {
            (row["quantity"], float(row["optical_depth_tau"])): (
                float(row["mean_of_models"]),
                float(row["cv"]),
            )
            for row in csv.DictReader(file)
            if int(row["problem"]) == problem and float(row["omega0"]) == albedo
        }


def computed(problem, albedo, walks, **bottom):
    """Set the problem up: sun at 60 degrees, black sky, E_d in air 0.5, flat surface n = 1.34."""
    return light_profile(
        depths=DEPTHS[:2] if bottom else DEPTHS,
        albedo=albedo,
        phase_function=molecular(0.0) if problem == 1 else average_particle("mobley 1993"),
        irradiance=0.5,
        index=1.34,
        cos_incidence=0.5,
        walks=walks,
        **bottom,
    )


def misses(profile, problem, albedo, tolerance_of):
    """Name the numbers whose 99.9 % interval does not lie within the tolerance."""
    missed = []
    for (quantity, depth), (mean, variation) in published(problem, albedo).items():
        k = list(profile.depth).index(depth)
        value = getattr(profile, QUANTITIES[quantity])[k]
        error = getattr(profile, f"{QUANTITIES[quantity]}_error")[k]
        off = (abs(value - mean) + QUANTILE * error) / mean
        if off > tolerance_of(quantity, variation):
            missed.append(f"{quantity} at {depth:g}: {value:.4g} against {mean:.4g}, {off:.1%}")
    return missed


@pytest.mark.parametrize("problem", [1, 2])
def test_mobley_1993(problem):
    """Albedo 0.9: E_d within 3 %, E_ou within 8 %, L_u within 25 % of the models' mean.

    The models' own coefficients of variation reach 1.5, 3.8 and 10.9 %.
    """
    tolerances = {"Ed": 0.03, "Eou": 0.08, "Lu": 0.25}
    profile = computed(problem, 0.9, 960_000)
    assert misses(profile, problem, 0.9, lambda quantity, _: tolerances[quantity]) == []


@pytest.mark.slow
@pytest.mark.parametrize("albedo", [0.2, 0.9])
@pytest.mark.parametrize("problem", [1, 2])
def test_mobley_1993_all_numbers(problem, albedo):
    """All 36 numbers within twice the models' coefficient of variation, or 3 % where that is more.

    Largest deviation of E_d: 1.3 % at optical depth 10 of problem 2.
    """
    profile = computed(problem, albedo, 64_000_000 if albedo == 0.2 else 16_000_000)
    assert misses(profile, problem, albedo, lambda _, cv: max(0.03, 2.0 * cv)) == []


def test_mobley_1993_over_a_bottom():
    """Problem 6, albedo 0.2, reflectance 0.5 at depth 5: E_d 2 %, E_ou 6 %, L_u 10 %.

    On the bottom E_ou = 2 R E_d and L_u = R E_d / pi; the cone's average makes no difference.
    """
    tolerances = {"Ed": 0.02, "Eou": 0.06, "Lu": 0.1}
    profile = computed(6, 0.2, 8_000_000, bottom_depth=5.0, bottom_reflectance=0.5)
    assert misses(profile, 6, 0.2, lambda quantity, _: tolerances[quantity]) == []
    assert profile.upward_scalar[1] == pytest.approx(profile.downward[1], rel=0.01)
    assert profile.upward_radiance[1] == pytest.approx(0.5 * profile.downward[1] / math.pi)


def test_without_scattering():
    """(1 - R) exp(-tau / cos) of Fresnel and Snell, the same in every photon: to 1e-6."""
    profile = light_profile(
        depths=[0.5, 4.0], albedo=1e-12, phase_function=molecular(), cos_incidence=0.5, walks=128
    )
    cosine = math.sqrt(1.0 - 0.75 / 1.34**2)
    parallel = (1.34 * 0.5 - cosine) / (1.34 * 0.5 + cosine)
    across = (0.5 - 1.34 * cosine) / (0.5 + 1.34 * cosine)
    through = 1.0 - 0.5 * (parallel**2 + across**2)
    expected = through * np.exp(-profile.depth / cosine)
    assert profile.downward == pytest.approx(expected, rel=1e-6)
    assert np.all(profile.upward_scalar == 0.0)


def test_white_bottom_under_absorbing_water():
    """No scattering, no surface, a white bottom at tau = 14, seen from 0.1: within 3 %.

    L_u = exp(-27.9) / pi and E_ou = 2 exp(-14) E2(13.9), E2 the exponential integral of order 2;
    all of it has come through the roulette of light weights.
    """
    profile = light_profile(
        depths=[0.1],
        albedo=1e-12,
        phase_function=molecular(),
        index=1.0,
        bottom_depth=14.0,
        bottom_reflectance=1.0,
        walks=2_560_000,
    )
    assert profile.downward[0] == pytest.approx(math.exp(-0.1), rel=1e-9)
    radiance = math.exp(-27.9) / math.pi
    scalar = 2.0 * math.exp(-14.0) * float(expn(2, 13.9))
    for name, expected in (("upward_radiance", radiance), ("upward_scalar", scalar)):
        value, error = getattr(profile, name)[0], getattr(profile, f"{name}_error")[0]
        assert abs(value - expected) + QUANTILE * error <= 0.03 * expected


@pytest.mark.parametrize(
    ("water", "depths", "low", "high"),
    [
        ("clear", [5.0, 10.0, 20.0, 30.0], 0.118, 0.121),
        ("coastal", [1.0, 2.0, 5.0, 10.0, 15.0, 20.0], 0.186, 0.199),
        ("harbor", [0.5, 1.0, 2.0, 3.0], 0.44, 0.53),
    ],
)
def test_diffuse_attenuation(water, depths, low, high):
    """K_d [1/m], sun at the zenith, of each layer: within the known range, 1 % beside it.

    The range is that of an independent Monte Carlo with the same tables; K_d grows with depth and
    lies between a and c.
    """
    absorption, scattering = PAPER_COEFFICIENTS[water]
    attenuation = absorption + scattering
    profile = light_profile(
        depths=attenuation * np.array(depths),
        albedo=scattering / attenuation,
        phase_function=petzold(water),
        walks=320_000,
    )
    found = profile.diffuse_attenuation * attenuation
    assert np.all(found >= 0.99 * low)
    assert np.all(found <= 1.01 * high)
    assert np.all(np.diff(found) > 0.0)


def test_cone_average():
    """The average over a cone integrates to one, is the function where that is smooth."""
    phase = petzold("coastal")
    average = cone_average(phase_function=phase, half_angle=math.radians(3.0))
    angle = np.linspace(0.0, np.pi, len(average))
    assert np.trapezoid(2 * np.pi * average * np.sin(angle), angle) == pytest.approx(1, abs=0.004)
    assert np.interp(1.5, angle, average) == pytest.approx(float(phase.density(1.5)), rel=5e-3)
    ahead = phase.fraction_within(math.radians(3.0)) / (2 * np.pi * (1 - math.cos(math.radians(3))))
    assert average[0] == pytest.approx(ahead, rel=2e-3)


def test_faults_come_all_at_once():
    with pytest.raises(ValueError, match=r"depths must be above 0.*albedo.*bottom_reflectance"):
        light_profile(
            depths=[0.0],
            albedo=100.0,
            phase_function=henyey_greenstein(0.0),
            bottom_reflectance=-0.1,
        )
    with pytest.raises(ValueError, match="half_angle"):
        light_profile(depths=[1.0], albedo=0.5, phase_function=molecular(), cone=0.0)
    with pytest.raises(ValueError, match="no bottom"):
        light_profile(depths=[1.0], albedo=1.0, phase_function=molecular())

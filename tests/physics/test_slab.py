"""The plain slab against published slabs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.constants import speed_of_light
from scipy.special import expn

from survey.optics.phase import henyey_greenstein, molecular, petzold
from survey.transport.slab import slab

# 99.9 % two-sided, 63 degrees of freedom.
QUANTILE = 3.45
# Optics, and what was published: reflectance and, if there is any, transmittance.
PUBLISHED = {
    "van de Hulst (1980)": (
        {"optical_thickness": 2.0, "albedo": 0.9, "phase_function": henyey_greenstein(0.75)},
        (0.09739, 0.66096),
    ),
    "isotropic, conservative": (
        {"optical_thickness": 1.0, "albedo": 1.0, "phase_function": henyey_greenstein(0.0)},
        (0.34133, 0.65867),
    ),
    "Giovanelli (1955)": (
        {
            "optical_thickness": math.inf,
            "albedo": 0.9,
            "phase_function": henyey_greenstein(0.0),
            "index": 1.5,
        },
        (0.2600,),
    ),
}


def is_equivalent(value: float, error: float, published: float, tolerance: float) -> bool:
    """Tell whether the whole 99.9 % interval lies within a relative tolerance."""
    return abs(value - published) + QUANTILE * error <= tolerance * published


def test_van_de_hulst_slab():
    """Albedo 0.9, g = 0.75, thickness 2: R = 0.09739, T = 0.66096 (van de Hulst 1980).

    Tolerance 0.6 % and 0.2 %; 16 M walks put the standard error at 0.08 % and 0.01 %.
    """
    optics, (reflected, transmitted) = PUBLISHED["van de Hulst (1980)"]
    result = slab(**optics, walks=16_000_000)
    assert is_equivalent(result.reflectance, result.reflectance_error, reflected, 0.006)
    assert is_equivalent(result.transmittance, result.transmittance_error, transmitted, 0.002)


def test_conservative_isotropic_slab():
    """Thickness 1, normal incidence: R = 0.34133, T = 0.65867; nothing is lost."""
    optics, (reflected, _) = PUBLISHED["isotropic, conservative"]
    result = slab(**optics, walks=6_400_000)
    assert is_equivalent(result.reflectance, result.reflectance_error, reflected, 0.004)
    assert result.reflectance + result.transmittance == pytest.approx(1.0, abs=1e-12)


def test_giovanelli_half_space():
    """Albedo 0.9, isotropic, index 1.5: R = 0.2600 with the mirror part (Giovanelli 1955)."""
    optics, (reflected,) = PUBLISHED["Giovanelli (1955)"]
    result = slab(**optics, walks=3_200_000)
    assert is_equivalent(result.reflectance, result.reflectance_error, reflected, 0.005)


def test_white_bottom_returns_all_light():
    """A furnace: nothing absorbs, the bottom is white, hence all light comes back."""
    result = slab(
        optical_thickness=3.0,
        albedo=1.0,
        phase_function=petzold("coastal"),
        index=1.34,
        bottom_reflectance=1.0,
        walks=64_000,
    )
    assert result.reflectance == pytest.approx(1.0, abs=1e-12)
    assert result.time_resolved.sum() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("phase", "share"),
    [(henyey_greenstein(0.0), 0.5 * (1.0 - math.log(2.0))), (molecular(0.0), None)],
    ids=["isotropic", "Rayleigh"],
)
def test_single_scattering_in_time(phase, share):
    """R(s) = w exp(-s) times the integral over m of 2 pi P(-m) m / (1 + m), s the path inside.

    Light goes down to s m / (1 + m), is turned once and leaves at cosine m. With 0.2 % albedo the
    second order is below 0.2 %; each of four times within 2 %, which holds R(t)'s shape.
    """
    if share is None:
        share = 3.0 / 8.0 * (11.0 / 6.0 - 2.0 * math.log(2.0))
    result = slab(
        optical_thickness=math.inf,
        albedo=0.002,
        phase_function=phase,
        walks=6_400_000,
        path_bin=0.5,
    )
    for k in range(4):
        expected = 0.002 * share * (math.exp(-0.5 * k) - math.exp(-0.5 * (k + 1)))
        found, error = result.time_resolved[k], result.time_resolved_error[k]
        assert is_equivalent(float(found), float(error), expected, 0.02)


def test_all_times_make_the_reflectance():
    """R(t) sums to R, and its edges count the path at the speed of light in the slab."""
    result = slab(
        optical_thickness=2.0,
        albedo=0.9,
        phase_function=petzold("harbor"),
        index=1.34,
        bottom_reflectance=0.5,
        walks=64_000,
        path_bins=20,
    )
    assert result.time_resolved.sum() == pytest.approx(result.reflectance, rel=1e-12)
    times = result.arrival_times(attenuation=2.0, group_index=1.36)
    assert times.shape == (21,)
    assert times[4] == pytest.approx(4 * 0.25 / 2.0 * 1.36 / speed_of_light)
    assert times[-1] == np.inf


def test_bottom_answers_after_two_crossings():
    """Without scattering, Lambertian light leaves at cosine m after path tau (1 + 1 / m).

    Hence nothing before 2 tau, and in all rho exp(-tau) 2 E3(tau), E3 the exponential integral of
    order 3; within 1 %.
    """
    result = slab(
        optical_thickness=1.0,
        albedo=0.0,
        phase_function=molecular(),
        bottom_reflectance=0.5,
        walks=6_400_000,
        path_bin=0.5,
    )
    expected = 0.5 * math.exp(-1.0) * 2.0 * float(expn(3, 1.0))
    assert is_equivalent(result.reflectance, result.reflectance_error, expected, 0.01)
    assert np.all(result.time_resolved[:4] == 0.0)
    assert result.time_resolved[4] > 0.0


def test_forward_scattering_takes_nothing_out():
    """Scattering straight ahead leaves absorption alone: T = exp(-(1 - w) tau) = 6e-6, within 5 %.

    Half of that light has come through the roulette of light weights.
    """
    result = slab(
        optical_thickness=30.0,
        albedo=0.6,
        phase_function=henyey_greenstein(0.99999),
        walks=3_200_000,
    )
    assert is_equivalent(result.transmittance, result.transmittance_error, math.exp(-12.0), 0.05)


def test_endless_white_slab_is_refused():
    with pytest.raises(ValueError, match="albedo must be below 1"):
        slab(optical_thickness=math.inf, albedo=1.0, phase_function=molecular())


def test_faults_come_all_at_once():
    with pytest.raises(ValueError, match=r"albedo.*bottom_reflectance"):
        slab(
            optical_thickness=1.0,
            albedo=1.1,
            phase_function=henyey_greenstein(0.0),
            bottom_reflectance=-0.1,
        )

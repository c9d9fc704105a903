"""The plain slab against published slabs."""

from __future__ import annotations

import math

import pytest

from survey.optics.phase import henyey_greenstein, petzold
from survey.transport.slab import slab

# 99.9 % two-sided, 63 degrees of freedom.
QUANTILE = 3.45


def is_equivalent(value: float, error: float, published: float, tolerance: float) -> bool:
    """Tell whether the whole 99.9 % interval lies within a relative tolerance."""
    return abs(value - published) + QUANTILE * error <= tolerance * published


def test_van_de_hulst_slab():
    """Albedo 0.9, g = 0.75, thickness 2: R = 0.09739, T = 0.66096 (van de Hulst 1980).

    Tolerance 0.6 % and 0.2 %; 16 M walks put the standard error at 0.08 % and 0.01 %.
    """
    result = slab(
        optical_thickness=2.0,
        albedo=0.9,
        phase_function=henyey_greenstein(0.75),
        walks=16_000_000,
    )
    assert is_equivalent(result.reflectance, result.reflectance_error, 0.09739, 0.006)
    assert is_equivalent(result.transmittance, result.transmittance_error, 0.66096, 0.002)


def test_conservative_isotropic_slab():
    """Thickness 1, normal incidence: R = 0.34133, T = 0.65867; nothing is lost."""
    result = slab(
        optical_thickness=1.0, albedo=1.0, phase_function=henyey_greenstein(0.0), walks=6_400_000
    )
    assert is_equivalent(result.reflectance, result.reflectance_error, 0.34133, 0.004)
    assert result.reflectance + result.transmittance == pytest.approx(1.0, abs=1e-12)


def test_giovanelli_half_space():
    """Albedo 0.9, isotropic, index 1.5: R = 0.2600 with the mirror part (Giovanelli 1955)."""
    result = slab(
        optical_thickness=math.inf,
        albedo=0.9,
        phase_function=henyey_greenstein(0.0),
        index=1.5,
        walks=3_200_000,
    )
    assert is_equivalent(result.reflectance, result.reflectance_error, 0.2600, 0.005)


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


def test_faults_come_all_at_once():
    with pytest.raises(ValueError, match=r"albedo.*bottom_reflectance"):
        slab(
            optical_thickness=1.0,
            albedo=1.1,
            phase_function=henyey_greenstein(0.0),
            bottom_reflectance=-0.1,
        )

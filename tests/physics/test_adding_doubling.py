"""The plain slab against adding-doubling, which shares nothing with it but the phase function.

`iadpython` by Prahl knows Henyey and Greenstein's function alone; `Slab` hands it any by its
Legendre moments with Wiscombe's delta-M (J. Atmos. Sci. 34, 1408, 1977), as it does with its own.
24 points: its Radau weights lose digits beyond (0.07-0.6 % at 32 points, nonsense at 48).
"""

from __future__ import annotations

import math

import iadpython
import numpy as np
import pytest

from survey.optics.phase import average_particle, henyey_greenstein, petzold
from survey.transport.slab import slab

# 99.9 % two-sided, 63 degrees of freedom.
QUANTILE = 3.45
POINTS = 24
CLEAR, COASTAL, HARBOR = 0.037 / 0.151, 0.219 / 0.398, 1.824 / 2.19
WATERS = {
    "clear": (petzold("clear"), CLEAR),
    "coastal": (petzold("coastal"), COASTAL),
    "harbor": (petzold("harbor"), HARBOR),
    "average particle": (average_particle(), 0.9),
}
THICKNESSES = (1.0, 4.0)


class Slab(iadpython.Sample):
    """A sample with the Legendre moments of a phase function in place of powers of g."""

    def __init__(self, phase, *, points=POINTS, **optics):
        super().__init__(g=0.0, quad_pts=points, **optics)
        self.update_quadrature()
        moments = legendre_moments(phase, points)
        self.truncated = moments[points]
        order = np.arange(points)
        scaled = (moments[:points] - self.truncated) / (1.0 - self.truncated)
        polynomials = np.polynomial.legendre.legvander(self.nu, points - 1)
        terms = (2 * order + 1) * scaled
        self.hp = (polynomials * terms) @ polynomials.T
        self.hm = (polynomials * terms * (-1.0) ** order) @ polynomials.T

    def a_delta_M(self):  # noqa: N802  # the library's name
        return self.a * (1.0 - self.truncated) / (1.0 - self.a * self.truncated)

    def b_delta_M(self):  # noqa: N802
        return (1.0 - self.a * self.truncated) * self.b


def legendre_moments(phase, highest):
    """Return the means of P_0 to P_highest of the cosine, ring by ring."""
    edges = np.concatenate([[0.0], phase.angle])
    light = np.diff(np.concatenate([[0.0], phase.cumulative_on_grid]))
    middle = np.cos(0.5 * (edges[1:] + edges[:-1]))
    return light @ np.polynomial.legendre.legvander(middle, highest)


def is_equivalent(value, error, expected, tolerance):
    """Tell whether the whole 99.9 % interval lies within a relative tolerance."""
    return abs(value - expected) + QUANTILE * error <= tolerance * expected


def test_moments_of_henyey_greenstein_are_powers():
    moments = legendre_moments(henyey_greenstein(0.75), POINTS)
    assert moments == pytest.approx(0.75 ** np.arange(POINTS + 1), abs=1e-5)


@pytest.mark.parametrize("asymmetry", [-0.5, 0.9])
@pytest.mark.parametrize(("albedo", "thickness"), [(0.5, 1.0), (0.95, 4.0)])
def test_henyey_greenstein_slabs(asymmetry, albedo, thickness):
    """The library as it is: R within 3.5 %, T within 1 %."""
    sample = iadpython.Sample(a=albedo, b=thickness, g=asymmetry, quad_pts=POINTS)
    reflected, transmitted, _, _ = sample.rt()
    result = slab(
        optical_thickness=thickness,
        albedo=albedo,
        phase_function=henyey_greenstein(asymmetry),
        walks=3_200_000,
    )
    assert is_equivalent(result.reflectance, result.reflectance_error, reflected, 0.035)
    assert is_equivalent(result.transmittance, result.transmittance_error, transmitted, 0.01)


@pytest.mark.parametrize(("phase", "albedo"), WATERS.values(), ids=WATERS)
@pytest.mark.parametrize("thickness", THICKNESSES)
def test_petzold_slabs(phase, albedo, thickness):
    """R within 4 % (delta-M is 1 % off in thin coastal water), T within 1.6 %."""
    reflected, transmitted, _, _ = Slab(phase, a=albedo, b=thickness).rt()
    result = slab(optical_thickness=thickness, albedo=albedo, phase_function=phase, walks=3_200_000)
    assert is_equivalent(result.reflectance, result.reflectance_error, reflected, 0.04)
    assert is_equivalent(result.transmittance, result.transmittance_error, transmitted, 0.016)


@pytest.mark.parametrize("reflectance", [0.1, 0.9])
def test_petzold_slab_over_a_lambertian_bottom(reflectance):
    """R + T T' rho / (1 - rho R'), primes for diffuse light: R within 0.8 %."""
    optics = {"a": COASTAL, "b": 2.0}
    reflected, transmitted, diffuse_back, diffuse_through = Slab(petzold("coastal"), **optics).rt()
    expected = reflected + (
        transmitted * reflectance * diffuse_through / (1.0 - reflectance * diffuse_back)
    )
    result = slab(
        optical_thickness=2.0,
        albedo=COASTAL,
        phase_function=petzold("coastal"),
        bottom_reflectance=reflectance,
        walks=6_400_000,
    )
    assert is_equivalent(result.reflectance, result.reflectance_error, expected, 0.008)
    absorbed = (1.0 - reflectance) / (1.0 - reflectance * diffuse_back)
    assert is_equivalent(
        result.transmittance, result.transmittance_error, transmitted * absorbed, 0.008
    )


@pytest.mark.parametrize(
    ("phase", "albedo", "index"),
    [(henyey_greenstein(0.75), 0.9, 1.5), (petzold("harbor"), HARBOR, 1.34)],
    ids=["Henyey-Greenstein", "harbor"],
)
def test_half_space_under_a_refractive_surface(phase, albedo, index):
    """Mirror reflection, refraction and internal reflection: R within 2 %."""
    reflected = Slab(phase, a=albedo, b=math.inf, n=index).rt()[0]
    result = slab(
        optical_thickness=math.inf,
        albedo=albedo,
        phase_function=phase,
        index=index,
        walks=960_000,
    )
    assert is_equivalent(result.reflectance, result.reflectance_error, reflected, 0.02)

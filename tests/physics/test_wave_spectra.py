"""Spectra, dispersion and spreading against published digits and another library's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.constants import g
from scipy.integrate import quad

from terrain.waves import Swell, WindSea
from terrain.waves.dispersion import angular_frequency, depth_factor, group_speed, wavenumber
from terrain.waves.spectrum import jonswap, pierson_moskowitz
from terrain.waves.spreading import narrowness, spread
from terrain.waves.whitecaps import whitecap_coverage

FREQUENCIES = np.array([0.08, 0.1, 0.13, 0.2, 0.5])
# wavespectra 4.9.0, construct.frequency: peak 0.13 Hz, alpha 0.0081 and 0.012, 8 m of water.
THEIR_PIERSON_MOSKOWITZ = [0.02500298, 1.40708816, 3.85675484, 1.24954404, 0.01590289]
THEIR_JONSWAP = [0.03704146, 2.09546723, 18.85524586, 1.8511764, 0.02355984]
THEIR_TMA = [0.00381175006, 0.336175803, 5.08340721, 1.11717728, 0.0235597524]


def variance(sea: WindSea) -> float:
    peak = sea.peak_frequency

    def density(frequency: float) -> float:
        return float(sea.density(np.array([frequency]))[0])

    parts = [(0.2 * peak, peak), (peak, 2.0 * peak), (2.0 * peak, 50.0 * peak)]
    return float(sum(quad(density, low, high, epsrel=1e-8)[0] for low, high in parts))


def test_densities_are_those_of_another_library() -> None:
    ours = pierson_moskowitz(FREQUENCIES, peak_frequency=0.13)
    assert ours == pytest.approx(THEIR_PIERSON_MOSKOWITZ, rel=1e-6)
    ours = jonswap(FREQUENCIES, peak_frequency=0.13, alpha=0.012)
    assert ours == pytest.approx(THEIR_JONSWAP, rel=1e-6)


def test_shallow_water_takes_what_another_library_says() -> None:
    """Within 0.3 %: its wavenumbers are an approximation (Chen and Thomson)."""
    k = np.array([wavenumber(1.0 / f, depth=8.0) for f in FREQUENCIES])
    ours = jonswap(FREQUENCIES, peak_frequency=0.13, alpha=0.012) * depth_factor(k, depth=8.0)
    assert ours == pytest.approx(THEIR_TMA, rel=3e-3)


def test_fully_developed_sea() -> None:
    """Stewart (16.30), (16.32), (16.33): peak, variance and height go with U at 19.5 m.

    0.13 g / U10 and 0.877 g / U19.5 are one peak where U19.5 = 1.074 U10, the wind's neutral
    profile; there the variance is 2.74e-3 U^4 / g^2, and the height 0.21 U^2 / g.
    """
    sea = WindSea.fully_developed(wind_speed=10.0)
    wind = 0.877 * g / (2.0 * np.pi * sea.peak_frequency)
    assert wind == pytest.approx(10.74, abs=0.01)
    assert variance(sea) == pytest.approx(2.74e-3 * wind**4 / g**2, rel=2e-3)
    assert 4.0 * variance(sea) ** 0.5 == pytest.approx(0.21 * wind**2 / g, rel=5e-3)
    near = np.linspace(0.5, 2.0, 3001) * sea.peak_frequency
    assert near[np.argmax(sea.density(near))] == pytest.approx(sea.peak_frequency, rel=1e-3)


def test_enhancement_of_the_growing_sea() -> None:
    """DNV-RP-C205: gamma = 3.3 makes the variance 1 / (1 - 0.287 ln 3.3) times as large."""
    sea = WindSea.fetch_limited(wind_speed=10.0, fetch=20e3)
    plain = WindSea(
        wind_speed=10.0, peak_frequency=sea.peak_frequency, alpha=sea.alpha, enhancement=1.0
    )
    assert variance(plain) / variance(sea) == pytest.approx(1.0 - 0.287 * np.log(3.3), rel=0.01)
    assert 2.0 * np.pi * sea.peak_frequency == pytest.approx(
        22.0 * (g**2 / (10.0 * 20e3)) ** (1.0 / 3.0), rel=1e-3
    )


def test_a_sea_grows_with_fetch_and_no_further_than_the_full_one() -> None:
    full = WindSea.fully_developed(wind_speed=5.0)
    seas = [WindSea.fetch_limited(wind_speed=5.0, fetch=fetch) for fetch in (1e3, 1e4, 1e6, 1e7)]
    assert np.all(np.diff([sea.peak_frequency for sea in seas[:3]]) < 0.0)
    assert seas[2] == seas[3]
    assert seas[3].peak_frequency == pytest.approx(full.peak_frequency)


@pytest.mark.parametrize("depth", [2.0, 20.0, np.inf])
def test_dispersion(depth: float) -> None:
    """Period to wavenumber and back; the group's speed is the frequency's derivative."""
    k = np.array([wavenumber(period, depth=depth) for period in (0.5, 3.0, 15.0)])
    omega = angular_frequency(k, depth=depth)
    assert omega == pytest.approx(2.0 * np.pi / np.array([0.5, 3.0, 15.0]), rel=1e-12)
    ahead, behind = (angular_frequency(k * (1.0 + e), depth=depth) for e in (1e-6, -1e-6))
    assert group_speed(k, depth=depth) == pytest.approx((ahead - behind) / (2e-6 * k), rel=1e-7)


def test_speed_in_shallow_and_deep_water() -> None:
    assert angular_frequency(np.array([1e-3]), depth=2.0) / 1e-3 == pytest.approx(
        np.sqrt(g * 2.0), rel=1e-5
    )
    assert angular_frequency(np.array([0.5])) == pytest.approx(np.sqrt(0.5 * g))


@pytest.mark.parametrize("s", [0.5, 1.0, 9.77, 75.0])
def test_spreading(s: float) -> None:
    """One in all; the mean cosine is s / (s + 1), as known for cos^2s."""
    angle = np.linspace(-np.pi, np.pi, 20_001)[:-1]
    share = spread(angle, s) * (angle[1] - angle[0])
    assert share.sum() == pytest.approx(1.0, rel=1e-6)
    assert share @ np.cos(angle) == pytest.approx(s / (s + 1.0), rel=1e-5)


def test_narrowness_at_and_above_the_peak() -> None:
    """Hasselmann et al. (1980): 9.77 at the peak, mu = -2.33 where U / c_p is 1.17."""
    sea = WindSea(
        wind_speed=10.0, peak_frequency=1.17 * g / (20.0 * np.pi), alpha=0.01, enhancement=3.3
    )
    s = narrowness(np.array([0.8, 1.0 + 1e-9, 1.5, 2.0]) * sea.peak_frequency, sea)
    assert s == pytest.approx([6.97 * 0.8**4.06, 9.77, 9.77 * 1.5**-2.33, 9.77 * 2.0**-2.33])


def test_swell_has_its_height_period_and_direction() -> None:
    """In 8 m of water: the mean wavenumber points from west to east, slopes go along with it."""
    swell = Swell(height=1.2, period=11.0, comes_from=1.5 * np.pi)
    waves = swell.plane_waves(np.random.default_rng(1), depth=8.0)
    assert 16.0 * waves.variance() == pytest.approx(1.2**2)
    assert 2.0 * np.pi / np.median(waves.frequency) == pytest.approx(11.0, rel=0.05)
    assert angular_frequency(np.hypot(waves.kx, waves.ky), depth=8.0) == pytest.approx(
        waves.frequency
    )
    assert waves.kx.mean() == pytest.approx(wavenumber(11.0, depth=8.0), rel=0.1)
    assert abs(waves.ky.mean()) < 0.05 * waves.kx.mean()
    covariance = waves.slope_covariance()
    assert covariance[0, 0] == pytest.approx(waves.variance() * (waves.kx**2).mean())
    assert covariance[1, 1] < 0.1 * covariance[0, 0]


def test_whitecaps() -> None:
    """Monahan and O'Muircheartaigh (1980): about 1 % at 10 m/s, 11 % at 20 m/s, none in calm."""
    assert whitecap_coverage(0.0) == 0.0
    assert whitecap_coverage(10.0) == pytest.approx(0.0098, abs=1e-4)
    assert whitecap_coverage(20.0) == pytest.approx(0.112, abs=1e-3)

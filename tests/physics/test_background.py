"""The background, equations (1) to (7) of [Lisenko2017], in the paper's own numbers."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from survey.optics.background import (
    Sky,
    background_power,
    haze_radiance,
    high_flight_radiance,
    low_flight_radiance,
    round_field,
    surface_brightness,
    surface_irradiance,
    surface_radiance,
    water_radiance,
)

ZENITH, THICKNESS, SOLAR = math.radians(20.0), 0.3, 1.95e9
DAY = Sky(
    zenith=ZENITH,
    wind_speed=5.0,
    optical_thickness=THICKNESS,
    solar_irradiance=SOLAR,
    legendre_moment=1.5,
    water_reflectance=0.0097,
)
TO_PER_MICROMETRE = 1e-6


def terms_of(sky: Sky, *, layer: float, transmittance: float = 0.98) -> tuple[float, float, float]:
    """Haze, water and surface, equations (2) to (4)."""
    haze = haze_radiance(
        zenith=sky.zenith,
        solar_irradiance=sky.solar_irradiance,
        optical_thickness=sky.optical_thickness,
        layer_thickness=layer,
    )
    water = water_radiance(
        irradiance=sky.irradiance, water_reflectance=sky.water_reflectance, layer_thickness=layer
    )
    surface = surface_radiance(
        irradiance=sky.irradiance,
        brightness=sky.brightness,
        layer_thickness=layer,
        transmittance=transmittance,
    )
    return haze, water, surface


SKIES = [
    DAY,
    replace(DAY, zenith=0.0, wind_speed=2.0, water_reflectance=0.0121),
    replace(DAY, zenith=math.radians(75.0), optical_thickness=1.2, legendre_moment=0.3),
]


def test_the_paper_s_day():
    """51.8 W/(m2 um sr) at 20 degrees, 5 m/s, rho_s = 0.0097, x1 = 1.5."""
    assert DAY.radiance() * TO_PER_MICROMETRE == pytest.approx(51.8, abs=0.05)


@pytest.mark.parametrize("sky", SKIES)
def test_low_flight_is_the_sum_without_air_and_without_t_down(sky):
    haze, water, surface = terms_of(sky, layer=0.0, transmittance=1.0)
    assert haze == 0.0
    assert water + surface == pytest.approx(sky.radiance(), rel=1e-12)


def test_low_flight_as_printed_departs_by_a_sixtieth():
    """The T_down of (4), which (6) drops, is 1.6 % of the paper's day."""
    as_printed = sum(terms_of(DAY, layer=0.0))
    assert replace(DAY, model="layered").radiance() == pytest.approx(as_printed, rel=1e-12)
    assert DAY.radiance() / as_printed - 1.0 == pytest.approx(0.016, abs=0.001)


@pytest.mark.parametrize("sky", SKIES)
def test_high_flight_is_the_sum_only_without_the_air_s_loss_and_t_down(sky):
    """At tau = tau0 equation (7) lacks exp(-tau0) on the sea's light, and the T_down of (4)."""
    high = replace(sky, model="high_flight").radiance()
    tau0 = sky.optical_thickness
    haze, water, surface = terms_of(sky, layer=tau0, transmittance=1.0)
    assert haze + (water + surface) * math.exp(tau0) == pytest.approx(high, rel=1e-12)
    assert haze + water + surface < (1.0 - 1e-3) * high
    printed = sum(terms_of(sky, layer=tau0))
    layered = replace(sky, model="layered", layer_thickness=tau0).radiance()
    assert layered == pytest.approx(printed, rel=1e-12)
    assert printed < haze + water + surface


def test_what_high_flight_drops():
    """exp(-0.3) = 0.74; equation (7) gives 86.5, the sum of (2) to (4) 72.4 W/(m2 um sr)."""
    high = replace(DAY, model="high_flight")
    summed = replace(DAY, model="layered", layer_thickness=THICKNESS)
    assert high.radiance() * TO_PER_MICROMETRE == pytest.approx(34.71 + 51.79, abs=0.02)
    assert summed.radiance() * TO_PER_MICROMETRE == pytest.approx(34.71 + 50.94 * 0.7408, abs=0.02)


def test_haze_is_light_scattered_once():
    """Equation (2) against a sum over thin layers of air that scatter alike in all directions."""
    layer, mu, steps = 0.2, math.cos(ZENITH), 20_000
    summed = 0.0
    for step in range(steps):
        below_receiver = (step + 0.5) / steps * layer
        below_top = THICKNESS - layer + below_receiver
        summed += math.exp(-below_top / mu - below_receiver) / (4.0 * math.pi) * layer / steps
    haze = haze_radiance(
        zenith=ZENITH, solar_irradiance=1.0, optical_thickness=THICKNESS, layer_thickness=layer
    )
    assert haze == pytest.approx(summed, rel=1e-8)


@pytest.mark.parametrize("zenith", [0.0, ZENITH, 1.2, 1.5])
def test_irradiance_without_air_is_the_sun_s_own(zenith):
    bare = surface_irradiance(
        zenith=zenith, solar_irradiance=1.0, optical_thickness=0.0, legendre_moment=1.5
    )
    assert bare == pytest.approx(math.cos(zenith), rel=1e-12)


def test_irradiance_of_air_that_scatters_forward_alone():
    """x1 = 3 loses nothing of a sun at cos t0 = 2/3: two streams, E = E0."""
    mu = 2.0 / 3.0
    through = surface_irradiance(
        zenith=math.acos(mu), solar_irradiance=1.0, optical_thickness=2.0, legendre_moment=3.0
    )
    assert through == pytest.approx(mu, rel=1e-12)


def test_brightness_between_and_beyond_the_printed_winds():
    assert surface_brightness(2.0) == pytest.approx(0.033, rel=1e-12)
    assert surface_brightness(5.0) == pytest.approx(0.077, rel=1e-12)
    assert surface_brightness(4.0) == pytest.approx(0.033 + 2.0 / 3.0 * 0.044, rel=1e-12)
    assert 0.0 <= surface_brightness(0.0) < surface_brightness(1.0) < 0.033
    assert surface_brightness(20.0) == surface_brightness(5.0)


def test_power_in_the_paper_s_pixel():
    """Round, 5.0e-5 sr, as equation (1) prints it; a square pixel has 4 / pi of it."""
    rest = {"radiance": 5.0e7, "filter_width": 1e-9, "aperture_area": math.pi * 0.05**2}
    round_pixel = background_power(**rest, solid_angle=round_field(0.004))
    assert round_pixel == pytest.approx(5.0e7 * 1e-9 * math.pi**2 * (0.05 * 0.004) ** 2, rel=1e-12)
    square = background_power(**rest, solid_angle=0.008**2)
    assert square / round_pixel == pytest.approx(4.0 / math.pi, rel=1e-12)


def test_negative_power_is_refused_with_all_its_reasons():
    with pytest.raises(ValueError, match="must not be negative") as caught:
        background_power(radiance=-1.0, filter_width=1e-9, aperture_area=math.nan, solid_angle=1e-4)
    assert str(caught.value).splitlines() == [
        "background: radiance = -1: must not be negative",
        "background: aperture_area = nan: must not be negative",
    ]


def test_a_sky_out_of_bounds_is_refused_with_all_its_reasons():
    with pytest.raises(ValueError, match="sky: ") as caught:
        replace(DAY, zenith=1.6, solar_irradiance=-1.0, layer_thickness=0.4)
    assert str(caught.value).splitlines() == [
        "sky: zenith = 1.6: must be 0 to below pi/2",
        "sky: solar_irradiance = -1: must not be negative",
        "sky: layer_thickness = 0.4: must be 0 to optical_thickness 0.3",
    ]


def test_limits_in_absolute_numbers():
    """Equations (6) and (7) written out by hand for E = 1, m = 1.33, T = 0.98."""
    low = low_flight_radiance(irradiance=1.0, water_reflectance=0.01, brightness=0.05)
    assert low == pytest.approx(0.9604 * 0.01 / 1.7689 + 0.05 / math.pi, rel=1e-12)
    high = high_flight_radiance(
        zenith=math.acos(0.5),
        solar_irradiance=2.0,
        optical_thickness=0.1,
        irradiance=1.0,
        water_reflectance=0.01,
        brightness=0.05,
    )
    assert high - low == pytest.approx((1.0 - math.exp(-0.3)) / (6.0 * math.pi), rel=1e-12)

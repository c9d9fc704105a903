"""Glint of a rough sea at nadir against facets drawn one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from survey.optics.background import CoxMunkGlint, reflected_skylight, sun_glint, surface_brightness
from terrain.sea_surface import SeaSurface

INDEX = 1.34
FACETS = 4_000_000


def sea_of(wind_speed, *, wind_from=0.0):
    return SeaSurface.from_wind(level=0.0, wind_speed=wind_speed, wind_from=wind_from)


# No water is so steep: facets of 40 degrees show how tilt enters.
STEEP_SEA = SeaSurface(
    level=0.0, upwind_slope_variance=0.5, crosswind_slope_variance=0.3, wind_from=0.4
)


def reflectance(cos_in):
    """Fresnel, from the two amplitudes written with angles."""
    angle = np.arccos(cos_in)
    inside = np.arcsin(np.sin(angle) / INDEX)
    across = np.sin(angle - inside) / np.sin(angle + inside)
    within = np.tan(angle - inside) / np.tan(angle + inside)
    return 0.5 * (across**2 + within**2)


def drawn_radiance(*, zenith, sun_azimuth, sea, cone, seed):
    """What drawn facets mirror of a beam of 1 W/m2 into a cone about nadir, and its error.

    A facet of slope (z_e, z_n) has normal (-z_e, -z_n, 1); per area of level sea it catches
    (s . n) / n_z of the beam; radiance is power over the cone's projected solid angle.
    """
    chance = np.random.default_rng(seed)
    along = math.sqrt(sea.upwind_slope_variance) * chance.normal(size=FACETS)
    across = math.sqrt(sea.crosswind_slope_variance) * chance.normal(size=FACETS)
    sine, cosine = math.sin(sea.wind_from), math.cos(sea.wind_from)
    east, north = along * sine + across * cosine, along * cosine - across * sine
    normals = np.column_stack([-east, -north, np.ones(FACETS)])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    sun = np.array(
        [
            math.sin(zenith) * math.sin(sun_azimuth),
            math.sin(zenith) * math.cos(sun_azimuth),
            math.cos(zenith),
        ]
    )
    facing = normals @ sun
    upwards = 2.0 * facing * normals[:, 2] - sun[2]
    hit = (facing > 0.0) & (upwards > math.cos(cone))
    caught = reflectance(facing[hit]) * facing[hit] / normals[hit, 2]
    projected = math.pi * math.sin(cone) ** 2 * FACETS
    return caught.sum() / projected, math.sqrt((caught**2).sum()) / projected


@pytest.mark.parametrize(
    ("sea", "zenith_deg", "sun_deg", "cone_deg"),
    [
        (sea_of(5.0), 20.0, 180.0, 2.0),
        (sea_of(5.0), 20.0, 90.0, 2.0),
        (sea_of(2.0, wind_from=0.7), 12.0, 70.0, 2.0),
        (sea_of(12.0, wind_from=1.3), 30.0, 0.0, 2.0),
        (STEEP_SEA, 80.0, 60.0, 4.0),
    ],
    ids=["along", "across", "calm", "rough", "steep"],
)
def test_sun_glint_is_what_facets_mirror(sea, zenith_deg, sun_deg, cone_deg):
    """Within 4 standard errors of 4 million facets (at most 1.4 % each) and 1 % for the cone."""
    place = {"zenith": math.radians(zenith_deg), "sun_azimuth": math.radians(sun_deg), "sea": sea}
    drawn, error = drawn_radiance(**place, cone=math.radians(cone_deg), seed=20)
    assert error < 0.014 * drawn
    closed = sun_glint(beam=1.0, **place, refractive_index=INDEX)
    assert abs(closed - drawn) < 4.0 * error + 0.01 * drawn


def test_glitter_is_longer_along_the_wind():
    """The sun upwind of the sea and across the wind: the ratio of the two densities of slope."""
    sea, tilt = sea_of(5.0), math.tan(math.radians(10.0))
    place = {"beam": 1.0, "zenith": math.radians(20.0), "sea": sea, "refractive_index": INDEX}
    ratio = sun_glint(sun_azimuth=math.pi, **place) / sun_glint(sun_azimuth=math.pi / 2, **place)
    exponent = 0.5 * tilt**2 * (1.0 / 0.0126 - 1.0 / 0.0158)
    assert ratio == pytest.approx(math.exp(exponent), rel=1e-9)


def test_brightness_is_sun_and_sky_over_irradiance():
    """Written out for air of 0.3 and x1 = 1.5, whose irradiance is 2.1117 mu / 2.225 at 20 deg."""
    zenith = math.radians(20.0)
    mu, sea = math.cos(zenith), sea_of(5.0)
    beam = math.exp(-0.3 / mu)
    irradiance = 2.0 * (1.0 + 1.5 * mu + (1.0 - 1.5 * mu) * beam) / 4.45 * mu
    glitter = sun_glint(beam=beam, zenith=zenith, sun_azimuth=1.0, sea=sea, refractive_index=INDEX)
    sky = ((INDEX - 1.0) / (INDEX + 1.0)) ** 2 * (irradiance - beam * mu) / math.pi
    brightness = CoxMunkGlint(sea=sea, sun_azimuth=1.0, refractive_index=INDEX).brightness(
        zenith=zenith, optical_thickness=0.3, legendre_moment=1.5
    )
    assert brightness == pytest.approx(math.pi * (glitter + sky) / irradiance, rel=1e-12)


def test_an_even_sky_is_mirrored_by_fresnel_s_share():
    """A white sky of radiance L sends E = pi L down and rho L up."""
    rho = ((INDEX - 1.0) / (INDEX + 1.0)) ** 2
    assert reflected_skylight(diffuse=math.pi, refractive_index=INDEX) == pytest.approx(rho)


@pytest.mark.parametrize(("wind_speed", "most"), [(2.0, 0.25), (5.0, 0.3)])
def test_the_paper_s_numbers_are_of_that_size(wind_speed, most):
    """Without a wind direction in the paper: the mean over all, with rho_sf 0.033 and 0.077."""
    brightness = np.mean(
        [
            CoxMunkGlint(
                sea=sea_of(wind_speed), sun_azimuth=azimuth, refractive_index=1.33
            ).brightness(zenith=math.radians(20.0), optical_thickness=0.3, legendre_moment=1.5)
            for azimuth in np.linspace(0.0, math.pi, 16, endpoint=False)
        ]
    )
    assert abs(brightness / surface_brightness(wind_speed) - 1.0) < most


def test_glint_fades_as_the_sun_sinks_and_the_sky_stays():
    """At 70 degrees nothing but the sky is mirrored: Fresnel's share of its share of E."""
    sea = sea_of(5.0)
    heights = np.radians([0.0, 20.0, 40.0, 60.0])
    rest = {"beam": 1.0, "sun_azimuth": 0.0, "sea": sea, "refractive_index": INDEX}
    values = [sun_glint(zenith=zenith, **rest) for zenith in heights]
    assert values == sorted(values, reverse=True)
    mu = math.cos(math.radians(70.0))
    beam = math.exp(-0.3 / mu)
    sky_share = 1.0 - beam / (2.0 * (1.0 + 1.5 * mu + (1.0 - 1.5 * mu) * beam) / 4.45)
    brightness = CoxMunkGlint(sea=sea, sun_azimuth=0.0, refractive_index=INDEX).brightness(
        zenith=math.acos(mu), optical_thickness=0.3, legendre_moment=1.5
    )
    assert brightness == pytest.approx(((INDEX - 1) / (INDEX + 1)) ** 2 * sky_share, rel=1e-3)


def test_still_water_and_a_sky_without_light_are_refused():
    with pytest.raises(ValueError, match="give the sea some wind"):
        CoxMunkGlint(sea=sea_of(0.0), sun_azimuth=0.0, refractive_index=INDEX)
    glint = CoxMunkGlint(sea=sea_of(5.0), sun_azimuth=0.0, refractive_index=INDEX)
    with pytest.raises(ValueError, match="take -2 or more"):
        glint.brightness(zenith=0.3, optical_thickness=0.01, legendre_moment=-2.9)


@pytest.mark.parametrize("zenith", [0.0, 0.3, 1.0, 1.5])
@pytest.mark.parametrize("optical_thickness", [0.0, 1e-3, 0.3, 3.0])
def test_the_sky_gives_light_from_minus_two_up(zenith, optical_thickness):
    glint = CoxMunkGlint(sea=sea_of(5.0), sun_azimuth=0.0, refractive_index=INDEX)
    place = {"zenith": zenith, "optical_thickness": optical_thickness}
    assert glint.brightness(**place, legendre_moment=-2.0) >= 0.0

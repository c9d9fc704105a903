"""Snell and Fresnel."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import norm

from survey.optics.interface import fresnel_reflectance, reflected, refracted, transmitted_cosine
from survey.transport.scene import kernel_sea
from survey.transport.surface import (
    NORMAL_QUANTILES,
    drawn_normal,
    enter_water,
    facing_from_below,
    glint_per_steradian,
    return_per_steradian,
)
from terrain.kernels import kernel
from terrain.sea_surface import SeaSurface

INDEX = 1.34


def test_normal_incidence():
    """0.0211 for n = 1.34."""
    assert fresnel_reflectance(1.0, 1.0 / INDEX) == pytest.approx(0.0211, abs=5e-5)


def test_refraction_there_and_back():
    direction = np.array([0.3, -0.2, -math.sqrt(1 - 0.13)])
    normal = np.array([0.1, 0.05, 1.0]) / np.linalg.norm([0.1, 0.05, 1.0])
    inside = refracted(*direction, *normal, 1.0 / INDEX)
    outside = refracted(*(-np.array(inside)), *(-normal), INDEX)
    assert np.allclose(outside, -direction, atol=1e-14)
    assert np.linalg.norm(inside) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("cosine", [0.05, 0.3, 0.7, 0.95])
def test_reflectance_is_the_same_from_both_sides(cosine):
    inside = transmitted_cosine(cosine, 1.0 / INDEX)
    assert fresnel_reflectance(cosine, 1.0 / INDEX) == pytest.approx(
        fresnel_reflectance(inside, INDEX), rel=1e-12
    )


def test_total_internal_reflection():
    critical = math.sqrt(1.0 - 1.0 / INDEX**2)
    assert fresnel_reflectance(critical - 1e-6, INDEX) == 1.0
    assert fresnel_reflectance(critical + 1e-3, INDEX) < 1.0


def test_brewster_angle_halves_the_reflectance():
    """At tan t = n the parallel part vanishes: half of the perpendicular part is left."""
    cosine = 1.0 / math.sqrt(1.0 + INDEX**2)
    perpendicular = ((1.0 - INDEX**2) / (1.0 + INDEX**2)) ** 2
    assert fresnel_reflectance(cosine, 1.0 / INDEX) == pytest.approx(0.5 * perpendicular)


def test_reflection_keeps_the_angle():
    out = reflected(0.6, 0.0, 0.8, 0.0, 0.0, -1.0)
    assert out == pytest.approx((0.6, 0.0, -0.8))


@kernel
def facets(sea, quantiles, count):
    """Draw the normals of many facets, (count, 3)."""
    state, normals = np.array([3, 5], np.uint64), np.empty((count, 3))
    for i in range(count):
        normals[i] = drawn_normal(sea, quantiles, state)
    return normals


def drawn_facets(count, **wind):
    """Return a sea and normals of its facets."""
    surface = SeaSurface.from_wind(level=0.0, **wind)
    return surface, facets(kernel_sea(surface), NORMAL_QUANTILES, count)


def test_facets_have_the_sea_s_slopes():
    """Mean, variance and covariance of 200,000 facets: 4 standard errors; wind from the east."""
    surface, normals = drawn_facets(200_000, wind_speed=10.0, wind_from=math.pi / 2)
    slope = -normals[:, :2] / normals[:, 2:]
    expected = np.array([surface.upwind_slope_variance, surface.crosswind_slope_variance])
    count = len(slope)
    assert np.all(np.abs(slope.mean(axis=0)) < 4.0 * np.sqrt(expected / count))
    assert np.all(np.abs(slope.var(axis=0) / expected - 1.0) < 4.0 * math.sqrt(2.0 / count))
    assert abs(np.corrcoef(slope.T)[0, 1]) < 4.0 / count**0.5
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-14)


def test_slopes_are_gaussian():
    """Fourth moment 3 and the share beyond two deviations, 4 standard errors of 200,000."""
    surface, normals = drawn_facets(200_000, wind_speed=10.0, wind_from=math.pi / 2)
    scaled = normals[:, 0] / normals[:, 2] / surface.upwind_slope_variance**0.5
    assert abs((scaled**4).mean() - 3.0) < 4.0 * math.sqrt(96.0 / len(scaled))
    outside = 2.0 * norm.sf(2.0)
    error = math.sqrt(outside * (1.0 - outside) / len(scaled))
    assert abs((np.abs(scaled) > 2.0).mean() - outside) < 4.0 * error


def test_the_wind_s_direction_turns_the_slopes():
    """Wind from the north-east: the steep slopes lie along it, the covariance is half of
    upwind less crosswind variance."""
    surface, normals = drawn_facets(200_000, wind_speed=10.0, wind_from=math.pi / 4)
    slope = -normals[:, :2] / normals[:, 2:]
    apart = surface.upwind_slope_variance - surface.crosswind_slope_variance
    assert np.cov(slope.T)[0, 1] == pytest.approx(0.5 * apart, rel=0.05)


def test_still_water_is_exactly_level():
    _, normals = drawn_facets(100, wind_speed=0.0, wind_from=1.0)
    assert np.array_equal(normals, np.tile([0.0, 0.0, 1.0], (100, 1)))


@pytest.mark.parametrize("degrees", [2.0, 15.0, 40.0])
def test_facets_catch_the_light_once_on_average(degrees):
    """The mean facet weight of a slanting ray is one: 4 standard errors of 40,000 facets."""
    _, normals = drawn_facets(40_000, wind_speed=5.0, wind_from=0.3)
    angle = math.radians(degrees)
    ray = (math.sin(angle), 0.0, -math.cos(angle))
    caught = np.array([enter_water(INDEX, *ray, *normal)[3] for normal in normals])
    assert abs(caught.mean() - 1.0) < 4.0 * caught.std() / 200.0


def test_a_ray_enters_by_snell_and_fresnel_at_its_facet():
    """The refracted ray lies in the plane of ray and facet, its sine smaller by the index."""
    _, (normal,) = drawn_facets(1, wind_speed=10.0, wind_from=0.3)
    ray = np.array([0.3, -0.1, -math.sqrt(0.9)])
    *inside, caught, reflectance = enter_water(INDEX, *ray, *normal)
    assert np.cross(inside, normal) * INDEX == pytest.approx(np.cross(ray, normal), abs=1e-14)
    assert caught == pytest.approx(-ray @ normal / (-ray[2] * normal[2]), rel=1e-12)
    assert reflectance == fresnel_reflectance(-ray @ normal, 1.0 / INDEX)


def test_a_ray_from_behind_catches_nothing():
    assert enter_water(INDEX, 0.8, 0.0, -0.6, 0.8, 0.0, 0.6)[3:] == (0.0, 0.0)


def test_rising_rays_meet_facets_that_throw_them_down():
    """A facet that a rising ray would miss, or that would send it out again, counts as smooth."""
    level, still = (0.0, 0.0, 1.0), (0.0, 0.0)
    tilted = (math.sin(0.3), 0.0, math.cos(0.3))
    assert facing_from_below(0.0, 0.0, 1.0, *tilted, *still) == tilted
    assert facing_from_below(-0.99, 0.0, math.sqrt(1 - 0.99**2), *tilted, *still) == level
    assert facing_from_below(math.cos(0.2), 0.0, math.sin(0.2), *tilted, *still) == tilted
    assert facing_from_below(-math.sin(1.2), 0.0, math.cos(1.2), *tilted, *still) == level
    wave = facing_from_below(-0.99, 0.0, math.sqrt(1 - 0.99**2), *tilted, -math.tan(0.1), 0.0)
    assert wave == pytest.approx((math.sin(0.1), 0.0, math.cos(0.1)))


def test_glint_equals_the_closed_form():
    """Isotropic: rho exp(-tan^2 t / s2) / (4 pi s2 cos^5 t), per incident power."""
    variance = 0.014
    surface = SeaSurface(
        level=0.0, upwind_slope_variance=variance, crosswind_slope_variance=variance, wind_from=0.4
    )
    sea, rho = kernel_sea(surface), ((INDEX - 1) / (INDEX + 1)) ** 2
    for degrees in (0.0, 5.0, 14.4):
        angle = math.radians(degrees)
        ray = (math.sin(angle) * 0.6, math.sin(angle) * 0.8, -math.cos(angle))
        s2 = 2.0 * variance
        closed = rho * math.exp(-(math.tan(angle) ** 2) / s2)
        closed /= 4.0 * math.pi * s2 * math.cos(angle) ** 5
        assert glint_per_steradian(sea, INDEX, *ray) == pytest.approx(closed, rel=1e-12)


def thrown_back(*, ray, slope, variance, facets, cone):
    """Return what drawn facets on water of a slope throw back into a cone [1/sr], per light caught.

    ``slope`` (2,) and ``variance`` (2,) towards east and north; ``cone`` is its half angle [rad].
    """
    chance = np.random.default_rng(8)
    slopes = slope + chance.normal(size=(facets, 2)) * np.sqrt(variance)
    normals = np.column_stack([-slopes, np.ones(facets)])
    shown = np.maximum(-normals @ ray, 0.0)
    shown /= -np.array([-slope[0], -slope[1], 1.0]) @ ray
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    back = ray - 2.0 * (normals @ ray)[:, None] * normals
    hits = back @ -ray > math.cos(cone)
    rho = ((INDEX - 1) / (INDEX + 1)) ** 2
    return rho * shown[hits].sum() / facets / (2 * math.pi * (1 - math.cos(cone)))


@pytest.mark.parametrize(
    ("degrees", "slope"), [(8.0, (0.0, 0.0)), (8.0, (-0.05, 0.15)), (30.0, (0.4, 0.1))]
)
def test_glint_against_facets(degrees, slope):
    """Of a slanting beam, what facets on level and on sloping water throw back, per solid angle.

    Rationale: facets show the beam the more the more they face it, and so does the water under
    them: at 30 degrees a slope of 0.4 catches 23 % more than level water.
    Expected: two million drawn facets hold the ratio to 4 % (one standard error 0.6 to 1 %).
    Source: mirror facets, drawn one by one.
    """
    angle, variance = math.radians(degrees), (0.03, 0.02)
    ray = np.array([math.sin(angle), 0.0, -math.cos(angle)])
    drawn = thrown_back(
        ray=ray, slope=np.array(slope), variance=variance, facets=2_000_000, cone=math.radians(3.0)
    )
    surface = SeaSurface(
        level=0.0,
        upwind_slope_variance=variance[0],
        crosswind_slope_variance=variance[1],
        wind_from=math.pi / 2,
    )
    sea = kernel_sea(surface)
    closed = return_per_steradian(sea, INDEX, *ray, *slope)
    assert drawn / closed == pytest.approx(1.0, abs=0.04)
    if slope == (0.0, 0.0):
        assert glint_per_steradian(sea, INDEX, *ray) == pytest.approx(closed, rel=1e-12)


def test_foam_sends_back_by_the_angle_of_incidence():
    """White water of a slope is Lambertian: 0.22 / pi cos i, i between beam and its normal."""
    sea = kernel_sea(SeaSurface.from_wind(level=0.0, wind_speed=5.0, wind_from=0.0))
    normal = np.array([-0.3, -0.1, 1.0]) / math.sqrt(1.1)
    ray = np.array([0.5, 0.0, -math.sqrt(0.75)])
    found = return_per_steradian(sea._replace(white=1.0), INDEX, *ray, 0.3, 0.1)
    assert found == pytest.approx(0.22 / math.pi * -(normal @ ray), rel=1e-12)
    assert return_per_steradian(sea._replace(white=1.0), INDEX, *ray, -2.0, 0.0) == 0.0

"""Snell and Fresnel."""

from __future__ import annotations

import math

import numpy as np
import pytest

from survey.optics.interface import fresnel_reflectance, reflected, refracted, transmitted_cosine
from survey.transport.random import mixed
from survey.transport.scene import kernel_sea
from survey.transport.surface import enter_water, facet_normal, glint_per_steradian
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


def test_facets_have_the_sea_s_slopes():
    """Mean and variance of 200,000 facets: 4 standard errors; wind from the east."""
    surface = SeaSurface.from_wind(
        level=0.0, wind_speed=10.0, wind_from=math.pi / 2, correlation_length=0.1
    )
    sea = kernel_sea(surface, key=7)
    normals = np.array(
        [facet_normal(sea, 0.1 * i + 0.05, 0.1 * j + 0.05) for i in range(500) for j in range(400)]
    )
    slope = -normals[:, :2] / normals[:, 2:]
    expected = np.array([surface.upwind_slope_variance, surface.crosswind_slope_variance])
    count = len(slope)
    assert np.all(np.abs(slope.mean(axis=0)) < 4.0 * np.sqrt(expected / count))
    assert np.all(np.abs(slope.var(axis=0) / expected - 1.0) < 4.0 * math.sqrt(2.0 / count))


def test_one_facet_is_one_slope():
    sea = kernel_sea(
        SeaSurface.from_wind(level=0.0, wind_speed=5.0, wind_from=0.0, correlation_length=0.5),
        key=int(mixed(np.uint64(3))) % 2**63,
    )
    assert facet_normal(sea, 0.1, 0.1) == facet_normal(sea, 0.4, 0.49)
    assert facet_normal(sea, 0.1, 0.1) != facet_normal(sea, -0.1, 0.1)


def test_facets_catch_the_light_once_on_average():
    """The mean facet weight of a slanting ray is one: 4 standard errors of 40,000 facets."""
    sea = kernel_sea(
        SeaSurface.from_wind(level=0.0, wind_speed=5.0, wind_from=0.3, correlation_length=0.1),
        key=11,
    )
    ray = (0.25, 0.0, -math.sqrt(1 - 0.25**2))
    caught = np.array(
        [
            enter_water(sea, INDEX, 0.1 * i + 0.05, 0.1 * j + 0.05, *ray)[3]
            for i in range(200)
            for j in range(200)
        ]
    )
    assert abs(caught.mean() - 1.0) < 4.0 * caught.std() / 200.0


def test_glint_equals_the_closed_form():
    """Isotropic: rho exp(-tan^2 t / s2) / (4 pi s2 cos^5 t), per incident power."""
    variance = 0.014
    surface = SeaSurface(
        level=0.0,
        upwind_slope_variance=variance,
        crosswind_slope_variance=variance,
        wind_from=0.4,
        correlation_length=0.1,
    )
    sea, rho = kernel_sea(surface, key=1), ((INDEX - 1) / (INDEX + 1)) ** 2
    for degrees in (0.0, 5.0, 14.4):
        angle = math.radians(degrees)
        ray = (math.sin(angle) * 0.6, math.sin(angle) * 0.8, -math.cos(angle))
        s2 = 2.0 * variance
        closed = rho * math.exp(-(math.tan(angle) ** 2) / s2)
        closed /= 4.0 * math.pi * s2 * math.cos(angle) ** 5
        assert glint_per_steradian(sea, INDEX, *ray) == pytest.approx(closed, rel=1e-12)


def test_glint_against_facets():
    """Of a beam off nadir, what facets throw back into a 3 degree cone, per solid angle.

    Two million drawn facets hold the ratio to 1.5 % (one standard error 0.5 %).
    """
    chance = np.random.default_rng(8)
    up, cross, angle = 0.03, 0.02, math.radians(8.0)
    ray = np.array([math.sin(angle), 0.0, -math.cos(angle)])
    slopes = chance.normal(size=(2_000_000, 2)) * np.sqrt([up, cross])
    normals = np.column_stack([-slopes, np.ones(len(slopes))])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    facing = -normals @ ray
    weight = facing / (normals[:, 2] * math.cos(angle))
    back = ray + 2.0 * facing[:, None] * normals
    cone = math.radians(3.0)
    hits = back @ -ray > math.cos(cone)
    rho = ((INDEX - 1) / (INDEX + 1)) ** 2
    drawn = rho * weight[hits].sum() / len(slopes) / (2 * math.pi * (1 - math.cos(cone)))
    surface = SeaSurface(
        level=0.0,
        upwind_slope_variance=up,
        crosswind_slope_variance=cross,
        wind_from=math.pi / 2,
        correlation_length=0.1,
    )
    closed = glint_per_steradian(kernel_sea(surface, key=1), INDEX, *ray)
    assert drawn / closed == pytest.approx(1.0, abs=0.015)

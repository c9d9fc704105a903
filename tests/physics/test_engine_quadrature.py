"""Light that scatters never or once, seen by a sensor rolled by 25 degrees: against quadrature.

Rays are traced by numpy alone. How densely they fall comes from differences of neighbouring rays.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.constants import speed_of_light

from survey.optics.interface import fresnel_reflectance
from survey.optics.phase import petzold
from survey.optics.water import WaterColumn, petzold_water

DEPTH, REFLECTANCE, INDEX, HEIGHT = 10.0, 0.1, 1.33, 200.0
GAUSS = np.array([-0.5, 0.5]) / np.sqrt(3.0)
THIRDS = (np.s_[:10], np.s_[10:22], np.s_[22:])


@pytest.fixture
def rolled(nadir):
    """Give a pose that looks to the left and somewhat to the north-east."""
    return replace(nadir, roll=np.radians(25.0), pitch=np.radians(-3.0), heading=0.6)


def samples(camera):
    """Return tangents (4, rows, columns) of two by two Gauss points in each pixel."""
    forward, right = camera.pixel_centres()
    step = camera.pixel_tangent * GAUSS
    shifts = [(a, b) for a in step for b in step]
    return (
        np.array([forward + a for a, _ in shifts]),
        np.array([right + b for _, b in shifts]),
    )


def trace(pose, forward, right, depth):
    """Return where rays reach a depth, cosines in air and water, and the ways in both."""
    ray = np.stack([forward, right, np.ones_like(forward)], axis=-1)
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    ray = ray @ pose.body_to_map().T
    cosine = -ray[..., 2]
    cosine_water = np.sqrt(1.0 - (1.0 - cosine**2) / INDEX**2)
    in_air, in_water = HEIGHT / cosine, depth / cosine_water
    place = ray[..., :2] * (in_air + in_water / INDEX)[..., None]
    return place, cosine, cosine_water, in_air, in_water


def falling(pose, forward, right, depth):
    """Return the tangent-plane area per square metre of a level plane at a depth [1/m2]."""
    h = 1e-5
    ahead, behind = (trace(pose, forward + side, right, depth)[0] for side in (h, -h))
    beside, before = (trace(pose, forward, right + side, depth)[0] for side in (h, -h))
    along, across = (ahead - behind) / (2.0 * h), (beside - before) / (2.0 * h)
    return 1.0 / np.abs(along[..., 0] * across[..., 1] - along[..., 1] * across[..., 0])


def there_and_back(engine, pose, forward, right, depth):
    """Return photons lit on a level plane [1/m2] times the etendue behind the surface."""
    _, cosine, _, _, in_water = trace(pose, forward, right, depth)
    passed = 1.0 - np.vectorize(fresnel_reflectance)(cosine, 1.0 / INDEX)
    half_forward, half_right = engine.camera.half_tangents
    density = engine.photo_electrons / (4.0 * half_forward * half_right)
    lit = density * falling(pose, forward, right, depth) * passed
    boresight = 1.0 / np.sqrt(1.0 + forward**2 + right**2)
    etendue = engine.receiver.aperture_area * engine.camera.pixel_tangent**2 * boresight**4
    return (
        lit
        * etendue
        * passed
        / INDEX**2
        * np.exp(-2.0 * engine.water.absorbed(depth) / depth * in_water)
    )


def test_unscattered_light_of_a_rolled_sensor(engine_of, rolled):
    """The bottom echo, left, middle and right, to 0.1 %. When it comes: on average
    to 0.02 ns, a pixel to 0.3 ns (one standard deviation; 64 rays in each)."""
    engine = engine_of(scattering=0.0, wind_speed=0.0, bins=500, group_index=1.36)
    flash = engine.flash(pose=rolled, frame=0)
    forward, right = samples(engine.camera)
    counts = REFLECTANCE / np.pi * there_and_back(engine, rolled, forward, right, DEPTH)
    found = flash.origin("bottom")
    for part in THIRDS:
        expected = counts.mean(axis=0)[part].sum()
        assert found[part].sum() == pytest.approx(expected, rel=0.001)
    _, _, _, in_air, in_water = trace(rolled, forward, right, DEPTH)
    way = 2.0 * (in_air + 1.36 * in_water) / speed_of_light
    expected = (way * counts).sum(axis=0) / counts.sum(axis=0)
    centroid = (found * flash.times).sum(axis=-1) / found.sum(axis=-1)
    inner = np.s_[2:-2, 2:-2]
    off = centroid[inner] - expected[inner]
    assert abs(off.mean()) < 0.02e-9
    assert off.std() < 0.3e-9


FAINT = petzold_water(
    "coastal", absorption=0.02, scattering=1e-4, refractive_index=INDEX, group_index=INDEX
)
UNIFORM = WaterColumn.uniform(FAINT)
# Brighter water that sends back by another phase function, between 4 and 7 m.
LAYERED = UNIFORM.with_layer(
    replace(FAINT, absorption=0.2, scattering=3e-4, phase_function=petzold("clear")),
    top=4.0,
    bottom=7.0,
)


def depths_in(column):
    """Return depths down to the bottom and their weights, eight a layer."""
    tops = [layer.top for layer in column.layers]
    points, weights = np.polynomial.legendre.leggauss(8)
    for top, bottom in pairwise([*tops, DEPTH]):
        half = 0.5 * (bottom - top)
        yield from zip(top + half * (points + 1.0), half * weights, strict=True)


@pytest.mark.parametrize("column", [UNIFORM, LAYERED], ids=["uniform", "layered"])
def test_singly_scattered_light_of_a_rolled_sensor(engine_of, rolled, column):
    """The column down to 10 m, left, middle and right, against the integral over depth: 0.1 %.

    Light and sight go along one ray, which stays 1 / cos as long in a layer as an upright one and
    crosses 1 / cos as little area: leaving out either is 5 to 9 %.
    """
    engine = engine_of(
        column=column, wind_speed=0.0, reflectance=0.0, bins=500, column_spacing=0.02
    )
    forward, right = samples(engine.camera)
    expected = np.zeros(forward.shape)
    for depth, weight in depths_in(column):
        water = column.at(depth)
        backwards = water.scattering * float(water.phase_function.density(np.pi))
        cosine_water = trace(rolled, forward, right, depth)[2]
        light = there_and_back(engine, rolled, forward, right, depth)
        expected += weight * backwards * light / cosine_water**2
    flashes = [engine.flash(pose=rolled, frame=frame) for frame in range(4)]
    found = np.mean([flash.origin("column").sum(axis=-1) for flash in flashes], axis=0)
    for part in THIRDS:
        assert found[part].sum() == pytest.approx(expected.mean(axis=0)[part].sum(), rel=0.001)

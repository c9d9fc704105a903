"""The wavy sheet that kernels take: what it is between the nodes, and where rays meet it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.optimize import brentq

from terrain.height_field import triangulate
from terrain.waves import (
    Swell,
    WaveField,
    WaveLattice,
    WindSea,
    elevation_and_slopes,
    meets_surface,
)
from terrain.waves.lattice import build_lattice

FloatArray = NDArray[np.float64]
HALF = 40.0
LEVEL = 1.5


@pytest.fixture(scope="module")
def field() -> WaveField:
    """Give steep waves that repeat after 128 m, on a slow swell."""
    return WaveField.realised(
        wind_sea=WindSea.fetch_limited(wind_speed=12.0, fetch=10e3),
        wind_from=0.4,
        swell=[Swell(height=1.0, period=9.0, comes_from=2.0)],
        patch=128.0,
        chance=np.random.default_rng(5),
    )


@pytest.fixture(scope="module")
def waves(field: WaveField) -> WaveLattice:
    """Give them over 80 m by 80 m."""
    return field.lattice(time=3.0, level=LEVEL, west=-HALF, east=HALF, south=-HALF, north=HALF)


def elevations(waves: WaveLattice, x: FloatArray, y: FloatArray) -> FloatArray:
    flat = [elevation_and_slopes(waves, a, b)[0] for a, b in zip(x.ravel(), y.ravel(), strict=True)]
    return np.array(flat).reshape(x.shape)


def directions(rng: np.random.Generator, tilt: FloatArray) -> FloatArray:
    """Return downward directions (n, 3) so far off the vertical [rad]."""
    azimuth = rng.uniform(0.0, 2.0 * np.pi, tilt.size)
    level = np.sin(tilt) * [np.cos(azimuth), np.sin(azimuth)]
    return np.column_stack([*level, -np.cos(tilt)])


def test_nodes_are_the_sum_of_the_waves(field: WaveField, waves: WaveLattice) -> None:
    """Wave by wave, without a Fourier transform: also east, north and time are right."""
    rng, time = np.random.default_rng(1), 3.0
    column, row = rng.integers(2, waves.nx - 2, 20), rng.integers(2, waves.ny - 2, 20)
    x, y = waves.x0 + column / waves.per_cell, waves.y0 + row / waves.per_cell
    k = field.bins[::-1] * 2.0 * np.pi / 128.0
    response = np.prod(0.75 + 0.25 * np.cos(k * field.spacing), axis=0)
    phase = np.outer(x, k[0]) + np.outer(y, k[1]) - field.frequency * time
    expected = LEVEL + np.real(np.exp(1j * phase) @ (field.coefficient * response))
    for one in field.swell:
        phase = np.outer(x, one.kx) + np.outer(y, one.ky) - one.frequency * time + one.phase
        expected += np.cos(phase) @ one.amplitude
    assert elevations(waves, x, y) == pytest.approx(expected, abs=1e-9)


def test_between_nodes_it_is_the_quadratic_spline_through_them() -> None:
    """Against scipy's, over the whole of a patch that repeats itself."""
    field = WaveField.realised(
        wind_sea=WindSea.fully_developed(wind_speed=5.0),
        patch=64.0,
        chance=np.random.default_rng(2),
    )
    waves = field.lattice(time=1.0, level=0.0, west=0.0, east=64.0, south=0.0, north=64.0)
    at = np.arange(field.nodes) * field.spacing
    nodes = elevations(waves, *np.meshgrid(at, at))
    x, y = np.random.default_rng(3).uniform(0.0, 64.0, (2, 500))
    theirs = map_coordinates(
        nodes, [y / field.spacing, x / field.spacing], order=2, mode="grid-wrap"
    )
    assert elevations(waves, x, y) == pytest.approx(theirs, abs=1e-9)


def test_slopes_are_those_of_the_elevation_and_have_no_steps(waves: WaveLattice) -> None:
    rng, step = np.random.default_rng(4), 1e-6
    x, y = rng.uniform(-HALF, HALF, (2, 200))
    x[:100] = waves.x0 + (np.round((x[:100] - waves.x0) * waves.per_cell) + 0.5) / waves.per_cell
    for a, b in zip(x, y, strict=True):
        _, slope_x, slope_y = elevation_and_slopes(waves, a, b)
        z = elevations(
            waves, np.array([a - step, a + step, a, a]), np.array([b, b, b - step, b + step])
        )
        assert slope_x == pytest.approx((z[1] - z[0]) / (2.0 * step), abs=1e-5)
        assert slope_y == pytest.approx((z[3] - z[2]) / (2.0 * step), abs=1e-5)


def test_bounds_hold(waves: WaveLattice) -> None:
    x, y = np.random.default_rng(5).uniform(-HALF, HALF, (2, 5000))
    seen = np.array([elevation_and_slopes(waves, a, b) for a, b in zip(x, y, strict=True)])
    assert waves.lowest <= seen[:, 0].min()
    assert seen[:, 0].max() <= waves.highest
    assert np.hypot(seen[:, 1], seen[:, 2]).max() <= waves.steepest


def first_crossing(waves: WaveLattice, start: FloatArray, way: FloatArray, reach: float) -> float:
    """Search every centimetre, then by Brent's method; inf when the ray stays on its side."""

    def gap(t: float) -> float:
        x, y, z = start + way * t
        return float(z - elevation_and_slopes(waves, x, y)[0])

    t = np.arange(0.0, reach, 0.01)
    points = start + way * t[:, None]
    above = points[:, 2] > elevations(waves, points[:, 0], points[:, 1])
    changes = np.nonzero(above[1:] != above[:-1])[0]
    if changes.size == 0:
        return float("inf")
    i = changes[0]
    return float(brentq(gap, t[i], t[i + 1], xtol=1e-12))


@pytest.mark.parametrize("from_above", [True, False])
@pytest.mark.parametrize(("least", "most"), [(0.0, 0.4), (0.9, 1.5)])
def test_rays_meet_the_surface_where_a_search_finds_it(
    waves: WaveLattice, from_above: bool, least: float, most: float
) -> None:
    """Steep rays and rays flatter than the waves, which may meet several: the first counts.

    Some have passed the surface before they start, and meet none.
    """
    rng = np.random.default_rng(6)
    way = directions(rng, rng.uniform(least, most, 60))
    way[:, 2] *= 1.0 if from_above else -1.0
    found = 0
    for direction in way:
        start = np.append(rng.uniform(-15.0, 15.0, 2), LEVEL)
        start -= direction * rng.uniform(-1.0, 6.0)
        expected = first_crossing(waves, start, direction, 20.0)
        t, slope_x, slope_y = meets_surface(waves, *start, *direction, 20.0)
        assert t == pytest.approx(expected, abs=1e-6)
        if np.isfinite(expected):
            x, y, _ = start + direction * expected
            true_slopes = elevation_and_slopes(waves, x, y)[1:]
            assert (slope_x, slope_y) == pytest.approx(true_slopes, abs=2e-3)
            assert meets_surface(waves, *start, *direction, expected - 1e-5)[0] == float("inf")
            found += 1
    assert found > 10


@pytest.mark.parametrize(("height", "fall"), [(0.3, -0.01), (0.3, 0.0), (-0.3, 0.01), (-0.3, 0.0)])
def test_of_several_crests_the_first_is_met(height: float, fall: float) -> None:
    """Waves 1 m high and 8 m long, and rays along them that cut every crest, or every trough."""
    x = np.arange(0.0, 80.0, 0.5)
    crests = np.tile(0.5 * np.sin(2.0 * np.pi * x / 8.0), (9, 1))
    waves = build_lattice(x0=0.0, y0=-2.0, spacing=0.5, level=0.0, coefficients=crests)
    start = np.array([6.0 if height > 0.0 else 10.0, 0.0, height])
    way = np.array([1.0, 0.0, fall]) / np.hypot(1.0, fall)
    expected = first_crossing(waves, start, way, 60.0)
    assert 2.0 < expected < 6.0
    assert meets_surface(waves, *start, *way, 60.0)[0] == pytest.approx(expected, abs=1e-6)


def test_agrees_with_embree_on_the_mesh(waves: WaveLattice) -> None:
    """Triangles of 0.1 m lie up to 0.1^2 / 8 times the curvature, some 1 mm, off the sheet."""
    embree = pytest.importorskip("trimesh.ray.ray_pyembree")
    x, y = np.meshgrid(np.arange(-20.0, 20.05, 0.1), np.arange(-20.0, 20.05, 0.1))
    mesh = triangulate(x, y, elevations(waves, x, y))
    rng = np.random.default_rng(7)
    way = directions(rng, rng.uniform(0.0, 0.5, 2000))
    height = np.where(rng.random(2000) < 0.5, 1.0, -1.0)
    way[:, 2] *= height
    starts = np.column_stack([rng.uniform(-12.0, 12.0, (2000, 2)), LEVEL + 8.0 * height])
    points, rays, _ = embree.RayMeshIntersector(mesh).intersects_location(
        starts, way, multiple_hits=False
    )
    assert rays.size == 2000
    theirs = np.linalg.norm(points - starts[rays], axis=1)
    ours = [meets_surface(waves, *starts[i], *way[i], 100.0)[0] for i in rays]
    assert ours == pytest.approx(theirs, abs=2e-3)


def test_level_water_is_met_where_it_lies() -> None:
    still = WaveField.realised(wind_sea=None, chance=np.random.default_rng(8))
    waves = still.lattice(time=0.0, level=2.0, west=-5.0, east=5.0, south=-5.0, north=5.0)
    assert meets_surface(waves, 0.0, 0.0, 12.0, 0.6, 0.0, -0.8, 100.0) == pytest.approx(
        (12.5, 0.0, 0.0)
    )
    assert meets_surface(waves, 0.0, 0.0, 12.0, 0.6, 0.0, -0.8, 12.4)[0] == float("inf")
    assert meets_surface(waves, 0.0, 0.0, 12.0, 0.6, 0.0, 0.8, 100.0)[0] == float("inf")
    assert meets_surface(waves, 0.0, 0.0, 12.0, 1.0, 0.0, 0.0, 100.0)[0] == float("inf")

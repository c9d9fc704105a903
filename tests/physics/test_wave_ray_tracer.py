"""The independent ray tracer against closed forms, and the kernels against it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from survey.cloud.georeference import pixel_rays
from survey.flight.pose import Pose
from survey.optics.interface import refracted
from survey.sensor.camera import Camera
from terrain.waves import (
    Swell,
    WaveField,
    WaveLattice,
    WindSea,
    elevation_and_slopes,
    meets_surface,
)
from tests.physics.wave_ray_tracer import Elevation, trace

FloatArray = NDArray[np.float64]
INDEX = 1.34
DEPTH = 10.0


def level(x: FloatArray, y: FloatArray) -> FloatArray:
    return 0.0 * (x + y)


def downward(count: int) -> FloatArray:
    return np.tile([0.0, 0.0, -1.0], (count, 1))


def test_level_water() -> None:
    """Snell's law: 30 degrees in air are asin(0.5 / n) in the water."""
    ray = np.array([[0.5, 0.0, -np.sqrt(0.75)]])
    traced = trace(
        position=np.array([0.0, 0.0, 100.0]), rays=ray, elevation=level, crest=0.1, trough=-0.1,
        bottom=-DEPTH, refractive_index=INDEX,
    )  # fmt: skip
    below = np.arcsin(0.5 / INDEX)
    across = 100.0 * np.tan(np.radians(30.0)) + DEPTH * np.tan(below)
    assert traced.end[0] == pytest.approx([across, 0.0, -DEPTH], abs=1e-9)
    assert traced.in_water[0] == pytest.approx(DEPTH / np.cos(below))


def test_tilted_water() -> None:
    """Water that rises to the east by 0.2 turns a vertical ray east, by a - asin(sin a / n)."""
    traced = trace(
        position=np.array([1.0, 2.0, 100.0]), rays=downward(1), elevation=lambda x, y: 0.2 * x,
        crest=5.0, trough=-5.0, bottom=-DEPTH, refractive_index=INDEX,
    )  # fmt: skip
    tilt = np.arctan(0.2)
    turn = tilt - np.arcsin(np.sin(tilt) / INDEX)
    assert traced.entry[0] == pytest.approx([1.0, 2.0, 0.2], abs=1e-9)
    assert traced.end[0, 0] == pytest.approx(1.0 + (DEPTH + 0.2) * np.tan(turn), abs=1e-9)
    again = trace(
        position=np.array([1.0, 2.0, 100.0]), rays=downward(1), elevation=level, crest=0.1,
        trough=-0.1, bottom=-DEPTH - 0.2, refractive_index=INDEX,
        facet_slopes=np.array([[0.2, 0.0]]),
    )  # fmt: skip
    assert again.end[0, :2] == pytest.approx(traced.end[0, :2], abs=1e-9)


def test_a_crest_gathers_rays_in_its_focus() -> None:
    """n / ((n - 1) a k^2) below a crest of amplitude a; there rays near the crest are one."""
    amplitude, k = 0.02, 2.0 * np.pi / 4.0
    focus = INDEX / ((INDEX - 1.0) * amplitude * k**2)

    def wave(x: FloatArray, y: FloatArray) -> FloatArray:
        return np.asarray(amplitude * np.cos(k * x) + 0.0 * y)

    start = np.column_stack([np.linspace(-0.05, 0.05, 11), np.zeros(11), np.full(11, 10.0)])
    traced = trace(
        position=start, rays=downward(11), elevation=wave,
        crest=amplitude, trough=-amplitude, bottom=amplitude - focus, refractive_index=INDEX,
    )  # fmt: skip
    assert np.ptp(traced.end[:, 0]) < 0.01 * np.ptp(start[:, 0])


def scipy_sheet(waves: WaveLattice) -> Elevation:
    """Return scipy's spline through the elevations at the nodes."""
    spacing = 1.0 / waves.per_cell
    east = waves.x0 + np.arange(waves.nx) * spacing
    north = waves.y0 + np.arange(waves.ny) * spacing
    nodes = np.array([[elevation_and_slopes(waves, x, y)[0] for x in east] for y in north])

    def elevation(x: FloatArray, y: FloatArray) -> FloatArray:
        place = [(y - waves.y0) / spacing, (x - waves.x0) / spacing]
        return np.asarray(map_coordinates(nodes, place, order=2, mode="mirror"))

    return elevation


def test_kernels_send_pixel_rays_where_the_tracer_does() -> None:
    """Wind waves and swell, bottom 10 m down: entry and bottom point within a millimetre.

    Without the waves the bottom points lie some decimetres elsewhere.
    """
    field = WaveField.realised(
        wind_sea=WindSea.fetch_limited(wind_speed=7.0, fetch=20e3),
        swell=[Swell(height=0.8, period=8.0, comes_from=0.5)],
        patch=256.0,
        chance=np.random.default_rng(4),
    )
    waves = field.lattice(time=11.0, level=0.0, west=-60.0, east=60.0, south=-60.0, north=60.0)
    elevation = scipy_sheet(waves)
    camera = Camera(rows=8, columns=16, pixel_tangent=0.032, long_side="along")
    pose = Pose(position=np.array([1.0, -2.0, 200.0]), roll=0.02, pitch=-0.01, heading=1.0)
    rays = pixel_rays(camera=camera, pose=pose).reshape(-1, 3)
    traced = trace(
        position=pose.position, rays=rays, elevation=elevation, crest=waves.highest,
        trough=waves.lowest, bottom=-DEPTH, refractive_index=INDEX,
    )  # fmt: skip
    for ray, entry, end in zip(rays, traced.entry, traced.end, strict=True):
        t, slope_x, slope_y = meets_surface(waves, *pose.position, *ray, 300.0)
        place = pose.position + t * ray
        assert place == pytest.approx(entry, abs=1e-5)
        norm = 1.0 / np.sqrt(1.0 + slope_x**2 + slope_y**2)
        way = np.array(refracted(*ray, -slope_x * norm, -slope_y * norm, norm, 1.0 / INDEX))
        assert place + way * (-DEPTH - place[2]) / way[2] == pytest.approx(end, abs=2e-3)
    still = trace(
        position=pose.position, rays=rays, elevation=level, crest=0.1, trough=-0.1,
        bottom=-DEPTH, refractive_index=INDEX,
    )  # fmt: skip
    moved = np.linalg.norm(traced.end - still.end, axis=1)
    assert 0.1 < np.sqrt((moved**2).mean()) < 1.0

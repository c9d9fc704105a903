"""The fast engine over resolved waves: against rays one by one, closed forms, and the level sea."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.georeference import bend_at_waves, pixel_rays
from survey.flight.pose import Pose
from survey.optics.interface import fresnel_reflectance
from survey.transport.engine import Engine
from terrain.sea_surface import SeaSurface
from terrain.waves import Swell, WaveField, WindSea
from tests.physics.wave_light import elevation, facets, into_water, slopes_at, upright
from tests.physics.wave_ray_tracer import trace

FloatArray = NDArray[np.float64]
DEPTH, SIDE = 10.0, 8
FEW = {"shape": (SIDE, SIDE), "pixel_tangent": 0.01}
INNER = np.s_[1:-1, 1:-1]
BOX = {"west": -40.0, "east": 40.0, "south": -40.0, "north": 40.0}
CELL, CELLS = 0.1, 640
RAYS, RAYS_OF_PIXEL = 2_000_000, 8000


def wavy_sea(wind_speed: float = 7.0, *swell: Swell, **changes: Any) -> SeaSurface:
    given = {"patch": 256.0, "chance": np.random.default_rng(1)} | changes
    wind = WindSea.fetch_limited(wind_speed=wind_speed, fetch=20e3)
    waves = WaveField.realised(wind_sea=wind, wind_from=0.4, swell=swell, **given)
    return SeaSurface.from_wind(level=0.0, wind_speed=wind_speed, wind_from=0.4, waves=waves)


def swell_alone(height: float, wind_speed: float = 5.0) -> SeaSurface:
    swell = Swell(height=height, period=6.0, comes_from=1.0)
    waves = WaveField.realised(wind_sea=None, swell=[swell], chance=np.random.default_rng(2))
    return SeaSurface.from_wind(level=0.0, wind_speed=wind_speed, wind_from=0.4, waves=waves)


def light_on_the_bottom(engine: Engine, pose: Pose, chance: np.random.Generator) -> FloatArray:
    """Return the photo-electrons' worth of light on a square metre of level bottom, in cells."""
    waves, light = engine.surface.sheet(time=0.0, **BOX), np.zeros((CELLS, CELLS))
    forward, right = engine.camera.half_tangents
    for _ in range(4):
        tangents = (2.0 * chance.random((RAYS // 4, 2)) - 1.0) * [right, forward]
        rays = into_water(
            waves=waves, sea=engine.surface, position=pose.position, tangents=tangents,
            refractive_index=engine.water.refractive_index, chance=chance,
        )  # fmt: skip
        end, kept = ends(rays, engine.water.surface.absorption)
        edge = 0.5 * CELL * CELLS
        light += np.histogram2d(
            end[:, 1], end[:, 0], bins=CELLS, range=[[-edge, edge]] * 2, weights=kept
        )[0]
    return light * engine.photo_electrons / (RAYS * CELL**2)


def ends(rays: Any, absorption: float) -> tuple[FloatArray, FloatArray]:
    length = (rays.place[:, 2] + DEPTH) / -rays.direction[:, 2]
    kept = rays.passed * np.exp(-absorption * length)
    return rays.place + length[:, None] * rays.direction, kept


def expected_echo(engine: Engine, pose: Pose, reflectance: float) -> FloatArray:
    """Return the bottom echo of every pixel: its own rays see what the laser's have lit."""
    chance = np.random.default_rng(9)
    light, waves = light_on_the_bottom(engine, pose, chance), engine.surface.sheet(time=0.0, **BOX)
    forward, right = engine.camera.pixel_centres()
    tangent, index = engine.camera.pixel_tangent, engine.water.refractive_index
    result = np.empty((SIDE, SIDE))
    for row, column in np.ndindex(SIDE, SIDE):
        middle = np.array([right[row, column], forward[row, column]])
        tangents = middle + (chance.random((RAYS_OF_PIXEL, 2)) - 0.5) * tangent
        rays = into_water(
            waves=waves, sea=engine.surface, position=pose.position, tangents=tangents,
            refractive_index=index, chance=chance,
        )  # fmt: skip
        end, kept = ends(rays, engine.water.surface.absorption)
        at = np.floor(end[:, :2] / CELL).astype(int) + CELLS // 2
        seen = kept * light[at[:, 1], at[:, 0]] / (1.0 + (tangents**2).sum(axis=1)) ** 2
        result[row, column] = seen.mean()
    return result * reflectance / np.pi * engine.receiver.aperture_area * tangent**2 / index**2


def test_the_bottom_echo_is_that_of_rays_one_by_one(engine_of: Any, nadir: Pose) -> None:
    """Without scattering, 10 m under waves of a wind of 7 m/s.

    Rationale: rays of laser and pixels through the same waves, forwards, counted in cells.
    Expected: 0.5 % over the inner pixels together and 1 % r.m.s. each, while the waves make them
    differ by 19 %; 12 % more than on the level sea, for light that goes down and up by the same
    crest is gathered twice (measured: 12.7 %).
    """
    changes = {"scattering": 0.0, "walks_per_pixel": 16000, **FEW}
    engine = engine_of(surface=wavy_sea(), **changes)
    echo = engine.flash(pose=nadir, frame=0).origin("bottom").sum(axis=-1)[INNER]
    expected = expected_echo(engine, nadir, 0.1)[INNER]
    ratio = echo / expected
    assert expected.std() / expected.mean() > 0.1
    assert echo.sum() / expected.sum() == pytest.approx(1.0, abs=0.005)
    assert ratio.std() < 0.01
    level = engine_of(surface=SeaSurface.from_wind(level=0.0, wind_speed=7.0, wind_from=0.4),
                      **changes)  # fmt: skip
    flat = level.flash(pose=nadir, frame=0).origin("bottom").sum(axis=-1)[INNER]
    assert echo.sum() / flat.sum() == pytest.approx(1.12, abs=0.02)


@pytest.mark.parametrize("water", ["coastal", "harbor"])
def test_waves_of_a_millimetre_are_the_level_sea(engine_of: Any, nadir: Pose, water: str) -> None:
    """Expected: bottom and column of all pixels together within 1 %, each bin's r.m.s. too."""
    changes = {"water": water, "depth": 5.0, "walks_per_pixel": 2000, **FEW}
    waves = engine_of(surface=swell_alone(1e-3), **changes).flash(pose=nadir, frame=0)
    level = SeaSurface.from_wind(level=0.0, wind_speed=5.0, wind_from=0.4)
    flat = engine_of(surface=level, **changes).flash(pose=nadir, frame=0)
    for origin in ("bottom", "column"):
        one, other = (f.origin(origin).sum(axis=(0, 1)) for f in (waves, flat))
        assert one.sum() / other.sum() == pytest.approx(1.0, abs=0.01)
        assert np.abs(one - other).max() < 0.015 * other.max()
    one, other = (f.origin("surface").sum(axis=-1) for f in (waves, flat))
    assert one == pytest.approx(other, rel=0.01)


def test_the_column_keeps_its_light_under_swell(engine_of: Any, nadir: Pose) -> None:
    """Swell moves the column up and down and hardly gathers light: its sum stays within 2 %."""
    changes = {"depth": 30.0, "walks_per_pixel": 4000, **FEW}
    waves = engine_of(surface=swell_alone(0.5), **changes).flash(pose=nadir, frame=0)
    level = SeaSurface.from_wind(level=0.0, wind_speed=5.0, wind_from=0.4)
    flat = engine_of(surface=level, **changes).flash(pose=nadir, frame=0)
    one, other = (f.origin("column").sum() for f in (waves, flat))
    assert one / other == pytest.approx(1.0, abs=0.02)


def test_the_surface_echo_comes_from_the_facets_that_face_the_sensor(
    engine_of: Any, nadir: Pose
) -> None:
    """I rho p(s* - s) A / (4 cos^4 t (-w . N) r^2), averaged over each pixel, foam beside it.

    Expected: within 1 % r.m.s. a pixel, 0.5 % together, at the time of the wave.
    """
    calm = wavy_sea()
    sea = SeaSurface(
        level=0.0, upwind_slope_variance=calm.upwind_slope_variance,
        crosswind_slope_variance=calm.crosswind_slope_variance, wind_from=0.4, waves=calm.waves,
        whitecap_coverage=0.05,
    )  # fmt: skip
    engine = engine_of(surface=sea, pulse_fwhm=2e-9, **FEW)
    flash = engine.flash(pose=nadir, frame=0).origin("surface")
    forward, right = engine.camera.pixel_centres()
    offset = (np.arange(16) + 0.5) / 16.0 - 0.5
    ahead, aside = np.meshgrid(offset, offset) * np.array(engine.camera.pixel_tangent)
    tangents = np.stack([right[..., None, None] + aside, forward[..., None, None] + ahead], -1)
    echo, late = facing_echo(sea, tangents.reshape(-1, 2), engine)
    echo, late = (v.reshape(SIDE, SIDE, -1) for v in (echo, late))
    ratio = flash.sum(axis=-1) / echo.mean(axis=-1)
    assert flash.sum() / echo.mean(axis=-1).sum() == pytest.approx(1.0, abs=0.005)
    assert ratio.std() < 0.01
    bins = 1.3e-6 + 1e-9 * (np.arange(flash.shape[-1]) + 0.5)
    time = (flash * bins).sum(axis=-1) / flash.sum(axis=-1)
    assert time == pytest.approx((echo * late).sum(-1) / echo.sum(-1), abs=0.15e-9)


def facing_echo(sea: SeaSurface, tangents: FloatArray, engine: Engine) -> tuple[FloatArray, ...]:
    """Return the echo of a pixel's light, were it all sent along each ray, and when it comes."""
    waves = sea.sheet(time=0.0, **BOX)
    rays = np.column_stack([tangents, -np.ones(len(tangents))])
    drop = np.full(len(rays), 200.0)
    for _ in range(8):
        drop = 200.0 - elevation(waves, *(rays[:, :2] * drop[:, None]).T)
    place = rays * drop[:, None]
    stretch = np.linalg.norm(rays, axis=1)
    length, unit = stretch * drop, rays / stretch[:, None]
    slopes = slopes_at(waves, place)
    remaining = np.array(sea.remaining_slope_variance)
    wind = np.array([np.sin(0.4), np.cos(0.4)])
    off = tangents - slopes
    parts = np.column_stack([off @ wind, off @ [wind[1], -wind[0]]])
    density = np.exp(-0.5 * (parts**2 / remaining).sum(axis=1)) / (
        2.0 * np.pi * np.sqrt(remaining.prod())
    )
    onto = -(unit * upright(slopes)).sum(axis=1)
    rho = fresnel_reflectance(1.0, 1.0 / engine.water.refractive_index)
    foam = 0.22 / np.pi * onto / np.linalg.norm(upright(slopes), axis=1)
    back = 0.95 * rho * density * stretch**4 / (4.0 * onto) + 0.05 * foam
    sent = engine.photo_electrons / SIDE**2 * engine.receiver.aperture_area / stretch
    return sent * back / length**2, 2.0 * length / speed_of_light


def test_the_true_target_is_where_an_independent_ray_ends(engine_of: Any, nadir: Pose) -> None:
    """Expected: place on the waves and on a level bottom within 0.1 mm, bent by decimetres."""
    sea = wavy_sea(10.0, Swell(height=1.5, period=8.0, comes_from=1.0))
    engine = engine_of(surface=sea, **FEW)
    waves = sea.sheet(time=3.0, **BOX)
    rays = pixel_rays(camera=engine.camera, pose=nadir)
    path = bend_at_waves(
        position=nadir.position,
        rays=rays,
        waves=waves,
        refractive_index=engine.water.refractive_index,
    )
    end = path.entry - path.direction * ((path.entry[..., 2:] + DEPTH) / path.direction[..., 2:])
    traced = trace(
        position=nadir.position, rays=rays.reshape(-1, 3),
        elevation=lambda x, y: elevation(waves, x.ravel(), y.ravel()).reshape(x.shape),
        crest=waves.highest, trough=waves.lowest, bottom=-DEPTH,
        refractive_index=engine.water.refractive_index,
    )  # fmt: skip
    assert path.entry.reshape(-1, 3) == pytest.approx(traced.entry, abs=1e-4)
    assert end.reshape(-1, 3) == pytest.approx(traced.end, abs=1e-4)
    assert np.std(traced.end[:, 0] - 1.05 * rays.reshape(-1, 3)[:, 0] * 200.0) > 0.1


def test_waves_move_with_the_time_of_the_flash(engine_of: Any, nadir: Pose) -> None:
    engine = engine_of(surface=wavy_sea(), walks_per_pixel=16, **FEW)
    flashes = [engine.flash(pose=nadir, frame=0, time=time) for time in (0.0, 0.0, 1.0)]
    first, again, later = (flash.origin("surface").sum(axis=-1) for flash in flashes)
    assert (first == again).all()
    assert np.corrcoef(first.ravel(), later.ravel())[0, 1] < 0.5


def test_facets_have_what_no_wave_resolves() -> None:
    sea = wavy_sea()
    slopes = facets(sea, 100_000, np.random.default_rng(3))
    assert slopes.var(axis=0).sum() == pytest.approx(sum(sea.remaining_slope_variance), rel=0.02)

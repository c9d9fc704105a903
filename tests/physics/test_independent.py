"""The engine against numbers that were worked out apart from it, by quadrature.

Source: an independent derivation from the radiometry alone: laser 1 J spread evenly over the
tangent plane, aperture radius 5 mm, efficiency 0.2, height 200 m, coastal a = 0.179 1/m, n = 1.33,
Lambertian bottom 0.1 at 10 m; 8 x 8 Gauss points in each pixel. Photo-electrons of single pixels.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.constants import speed_of_light

from survey.cloud.georeference import bend_at_surface, pixel_rays
from survey.optics.background import Sky, background_power

FLAT = {(15, 31): 229.735, (5, 10): 206.407, (20, 50): 214.583}
TILTED = {(15, 31): 239.638, (5, 10): 729.807, (20, 50): 120.591}
GLINT = {(15, 31): 29005.8, (0, 0): 2283.33, (5, 10): 8924.47, (20, 50): 14114.3}
SCATTERED = {(15, 31): 187.4, (20, 50): 175.5}
FLASHES = 6


def around(values, pixel, reach=1):
    """Return the mean over a pixel and its neighbours, which is steadier than one pixel."""
    row, column = pixel
    near = np.s_[row - reach : row + reach + 1, column - reach : column + reach + 1]
    return values[near].mean()


def bottom_counts(engine, nadir):
    flashes = [engine.flash(pose=nadir, frame=frame) for frame in range(FLASHES)]
    return np.mean([flash.origin("bottom").sum(axis=-1) for flash in flashes], axis=0)


@pytest.mark.parametrize(("gradient", "expected"), [(0.0, FLAT), (0.2, TILTED)])
def test_unscattered_bottom_echo(engine_of, nadir, gradient, expected):
    """Level, and falling by 0.2 to the east: left and right differ six times. Each pixel: 0.5 %."""
    engine = engine_of(scattering=0.0, wind_speed=0.0, gradient=gradient)
    counts = bottom_counts(engine, nadir)
    for pixel, value in expected.items():
        assert counts[pixel] == pytest.approx(value, rel=0.005)


def test_scattered_bottom_echo(engine_of, nadir):
    """65 times the unscattered echo, by an independent Monte Carlo (errors 0.2-0.4 %): 2 %.

    Eleven by eleven pixels hold the engine's own error below 0.5 %; the echo is even there.
    """
    counts = bottom_counts(engine_of(wind_speed=0.0), nadir)
    for pixel, value in SCATTERED.items():
        assert around(counts, pixel, reach=5) == pytest.approx(value, rel=0.02)


def test_glint_of_single_pixels(engine_of, nadir):
    """Wind 5 m/s from the north: within 0.3 %, 16 directions in a pixel against 64."""
    engine = engine_of(walks_per_pixel=8)
    counts = engine.flash(pose=nadir, frame=0).origin("surface").sum(axis=-1)
    for pixel, value in GLINT.items():
        assert counts[pixel] == pytest.approx(value, rel=0.003)


def test_singly_scattered_column(engine_of, nadir):
    """Slant paths of 1-2, 4-5 and 8-9 m in weakly scattering water: b p(180) exp(-2 c s).

    b = 0.0002 1/m under a = 0.3978 1/m: c as in coastal water, hardly any second scattering. The
    independent numbers were made for b = 0.219 and are scaled by 0.0002 / 0.219. The middle's
    column within 3 %, without the pulse's width.
    """
    engine = engine_of(
        reflectance=0.0,
        absorption=0.3978,
        scattering=0.0002,
        wind_speed=0.0,
        pulse_fwhm=1e-15,
        column_spacing=0.05,
        walks_per_pixel=16,
    )
    flash = engine.flash(pose=nadir, frame=0)
    path = bend_at_surface(
        position=nadir.position,
        rays=pixel_rays(camera=engine.camera, pose=nadir),
        level=0.0,
        refractive_index=1.33,
    )
    slant = 0.5 * speed_of_light / 1.33 * (flash.times - path.air_time[..., None])
    column = flash.origin("column")
    for (near, far), value in (((1, 2), 88.438), ((4, 5), 7.9407), ((8, 9), 0.31938)):
        inside = np.where((slant >= near) & (slant < far), column, 0.0).sum(axis=-1)
        expected = value * 0.0002 / 0.219
        assert inside[11:21, 27:37].mean() == pytest.approx(expected, rel=0.03)


def test_background_counts():
    """51.79 W/(m2 um sr) of eq (6) through 1 nm on 5 mm: 0.13944 counts a nanosecond."""
    radiance = Sky(
        zenith=np.radians(20.0),
        wind_speed=5.0,
        optical_thickness=0.3,
        solar_irradiance=1.95e9,
        legendre_moment=1.5,
        water_reflectance=0.0097,
    ).radiance()
    assert radiance == pytest.approx(0.0517895e9, rel=1e-5)
    power = background_power(
        radiance=radiance,
        filter_width=1e-9,
        aperture_area=np.pi * 0.005**2,
        solid_angle=0.008**2,
    )
    photons = power / (6.62607015e-34 * speed_of_light / 532e-9)
    assert 0.2 * photons * 1e-9 == pytest.approx(0.139436, rel=1e-4)

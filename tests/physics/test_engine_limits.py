"""The fast engine where the answer is known: closed forms and properties that hold exactly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.constants import speed_of_light

from survey.cloud.georeference import pixel_rays
from survey.optics.interface import fresnel_reflectance
from survey.optics.phase import molecular

DEPTH, REFLECTANCE, INDEX, HEIGHT = 10.0, 0.1, 1.33, 200.0
INNER = np.s_[4:28, 8:56]


def clear_water_echo(engine):
    """Bottom echo of every pixel without scattering, by quadrature-free geometry.

    Irradiance on the level bottom is a pixel's energy over the area it lights, which is the
    Jacobian of the refracted footprint; the way back is that of its radiance, times T / n^2.
    """
    forward, right = engine.camera.pixel_centres()
    tangent = np.hypot(forward, right)
    cosine = 1.0 / np.sqrt(1.0 + tangent**2)
    in_water = np.sqrt(1.0 - (1.0 - cosine**2) / INDEX**2)
    passed = 1.0 - np.vectorize(fresnel_reflectance)(cosine, 1.0 / INDEX)
    kept = np.exp(-engine.water.surface.absorption * DEPTH / in_water)

    def reach(t):
        sine = t / np.sqrt(1.0 + t**2) / INDEX
        return HEIGHT * t + DEPTH * sine / np.sqrt(1.0 - sine**2)

    stretch = (reach(tangent + 1e-6) - reach(tangent - 1e-6)) / 2e-6
    lit_area = reach(tangent) / tangent * stretch * engine.camera.pixel_tangent**2
    pixel_energy = engine.photo_electrons / 2048
    radiance = REFLECTANCE / np.pi * pixel_energy * passed * kept / lit_area
    etendue = engine.receiver.aperture_area * engine.camera.pixel_tangent**2 * cosine**4
    return radiance * kept * passed / INDEX**2 * etendue


def test_no_scattering_gives_the_lidar_equation(engine_of, nadir):
    """P = E_pixel T^2 (rho / pi) A / (n H + z)^2 exp(-2 c z) at nadir, within 0.5 %.

    Rationale: with b = 0 light goes down and comes back, nothing else.
    Expected: pixels around nadir by that; all but those at the edge within 0.02 % together and
    0.1 % each (one standard deviation 0.01 %).
    Source: the lidar equation; for other pixels the Jacobian of the refracted footprint.
    """
    engine = engine_of(scattering=0.0, wind_speed=0.0, walks_per_pixel=128)
    flash = engine.flash(pose=nadir, frame=0)
    echo = flash.origin("bottom").sum(axis=-1)
    transmitted = 1.0 - ((INDEX - 1.0) / (INDEX + 1.0)) ** 2
    area = engine.receiver.aperture_area
    closed = engine.photo_electrons / 2048 * transmitted**2 * REFLECTANCE / np.pi
    closed *= area / (INDEX * HEIGHT + DEPTH) ** 2
    closed *= np.exp(-2.0 * engine.water.surface.absorption * DEPTH)
    assert echo[14:18, 28:36].mean() == pytest.approx(closed, rel=0.005)
    expected = clear_water_echo(engine)[INNER]
    assert echo[INNER].sum() == pytest.approx(expected.sum(), rel=2e-4)
    assert echo[INNER] == pytest.approx(expected, rel=1e-3)
    assert flash.origin("column").sum() == 0.0


EARLY = {
    "as the paper's": {"depth": 10.0},
    "many scatterings": {"water": "harbor", "depth": 10.0},
    "wide scattering": {
        "depth": 40.0, "absorption": 0.05, "scattering": 0.05, "phase_function": molecular(),
        "bins": 700,
    },
}  # fmt: skip


@pytest.mark.parametrize("case", EARLY)
def test_nothing_arrives_too_early(engine_of, nadir, case):
    """No light of the bottom before the straight way there and back, none of the column
    before the surface; nowhere less than none.

    Rationale: an approximation of a path's length that goes wrong for slanting legs makes light
    that comes early, and hardly absorbed: few paths, and as much light as all others together.
    Expected: none at all of half a million paths; a fault in one of 80,000 is found with 99.8 %.
    One bin is left out, as the impulse response is shared over two neighbours.
    Source: geometry.
    """
    engine = engine_of(
        pulse_fwhm=1e-15, wind_speed=0.0, walks_per_pixel=128, shape=(16, 32), **EARLY[case]
    )
    depth = EARLY[case]["depth"]
    to_surface = 2.0 * HEIGHT / speed_of_light
    to_bottom = to_surface + 2.0 * INDEX * depth / speed_of_light
    for frame in range(8):
        flash = engine.flash(pose=nadir, frame=frame)
        for origin, earliest in (("column", to_surface), ("bottom", to_bottom)):
            early = flash.times < earliest - engine.receiver.bin_width
            assert flash.origin(origin)[..., early].sum() == 0.0
            assert flash.origin(origin).sum() > flash.origin(origin).min() == 0.0


def column_above(engine, pose, frames):
    """Return the column's light of flashes from 1.5 to 10 m, by the time of its echo."""
    flashes = [engine.flash(pose=pose, frame=frame) for frame in range(frames)]
    depth = 0.5 * speed_of_light / INDEX * (flashes[0].times - 2.0 * HEIGHT / speed_of_light)
    layer = (depth > 1.5) & (depth < 10.0)
    return np.array([flash.origin("column")[..., layer].sum() for flash in flashes], float)


def test_a_black_bottom_far_below_changes_nothing_above(engine_of, nadir):
    """The column of isolated pixels of 0.4 m, 1.5 to 10 m deep, in clear water over a bottom at
    20 or at 90 m: the same within 1.5 %, by equivalence.

    Rationale: whether walks touch the bottom far aside must not turn the light that meets them
    above; in a narrow pixel light that enters a little aside is dark.
    Expected: equal, as light from below 20 m comes later. Error 0.2 %, interval of 99.9 %: a fault
    of 2.5 % fails with 99 %.
    Source: causality.
    """
    narrow = {
        "water": "clear", "illumination": "isolated", "shape": (4, 8), "pixel_tangent": 0.002,
        "reflectance": 0.0, "pulse_fwhm": 1e-15, "wind_speed": 0.0, "walks_per_pixel": 1024,
    }  # fmt: skip
    near, far = (
        column_above(engine_of(depth=depth, **narrow), nadir, 24) for depth in (20.0, 90.0)
    )
    error = np.hypot(near.std(ddof=1), far.std(ddof=1)) / 24**0.5 / far.mean()
    assert abs(near.mean() / far.mean() - 1.0) + 3.5 * error < 0.015


def test_black_bottom_sends_nothing(engine_of, nadir):
    engine = engine_of(reflectance=0.0, walks_per_pixel=16)
    flash = engine.flash(pose=nadir, frame=0)
    assert flash.origin("bottom").sum() == 0.0
    assert flash.origin("column").sum() > 0.0


@pytest.mark.parametrize(("water", "depth"), [("coastal", 10.0), ("harbor", 30.0)])
def test_energy_of_the_walks_from_the_pixels_balances(engine_of, nadir, water, depth):
    """Launched = reflected + absorbed + escaped + aside + late + in the bottom + roulette."""
    flash = engine_of(water=water, depth=depth, walks_per_pixel=16).flash(pose=nadir, frame=0)
    ledger = dict(flash.ledger)
    launched = ledger.pop("launched") + ledger.pop("facet weighting")
    assert sum(ledger.values()) == pytest.approx(launched, rel=1e-9)
    assert ledger["left sideways"] < 1e-3 * launched


def test_pulse_energy_scales_exactly(engine_of, nadir):
    """Eight times the energy gives exactly eight times the photo-electrons."""
    few = {"walks_per_pixel": 16}
    plain = engine_of(**few).flash(pose=nadir, frame=3).photo_electrons
    strong = engine_of(pulse_energy=8.0, **few).flash(pose=nadir, frame=3).photo_electrons
    assert np.array_equal(strong, 8.0 * plain)


def test_similar_scenes_give_the_same_echo(engine_of, nadir):
    """All lengths and times doubled, a and b halved: the same histories in the same bins."""
    few = {"walks_per_pixel": 16}
    plain = engine_of(absorption=0.18, scattering=0.2, **few)
    large = engine_of(absorption=0.09, scattering=0.1, scale=2.0, **few)
    twice = replace(nadir, position=2.0 * nadir.position)
    echoes = plain.flash(pose=nadir, frame=1).photo_electrons
    again = large.flash(pose=twice, frame=1).photo_electrons
    assert np.allclose(again, echoes, rtol=1e-4, atol=1e-6 * echoes.max(axis=(1, 2, 3)).min())


def test_the_same_flash_draws_the_same_light(engine_of, nadir):
    few = {"walks_per_pixel": 16}
    first, second = (engine_of(**few).flash(pose=nadir, frame=5) for _ in range(2))
    assert np.array_equal(first.photo_electrons, second.photo_electrons)
    assert np.array_equal(first.variance, second.variance)


def test_isolated_pixels_see_less_than_flooded_ones(engine_of, nadir):
    """A neighbour's light adds to a flooded pixel: the bottom echo of 10 m coastal water."""
    few = {"walks_per_pixel": 32}
    flood = engine_of(**few).flash(pose=nadir, frame=2).photo_electrons
    isolated = engine_of(illumination="isolated", **few).flash(pose=nadir, frame=2).photo_electrons
    gain = flood[2].sum() / isolated[2].sum()
    assert 1.5 < gain < 6.0
    assert np.array_equal(flood[0], isolated[0])


def test_still_water_is_a_mirror(engine_of, nadir):
    """I0 rho A / (2 H)^2 in the four pixels that touch nadir, I0 launched per steradian down."""
    engine = engine_of(wind_speed=0.0, walks_per_pixel=8)
    surface = engine.flash(pose=nadir, frame=0).origin("surface").sum(axis=-1)
    intensity = engine.photo_electrons / (0.512 * 0.256)
    rho = ((INDEX - 1.0) / (INDEX + 1.0)) ** 2
    closed = intensity * rho * engine.receiver.aperture_area / (2.0 * HEIGHT) ** 2
    assert surface.sum() == pytest.approx(closed, rel=1e-4)
    assert surface[15:17, 31:33].sum() == surface.sum()


@pytest.mark.parametrize(("roll", "pitch"), [(3.0, 1.0), (0.7, -4.0), (-2.0, 5.0)])
def test_the_mirror_s_image_is_seen_at_nadir(engine_of, nadir, roll, pitch):
    """All of it in the pixel whose ray points straight down, however the sensor is turned."""
    engine = engine_of(wind_speed=0.0, walks_per_pixel=8)
    pose = replace(nadir, roll=np.radians(roll), pitch=np.radians(pitch), heading=1.0)
    surface = engine.flash(pose=pose, frame=0).origin("surface").sum(axis=-1)
    straight_down = pixel_rays(camera=engine.camera, pose=pose)[..., 2].argmin()
    assert surface.argmax() == straight_down
    assert surface.max() == surface.sum() > 0.0


def test_deeper_is_later_and_on_its_side(engine_of, nadir):
    """The bottom falls to the east; flying north, rows 16 to 31 look to the right: east."""
    engine = engine_of(gradient=0.05, wind_speed=0.0, walks_per_pixel=16)
    flash = engine.flash(pose=nadir, frame=0)
    echo = flash.origin("bottom")[:, 24:40]
    centroid = (echo * flash.times).sum(axis=(1, 2)) / echo.sum(axis=(1, 2))
    assert centroid[28] > centroid[16] > centroid[4]

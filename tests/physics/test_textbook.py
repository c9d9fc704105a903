"""The textbook engine against closed forms, and the fast engine against it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.constants import speed_of_light

from survey.optics.interface import fresnel_reflectance
from survey.optics.phase import henyey_greenstein, petzold
from survey.optics.water import Water, petzold_water
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser
from survey.sensor.receiver import Receiver
from survey.transport.engine import Engine
from survey.transport.flat_water import (
    density_between,
    density_table,
    solid_angle_per_area,
    tangent_in_air,
)
from survey.transport.settings import TransportSettings
from survey.transport.textbook import textbook_flash
from terrain.generators import Ground, plane
from terrain.sea_surface import SeaSurface
from tests.physics.conftest import FRAME, level_pose

DEPTH, REFLECTANCE, INDEX, HEIGHT, EFFICIENCY = 10.0, 0.1, 1.33, 200.0, 0.2
COASTAL = petzold_water("coastal", refractive_index=INDEX, group_index=INDEX)
LASER = Laser(pulse_energy=1.0, wavelength=532e-9, pulse_fwhm=10e-9)
CAMERA = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
RECEIVER = Receiver(
    aperture_radius=0.005,
    filter_width=1e-9,
    optics_transmission=1.0,
    gate_start=1.3e-6,
    bin_width=1e-9,
    bins=300,
)
PHOTONS_A_PIXEL = LASER.photons_per_pulse * EFFICIENCY / (CAMERA.rows * CAMERA.columns)
NADIR, EDGE = np.s_[14:18, 28:36], np.s_[8:24, [0, 1, 62, 63]]


def flash_of(*, water: Water = COASTAL, **changes: Any):
    """Trace one flash of 10 m of water, 200 m below a level sensor."""
    given = {
        "depth": DEPTH,
        "reflectance": REFLECTANCE,
        "laser": LASER,
        "camera": CAMERA,
        "receiver": RECEIVER,
        "pose": level_pose(),
        "photo_electrons_per_photon": EFFICIENCY,
        "walks": 1_000_000,
        "seed": 1,
        "frame": 0,
    }
    return textbook_flash(water=water, **given | changes)


def straight_there_and_back(depth, attenuation):
    """Return what a pixel gets from a depth, per steradian and cosine that is sent there.

    Light falls on the pixel's footprint at that depth, whose area is the Jacobian of the refracted
    footprint, and returns as radiance: T / n^2 and the pixel's etendue. Slant path, too.
    """
    forward, right = CAMERA.pixel_centres()
    tangent = np.hypot(forward, right)
    cosine = 1.0 / np.sqrt(1.0 + tangent**2)
    in_water = np.sqrt(1.0 - (1.0 - cosine**2) / INDEX**2)
    passed = 1.0 - np.vectorize(fresnel_reflectance)(cosine, 1.0 / INDEX)

    def reach(t):
        sine = t / np.sqrt(1.0 + t**2) / INDEX
        return HEIGHT * t + depth * sine / np.sqrt(1.0 - sine**2)

    stretch = (reach(tangent + 1e-6) - reach(tangent - 1e-6)) / 2e-6
    lit_area = reach(tangent) / tangent * stretch * CAMERA.pixel_tangent**2
    etendue = RECEIVER.aperture_area * CAMERA.pixel_tangent**2 * cosine**4
    kept = np.exp(-2.0 * attenuation * depth / in_water)
    back = PHOTONS_A_PIXEL * passed**2 * kept / lit_area / INDEX**2 * etendue
    return back, in_water


def test_no_scattering_gives_the_lidar_equation():
    """b = 0: P = E_pixel T^2 (rho / pi) A / (n H + z)^2 exp(-2 c z), within 2 %.

    Nadir by that formula, the far ends of the frame by the Jacobian of the refracted footprint;
    15,600 and 31,300 photons fall there. All pixels together within 0.1 %: each photon brings
    nearly the same.
    """
    clear = replace(COASTAL, scattering=0.0)
    flash = flash_of(water=clear)
    echo = flash.photo_electrons[1].sum(axis=-1)
    passed = 1.0 - ((INDEX - 1.0) / (INDEX + 1.0)) ** 2
    closed = PHOTONS_A_PIXEL * passed**2 * REFLECTANCE / np.pi * RECEIVER.aperture_area
    closed *= np.exp(-2.0 * clear.absorption * DEPTH) / (INDEX * HEIGHT + DEPTH) ** 2
    expected = REFLECTANCE / np.pi * straight_there_and_back(DEPTH, clear.absorption)[0]
    assert echo[NADIR].mean() == pytest.approx(closed, rel=0.02)
    assert echo[EDGE].mean() == pytest.approx(expected[EDGE].mean(), rel=0.02)
    assert expected[EDGE].mean() < 0.85 * closed
    assert echo.sum() == pytest.approx(expected.sum(), rel=0.001)
    assert flash.photo_electrons[0].sum() == 0.0


def test_the_bottom_is_timed_by_the_group_index():
    """A pixel's light comes at 2 (H / cos + n_group z / cos_w) / c, centroid within 0.05 ns."""
    slow = replace(COASTAL, scattering=0.0, group_index=1.36)
    flash = flash_of(water=slow, walks=300_000)
    forward, right = CAMERA.pixel_centres()
    in_air = np.sqrt(1.0 + forward**2 + right**2)
    in_water = 1.0 / np.sqrt(1.0 - (1.0 - 1.0 / in_air**2) / INDEX**2)
    expected = 2.0 * (HEIGHT * in_air + 1.36 * DEPTH * in_water) / speed_of_light
    times = RECEIVER.gate_start + (np.arange(RECEIVER.bins) + 0.5) * RECEIVER.bin_width
    echo = flash.photo_electrons[1]
    centroid = (echo * times).sum(axis=-1) / echo.sum(axis=-1)
    assert abs((centroid - expected)[NADIR].mean()) < 0.05e-9
    assert abs((centroid - expected)[EDGE].mean()) < 0.05e-9


def test_singly_scattered_column():
    """Depths of 1-2, 4-5 and 8-9 m in weakly scattering water: b p(180) exp(-2 c s) ds, in 4 %.

    Light that is scattered once comes back the way it came. The whole frame, without the pulse's
    width, by quadrature over the pixels and 20 depths; some 4,000 scatterings a metre.
    """
    thin = replace(COASTAL, absorption=0.396, scattering=0.002)
    short = replace(LASER, pulse_fwhm=1e-15)
    fine = replace(RECEIVER, bin_width=0.25e-9, bins=1200)
    flash = flash_of(water=thin, laser=short, receiver=fine, reflectance=0.0, walks=2_000_000)
    forward, right = CAMERA.pixel_centres()
    in_air = HEIGHT * np.sqrt(1.0 + forward**2 + right**2)
    _, in_water = straight_there_and_back(1.0, 0.0)
    times = fine.gate_start + (np.arange(fine.bins) + 0.5) * fine.bin_width
    slant = 0.5 * speed_of_light / INDEX * (times - 2.0 * in_air[..., None] / speed_of_light)
    depth = slant * in_water[..., None]
    sent = thin.scattering * float(petzold("coastal").density(np.pi))
    for near in (1.0, 4.0, 8.0):
        inside = (depth >= near) & (depth < near + 1.0)
        expected = 0.0
        for z in near + (np.arange(20) + 0.5) / 20:
            back, cosine = straight_there_and_back(z, thin.attenuation)
            expected += (sent * back / cosine / cosine / 20).sum()
        assert flash.photo_electrons[0][inside].sum() == pytest.approx(expected, rel=0.04)
    assert flash.photo_electrons[1].sum() == 0.0  # the bottom is black


def test_a_rolled_sensor():
    """Rolled by 20 degrees, b = 0, pixels at the boresight: within 2 %.

    A pixel of solid angle W lights reach(t) reach'(t) / sin(t) W of the bottom, t off nadir, and
    takes radiance through the full aperture there: P = E T^2 (rho / pi) A W / (n^2 lit area).
    """
    clear, roll, turned = replace(COASTAL, scattering=0.0), np.radians(20.0), 1e-6
    pose = replace(level_pose(), roll=roll, heading=np.pi / 2)
    echo = flash_of(water=clear, pose=pose).photo_electrons[1].sum(axis=-1)

    def reach(t):
        return HEIGHT * np.tan(t) + DEPTH * np.tan(np.arcsin(np.sin(t) / INDEX))

    lit = reach(roll) * (reach(roll + turned) - reach(roll - turned)) / (2 * turned) / np.sin(roll)
    cosine = np.sqrt(1.0 - (np.sin(roll) / INDEX) ** 2)
    passed = 1.0 - fresnel_reflectance(np.cos(roll), 1.0 / INDEX)
    closed = PHOTONS_A_PIXEL * passed**2 * REFLECTANCE / np.pi * RECEIVER.aperture_area
    closed *= np.exp(-2.0 * clear.absorption * DEPTH / cosine) / (INDEX**2 * lit)
    assert echo[NADIR].mean() == pytest.approx(closed, rel=0.02)


def test_a_dark_bottom_sends_in_proportion():
    """A bottom of 1e-5 plays roulette with all that leaves it, one of 1 % with none: 15 %."""
    water = replace(COASTAL, phase_function=henyey_greenstein(0.7))
    grey, dark = (
        flash_of(water=water, reflectance=rho, walks=300_000).photo_electrons[1].sum() / rho
        for rho in (1e-2, 1e-5)
    )
    assert dark == pytest.approx(grey, rel=0.15)


@pytest.mark.parametrize("aside", [0.0, 1.0, 60.0, 5000.0])
def test_the_ray_to_the_receiver_obeys_snell(aside):
    t = tangent_in_air(INDEX, HEIGHT, DEPTH, aside)
    sine = np.sin(np.arctan(t)) / INDEX
    assert HEIGHT * t + DEPTH * sine / np.sqrt(1.0 - sine**2) == pytest.approx(aside, abs=1e-8)


@pytest.mark.parametrize("aside", [0.5, 30.0, 200.0])
def test_solid_angle_is_that_of_neighbouring_rays(aside):
    """sin(w) dw / (r dr) by differences."""
    near, far = (
        np.arcsin(np.sin(np.arctan(tangent_in_air(INDEX, HEIGHT, DEPTH, r))) / INDEX)
        for r in (aside - 1e-3, aside + 1e-3)
    )
    expected = (np.cos(near) - np.cos(far)) / (2e-3 * aside)
    t = tangent_in_air(INDEX, HEIGHT, DEPTH, aside)
    assert solid_angle_per_area(INDEX, HEIGHT, DEPTH, t) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("angle", [1e-5, 1e-4, 1e-2, 1.0, 3.1])
def test_density_table_follows_the_peak(angle):
    phase = petzold("coastal")
    table = density_table(phase)
    found = density_between(0.0, 0.0, 1.0, np.sin(angle), 0.0, np.cos(angle), table)
    assert found == pytest.approx(float(phase.density(angle)), rel=0.01)


def test_density_over_the_receiver_s_disc():
    """At its centre the share of scattering within the disc over its solid angle; none is lost."""
    phase, disc = petzold("coastal"), 2e-5
    blunt = density_table(phase, disc=disc)
    angle = 2.0 * np.arcsin(np.linspace(0.0, 1.0, len(blunt)) ** 2)
    assert blunt[1] == pytest.approx(phase.fraction_within(disc) / (np.pi * disc**2), rel=1e-3)
    near = angle < 25.0 * disc
    found = np.trapezoid((2.0 * np.pi * angle * blunt)[near], angle[near])
    assert found == pytest.approx(phase.fraction_within(angle[near][-1]), rel=2e-3)


def test_same_address_same_light():
    first, second, other = (flash_of(walks=20_000, frame=frame) for frame in (3, 3, 4))
    assert np.array_equal(first.photo_electrons, second.photo_electrons)
    assert not np.array_equal(first.photo_electrons, other.photo_electrons)


def test_bad_arguments_are_named_at_once():
    with pytest.raises(ValueError, match=r"depth must be above 0; reflectance .*; walks"):
        flash_of(depth=0.0, reflectance=1.5, walks=0)


def fast_engine(water: Water) -> Engine:
    ground = Ground(map_frame=FRAME, length=800.0, width=800.0, reflectance=REFLECTANCE)
    return Engine(
        seabed=plane(ground=ground, depth=DEPTH),
        surface=SeaSurface.from_wind(level=0.0, wind_speed=0.0, wind_from=0.0),
        water=water,
        laser=LASER,
        camera=CAMERA,
        receiver=RECEIVER,
        photo_electrons_per_photon=EFFICIENCY,
        settings=TransportSettings(walks_per_pixel=16),
        seed=2,
    )


@pytest.mark.slow
def test_both_engines_give_the_same_light():
    """Column and bottom of the whole frame: 3 %, in bands of 10 ns 4 %, at three standard errors.

    Coastal water with the phase function of Henyey and Greenstein, g = 0.7: without the forward
    peak of sea water the textbook engine's scores have a variance, and its errors can be trusted.
    24 fast flashes, 8 of the textbook engine; bands that hold 5 % of their origin's light.
    """
    water = replace(COASTAL, phase_function=henyey_greenstein(0.7))
    engine, pose = fast_engine(water), level_pose()

    def bands(echo):
        return echo.sum(axis=(1, 2)).reshape(2, -1, 10).sum(axis=-1)

    def traced(frame):
        return bands(flash_of(water=water, walks=300_000, frame=frame).photo_electrons)

    flashes = [engine.flash(pose=pose, frame=frame) for frame in range(24)]
    fast = np.array([bands(flash.photo_electrons[1:]) for flash in flashes])
    textbook = np.array([traced(frame) for frame in range(8)])
    strong = fast.mean(axis=0) > 0.05 * fast.mean(axis=0).sum(axis=1, keepdims=True)
    assert farthest_apart(fast[:, strong], textbook[:, strong]) < 0.04
    assert farthest_apart(fast.sum(axis=-1), textbook.sum(axis=-1)) < 0.03


def farthest_apart(fast, textbook):
    """Return the largest relative difference of means that three standard errors allow."""
    mean = fast.mean(axis=0)
    spread = [light.std(axis=0, ddof=1) / len(light) ** 0.5 for light in (fast, textbook)]
    return ((abs(textbook.mean(axis=0) - mean) + 3.0 * np.hypot(*spread)) / mean).max()

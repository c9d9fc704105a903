"""When and how light arrives: times, pulse, way in the water, what the bottom keeps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.constants import speed_of_light
from scipy.integrate import quad

from survey.optics.interface import fresnel_reflectance
from survey.transport import engine as engine_module
from survey.transport import pixels
from survey.transport.random import PIXELS, TRACKS

HEIGHT, DEPTH, INDEX = 200.0, 10.0, 1.33


def test_mirror_echo_has_the_pulse_s_time_and_width(engine_of, nadir):
    """Centroid 2 H / c to 0.02 ns; standard deviation FWHM / 2.3548 to 2 %, the bins' own apart."""
    engine = engine_of(wind_speed=0.0, walks_per_pixel=8)
    flash = engine.flash(pose=nadir, frame=0)
    echo = flash.origin("surface").sum(axis=(0, 1))
    centroid = (echo * flash.times).sum() / echo.sum()
    deviation = np.sqrt((echo * (flash.times - centroid) ** 2).sum() / echo.sum())
    assert centroid == pytest.approx(2.0 * HEIGHT / speed_of_light, abs=0.02e-9)
    assert deviation == pytest.approx(10e-9 / np.sqrt(8.0 * np.log(2.0)), rel=0.02)


def test_bottom_is_timed_by_the_group_index(engine_of, nadir):
    """Rays bend by 1.33, light runs at c / 1.40: 32 pixels at nadir together within 0.1 ns."""
    engine = engine_of(scattering=0.0, wind_speed=0.0, index=INDEX, group_index=1.40)
    flash = engine.flash(pose=nadir, frame=0)
    near = np.s_[14:18, 28:36]
    echo = flash.origin("bottom")[near]
    tangent = np.hypot(*engine.camera.pixel_centres())[near]
    sine = tangent / np.sqrt(1.0 + tangent**2)
    way = HEIGHT / np.sqrt(1.0 - sine**2) + 1.40 * DEPTH / np.sqrt(1.0 - (sine / INDEX) ** 2)
    centroid = (echo * flash.times).sum() / echo.sum()
    assert centroid == pytest.approx(2.0 * way.mean() / speed_of_light, abs=0.1e-9)


def test_the_surface_throws_light_back_on_the_bottom(engine_of, nadir):
    """Clear, 0.1 m deep, still: the bottom keeps T (1 - rho) / (1 - rho r) of what is launched.

    r is the internal reflectance of Lambertian light; within 2 %, as some leaves at the sides.
    Without r it would be 24 % less.
    """
    rho = 0.5
    engine = engine_of(
        depth=0.1, reflectance=rho, absorption=0.0, scattering=0.0, wind_speed=0.0,
        walks_per_pixel=8,
    )  # fmt: skip
    ledger = engine.flash(pose=nadir, frame=0).ledger
    inside = quad(lambda m: 2.0 * m * fresnel_reflectance(m, INDEX), 0.0, 1.0, limit=200)[0]
    passed = 1.0 - ledger["reflected at the surface"] / ledger["launched"]
    assert passed == pytest.approx(1.0 - ((INDEX - 1.0) / (INDEX + 1.0)) ** 2, rel=1e-3)
    kept = ledger["absorbed by the bottom"] / ledger["launched"]
    assert kept == pytest.approx(passed * (1.0 - rho) / (1.0 - rho * inside), rel=0.02)


def test_no_two_walks_of_a_flash_draw_the_same_numbers(engine_of, nadir, monkeypatch):
    """Every stream of the pixels has its own address: purpose, frame, batch, pixel."""
    engine = engine_of(walks_per_pixel=8)
    addresses = []
    monkeypatch.setattr(pixels, "start_stream", lambda state, *address: addresses.append(address))
    monkeypatch.setattr(pixels, "see", lambda *arguments: None)
    monkeypatch.setattr(engine_module, "see_all", pixels.see_all.py_func)
    for frame in (0, 1):
        engine.flash(pose=nadir, frame=frame)
    assert len(set(addresses)) == len(addresses) == 2 * 2048 * engine.settings.replicates
    assert {address[1] for address in addresses} == {PIXELS}
    assert PIXELS != TRACKS

"""When and how light arrives: times, pulse, way in the water, what the bottom keeps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.constants import speed_of_light
from scipy.integrate import quad

from survey.cloud.georeference import pixel_rays
from survey.optics.interface import fresnel_reflectance
from survey.transport import engine as engine_module
from survey.transport import launch
from survey.transport.records import LAUNCHED

HEIGHT, DEPTH, INDEX = 200.0, 10.0, 1.33


def test_mirror_echo_has_the_pulse_s_time_and_width(engine_of, nadir):
    """Centroid 2 H / c to 0.02 ns; standard deviation FWHM / 2.3548 to 2 %, the bins' own apart."""
    engine = engine_of(wind_speed=0.0, backward_walks_per_pixel=8, forward_walks_per_m2=1.0)
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


def test_unscattered_light_on_a_patch_is_timed_alike(engine_of, nadir):
    """Arrivals are timed at their patch's centre: within 30 ps; a metre is up to 900 ps."""
    engine = engine_of(scattering=0.0, wind_speed=0.0, gradient=0.2, reflectance=0.0)
    records = engine.walk_forward(pose=nadir, frame=0)
    order = np.argsort(records.patch, kind="stable")
    time = records.patch_time[order].astype(np.float64)
    first = np.flatnonzero(np.diff(records.patch[order], prepend=-1))
    spread = np.maximum.reduceat(time, first) - np.minimum.reduceat(time, first)
    assert np.mean(np.diff(first) > 1) > 0.5
    assert spread.max() < 30e-12


def test_crossings_measure_the_way_in_the_water(engine_of, nadir):
    """Rolled by 25 degrees: photons x layer thickness add up to photons x slant way, to 0.5 %.

    The slant way down to 10 m of the light that enters, by quadrature over the field of view;
    the upright way would be 5 % less.
    """
    engine = engine_of(absorption=0.0, scattering=0.0, wind_speed=0.0, reflectance=0.0)
    pose = replace(nadir, roll=np.radians(25.0))
    records = engine.walk_forward(pose=pose, frame=0)
    found = 0.5 * records.cell_weight.sum(dtype=np.float64) / records.ledger[LAUNCHED]
    rays = pixel_rays(camera=engine.camera, pose=pose)
    passed = 1.0 - np.vectorize(fresnel_reflectance)(-rays[..., 2], 1.0 / INDEX)
    in_water = np.sqrt(1.0 - (1.0 - rays[..., 2] ** 2) / INDEX**2)
    assert found == pytest.approx((passed * DEPTH / in_water).mean(), rel=0.005)


def test_the_surface_throws_light_back_on_the_bottom(engine_of, nadir):
    """Clear, 0.1 m deep, still: the bottom keeps T (1 - rho) / (1 - rho r) of what is launched.

    r is the internal reflectance of Lambertian light; within 2 %, as some leaves at the sides.
    Without r it would be 24 % less.
    """
    rho = 0.5
    engine = engine_of(
        depth=0.1, reflectance=rho, absorption=0.0, scattering=0.0, wind_speed=0.0,
        backward_walks_per_pixel=8,
    )  # fmt: skip
    ledger = engine.flash(pose=nadir, frame=0).ledger
    inside = quad(lambda m: 2.0 * m * fresnel_reflectance(m, INDEX), 0.0, 1.0, limit=200)[0]
    passed = 1.0 - ledger["reflected at the surface"] / ledger["launched"]
    assert passed == pytest.approx(1.0 - ((INDEX - 1.0) / (INDEX + 1.0)) ** 2, rel=1e-3)
    kept = ledger["absorbed by the bottom"] / ledger["launched"]
    assert kept == pytest.approx(passed * (1.0 - rho) / (1.0 - rho * inside), rel=0.02)


def test_no_two_walks_of_a_flash_draw_the_same_numbers(engine_of, nadir, monkeypatch):
    """Every stream of the walks has its own address: purpose, frame, batch, photon."""
    engine = engine_of(backward_walks_per_pixel=8, forward_walks_per_m2=1.0)
    addresses, start = [], launch.start_stream

    def noted(state, *address):
        addresses.append(address)
        start(state, *address)

    monkeypatch.setattr(launch, "start_stream", noted)
    monkeypatch.setattr(launch, "fly_down", lambda *arguments: None)
    for name in ("launch_forward", "launch_backward"):
        monkeypatch.setattr(engine_module, name, getattr(launch, name).py_func)
    for frame in (0, 1):
        engine.flash(pose=nadir, frame=frame)
    assert len(addresses) > 2 * (5000 + 2048 * 8)
    assert len(set(addresses)) == len(addresses)

"""The paper's lidar equation: limits in closed form, and the engine of whole frames beside it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from survey.flight.pose import Pose
from survey.optics.water import petzold_water
from survey.paper import instrument
from survey.paper.light import MIDDLE, trace
from survey.paper.power import FOOTPRINT, SPEED, blurred, energy_at, surface_energy
from survey.paper.receiver import PaperReceiver
from survey.transport.response_walks import FLOOD, ISOLATED

BIN_TIME = 0.25 / SPEED
TRANSMITTANCE = 1.0 - (0.33 / 2.33) ** 2
PIXEL_ENERGY = 1.0 / 2048


def thin(scattering=1e-6, absorption=0.05):
    return petzold_water(
        "clear",
        refractive_index=1.33,
        group_index=1.33,
        absorption=absorption,
        scattering=scattering,
    )


@pytest.fixture(scope="module")
def dark():
    """Light of water that absorbs and next to never scatters."""
    return trace(water=thin(), sweep=np.array([10.0, 30.0]), blocks=2, walks=100)


@pytest.mark.parametrize("which", [FLOOD, ISOLATED])
def test_bottom_without_scattering_is_the_lidar_equation(dark, which):
    """Energy E T^2 (rho / pi) exp(-2 c z) / (n H + z)^2 for each m2 of aperture, 0.1 %."""
    echo = dark.bottom.mean(axis=0)[which]
    expected = (
        PIXEL_ENERGY * TRANSMITTANCE**2 * 0.1 / math.pi / (1.33 * 200.0 + 50.0) ** 2
        * math.exp(-2.0 * dark.water.attenuation * 50.0)
    )  # fmt: skip
    assert echo.sum() * BIN_TIME == pytest.approx(expected, rel=1e-3, abs=0.0)
    assert dark.depth[echo.argmax()] == pytest.approx(50.0, abs=0.2)


@pytest.mark.parametrize("which", [FLOOD, ISOLATED])
def test_peaks_of_a_sweep_are_those_of_the_pulse(dark, which):
    """A Gaussian of 10 ns has 0.939 of its energy over 10 ns at its peak; half a bin aside, 1 %."""
    expected = (
        0.939 * energy_at(dark.sweep_depth) * 0.1 / math.pi / 10e-9
        * np.exp(-2.0 * dark.water.attenuation * dark.sweep_depth)
    )  # fmt: skip
    assert dark.sweep_peak.mean(axis=0)[which] == pytest.approx(expected, rel=0.01, abs=0.0)


def test_column_that_scatters_once(dark):
    """b p(180) exp(-2 c z) c / (2 n) E T^2 / (n H + z)^2: the single-scattering lidar equation."""
    deep = (dark.depth > 4.0) & (dark.depth < 40.0)
    backscatter = 1e-6 * float(dark.water.phase_function.density(math.pi))
    expected = (
        backscatter * np.exp(-2.0 * dark.water.attenuation * dark.depth)
        * energy_at(dark.depth) * SPEED
    )  # fmt: skip
    found = dark.column.mean(axis=0)
    assert found[ISOLATED][deep] == pytest.approx(expected[deep], rel=0.03, abs=0.0)
    assert found[ISOLATED][deep].sum() == pytest.approx(expected[deep].sum(), rel=0.01, abs=0.0)


def test_column_ends_at_the_bottom(dark):
    below = dark.depth > 53.0
    assert np.all(dark.column_above[..., below] < 1e-9 * dark.column[..., below])
    above = dark.depth < 47.0
    assert dark.column_above[..., above] == pytest.approx(
        dark.column[..., above], rel=1e-6, abs=0.0
    )


def test_surface_is_the_glint_at_nadir(dark):
    """rho / (8 pi s_up s_cr) E / H^2, slopes of Cox and Munk at 5 m/s."""
    slopes = math.sqrt(3.16e-3 * 5.0) * math.sqrt(0.003 + 1.92e-3 * 5.0)
    expected = PIXEL_ENERGY * (0.33 / 2.33) ** 2 / (8.0 * math.pi * slopes) / 200.0**2
    assert surface_energy() == pytest.approx(expected, rel=1e-9, abs=0.0)
    assert dark.surface.sum() * BIN_TIME == pytest.approx(expected, rel=1e-3, abs=0.0)


def test_the_pulse_keeps_energy():
    edges = np.arange(0.0, 90.25, 0.25)
    energy = np.exp(-0.3 * MIDDLE)
    power = blurred(energy=energy, edges=edges, depth=np.arange(-5.0, 95.0, 0.05))
    assert power.sum() * 0.05 / SPEED == pytest.approx(energy.sum(), rel=1e-6, abs=0.0)


def test_footprint_of_a_pixel():
    """Digest, Open 6: a pixel is 1.6 m at the surface and 1.9 m at 50 m depth."""
    assert FOOTPRINT.side == pytest.approx(1.6)
    assert FOOTPRINT.side + 50.0 * FOOTPRINT.growth == pytest.approx(1.9, abs=0.01)


def test_the_engine_of_whole_frames_says_the_same(engine_of):
    """Bottom of coastal water at 10 m under flood, photo-electrons of a nadir pixel: 4 %."""
    engine = engine_of(depth=10.0, wind_speed=0.0, aperture_radius=0.05)
    pose = Pose(position=np.array([0.0, 0.0, 200.0]), roll=0.0, pitch=0.0, heading=0.0)
    frames = [engine.flash(pose=pose, frame=number) for number in range(4)]
    rows, columns = slice(12, 20), slice(28, 36)
    counted = np.mean([f.origin("bottom")[rows, columns].sum(axis=-1).mean() for f in frames])
    coastal = petzold_water("coastal", refractive_index=1.33, group_index=1.33)
    light = trace(water=coastal, sweep=np.array([10.0]), blocks=1, walks=500)
    receiver = PaperReceiver(aperture_radius=0.05, filter_width=1e-9, efficiency=0.2)
    two_way = 0.022709  # tests/physics/test_response.py, worked out apart
    energy = energy_at(np.array(10.0)) * instrument.BOTTOM_REFLECTANCE / math.pi * two_way
    assert counted == pytest.approx(float(receiver.signal_rate(energy)), rel=0.04, abs=0.0)
    peak = light.sweep_peak.mean(axis=0)[FLOOD, 0]
    assert 0.7 < peak * 10e-9 / 0.939 / energy < 1.0

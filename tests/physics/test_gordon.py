"""How fast light dies away: c for a lone narrow pixel, K_d for a wide flood (Gordon 1982).

Seen from 20 km away with an index of one, all rays are vertical and no surface is there; the
two-way transmission of the bottom at two depths then gives the attenuation between them.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.constants import speed_of_light

from survey.optics.water import petzold_water
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser
from survey.sensor.receiver import Receiver
from survey.transport.engine import Engine
from survey.transport.response_echo import echo_batches
from survey.transport.response_walks import Footprint
from survey.transport.settings import TransportSettings
from terrain.generators import Ground, plane
from terrain.sea_surface import SeaSurface
from tests.physics.conftest import FRAME, level_pose

HEIGHT, REFLECTANCE, APERTURE = 20_000.0, 1e-3, 1e-6
NOTHING = 1.0 + 1e-9


def water_of(name):
    return petzold_water(name, refractive_index=NOTHING, group_index=1.33)


def two_way(*, water, depth, side, illumination, flashes=16):
    """Return the two-way transmission of the middle one of 3 x 3 pixels, and its error."""
    ground = Ground(map_frame=FRAME, length=1600.0, width=1600.0, reflectance=REFLECTANCE)
    engine = Engine(
        seabed=plane(ground=ground, depth=depth),
        surface=SeaSurface.from_wind(level=0.0, wind_speed=0.0, wind_from=0.0),
        water=water_of(water),
        laser=Laser(pulse_energy=1.0, wavelength=532e-9, pulse_fwhm=1e-15),
        camera=Camera(rows=3, columns=3, pixel_tangent=side / HEIGHT, long_side="along"),
        receiver=Receiver(
            aperture_radius=APERTURE,
            filter_width=1e-9,
            optics_transmission=1.0,
            gate_start=2.0 * HEIGHT / speed_of_light - 20e-9,
            bin_width=1e-9,
            bins=600,
        ),
        photo_electrons_per_photon=1.0,
        settings=TransportSettings(walks_per_pixel=1024, illumination=illumination),
        seed=2,
    )
    pose = level_pose(height=HEIGHT)
    light = [
        engine.flash(pose=pose, frame=frame).origin("bottom")[1, 1].sum()
        for frame in range(flashes)
    ]
    lit = engine.photo_electrons / 9.0 * REFLECTANCE / np.pi
    unscattered = lit * np.pi * APERTURE**2 / (HEIGHT + depth) ** 2
    return np.mean(light) / unscattered, np.std(light, ddof=1) / flashes**0.5 / unscattered


def attenuation(water, depths, **how):
    """Return the attenuation between two depths and its error [1/m]."""
    (near, near_error), (far, far_error) = (two_way(water=water, depth=z, **how) for z in depths)
    way = 2.0 * (depths[1] - depths[0])
    return np.log(near / far) / way, np.hypot(near_error / near, far_error / far) / way


@pytest.mark.parametrize(("water", "depths"), [("coastal", (2.0, 8.0)), ("clear", (5.0, 25.0))])
def test_a_lone_narrow_pixel_sees_c(water, depths):
    """A pixel of 0.1 mm: c R below 2e-5, nearly all scattered light is lost: c within 1 %."""
    found, error = attenuation(water, depths, side=1e-4, illumination="isolated")
    assert found == pytest.approx(water_of(water).attenuation, rel=0.01)
    assert error < 0.003 * found


@pytest.mark.parametrize(
    ("water", "depths", "known"),
    [
        ("clear", (5.0, 20.0), (0.118, 0.121)),
        ("coastal", (5.0, 15.0), (0.186, 0.199)),
        ("harbor", (1.0, 4.0), (0.44, 0.53)),
    ],
)
def test_a_wide_flood_sees_the_diffuse_attenuation(water, depths, known):
    """K_d by an independent Monte Carlo of the light downwards, sun at nadir; it grows with depth.

    By reciprocity the way up of a wide field loses as much as the way down.
    """
    found, error = attenuation(water, depths, side=100.0, illumination="flood")
    assert known[0] - 3.0 * error < found < known[1] + 3.0 * error
    assert error < 0.01 * found


def test_between_the_limits_attenuation_falls_with_the_width():
    how = {"water": "coastal", "depths": (5.0, 10.0), "illumination": "isolated"}
    found = [attenuation(side=side, **how)[0] for side in (1e-4, 0.3, 2.0, 10.0, 100.0)]
    assert np.all(np.diff(found) < 0.0)
    assert found[-1] < 0.2


@pytest.mark.parametrize("illumination", ["flood", "isolated"])
def test_two_way_transmission_is_that_of_response(illumination):
    """Two programs, one answer: 10 m of coastal water, flood, and 2 m alone.

    Equivalence within 2 %: the whole 99.9 % interval of the ratio, 3.3 standard errors of it.
    """
    side = 100.0 if illumination == "flood" else 2.0
    found, error = two_way(
        water="coastal", depth=10.0, side=side, illumination=illumination, flashes=64
    )
    batches = echo_batches(
        water=water_of("coastal"), footprint=Footprint(side=2.0, growth=0.0),
        depths=np.array([10.0]), bins=400, bin_width=0.5, seed=5,
    )[:, illumination == "isolated"].sum(axis=(-2, -1))  # fmt: skip
    known, known_error = batches.mean(), batches.std(ddof=1) / len(batches) ** 0.5
    spread = np.hypot(error / found, known_error / known)
    assert abs(found / known - 1.0) + 3.3 * spread < 0.02

"""The laser's light on level water: the ray to a place, and how dense light is where it enters."""

from __future__ import annotations

import math

import numpy as np
import pytest

from survey.flight.pose import Pose
from survey.sensor.camera import Camera
from survey.sensor.receiver import Receiver
from survey.transport.beam import light_on_water, ray_to
from survey.transport.engine import kernel_optics
from terrain.kernels import kernel

INDEX, LEVEL, HEIGHT = 1.34, 0.7, 200.0
PLACES = [(0.0, 0.0), (1e-6, 0.0), (3.0, -4.0), (50.0, 20.0), (-30.0, -110.0)]


def optics_of(*, roll=0.0, pitch=0.0, heading=0.0, rows=4, columns=8):
    """Return the optics of a small camera 200 m above the water."""
    return kernel_optics(
        camera=Camera(rows=rows, columns=columns, pixel_tangent=0.03, long_side="along"),
        receiver=Receiver(
            aperture_radius=0.005, filter_width=1e-9, optics_transmission=1.0, gate_start=1.3e-6,
            bin_width=1e-9, bins=300,
        ),
        pose=Pose(
            position=np.array([7.0, -3.0, LEVEL + HEIGHT]),
            roll=math.radians(roll), pitch=math.radians(pitch), heading=math.radians(heading),
        ),
    )  # fmt: skip


@pytest.mark.parametrize("depth", [0.0, 0.3, 10.0, 35.0])
@pytest.mark.parametrize("place", PLACES)
def test_the_ray_to_a_place_obeys_snell_s_law(place, depth):
    """In the vertical plane of laser and place, ending within 1 um of it."""
    optics = optics_of()
    x, y = optics.position[0] + place[0], optics.position[1] + place[1]
    ray = ray_to(optics, LEVEL, INDEX, x, y, depth)
    end = ray.x + depth * ray.slope_x, ray.y + depth * ray.slope_y
    assert end == pytest.approx((x, y), abs=1e-6)
    aside = math.hypot(ray.x - optics.position[0], ray.y - optics.position[1])
    sine_air = aside / math.hypot(aside, HEIGHT)
    slope = math.hypot(ray.slope_x, ray.slope_y)
    sine_water = slope / math.hypot(slope, 1.0)
    assert sine_air == pytest.approx(INDEX * sine_water, abs=1e-7)
    entry = np.array([ray.x, ray.y]) - optics.position[:2]
    assert abs(entry[0] * place[1] - entry[1] * place[0]) < 1e-9 * max(1.0, math.hypot(*place))


@pytest.mark.parametrize("place", PLACES[2:])
def test_neighbouring_rays_part_as_the_derivatives_say(place):
    """`radial` and `tangential` are how the slope changes with the entry, by differences."""
    optics, depth = optics_of(), 20.0
    ray = ray_to(optics, LEVEL, INDEX, *(optics.position[:2] + place), depth)
    outward = np.array(place) / math.hypot(*place)
    for direction, stated in (
        (outward, ray.radial),
        (np.array([-outward[1], outward[0]]), ray.tangential),
    ):
        step = 1e-3 * direction
        far, near = (
            ray_to(optics, LEVEL, INDEX, ray.x + side * step[0], ray.y + side * step[1], 0.0)
            for side in (1.0, -1.0)
        )
        slopes = np.array([far.slope_x - near.slope_x, far.slope_y - near.slope_y])
        assert slopes @ direction / 2e-3 == pytest.approx(stated, rel=1e-6)


@kernel
def light_on_grid(optics, level, xs, ys, isolated):
    """Return the light of pixel 5 on the points of a grid."""
    light = np.empty((xs.shape[0], ys.shape[0]))
    for i in range(xs.shape[0]):
        for j in range(ys.shape[0]):
            light[i, j] = light_on_water(optics, level, xs[i], ys[j], 5, isolated)
    return light


@pytest.mark.parametrize(
    "pose",
    [{"heading": 30.0}, {"roll": 25.0, "heading": 50.0}, {"roll": -12.0, "pitch": 8.0}],
)
def test_the_whole_pulse_falls_on_the_water(pose):
    """Light integrates to one over the footprint, an isolated pixel's to 1/32.

    Midpoint rule on 0.1 m, whose steps at the edges leave 0.1 and 0.3 %.
    """
    optics = optics_of(**pose)
    axis = np.arange(-130.0, 130.0, 0.1)
    xs, ys = optics.position[0] + axis, optics.position[1] + axis
    assert light_on_grid(optics, LEVEL, xs, ys, False).sum() * 0.01 == pytest.approx(1.0, rel=1e-3)
    lone = light_on_grid(optics, LEVEL, xs, ys, True).sum() * 0.01
    assert lone == pytest.approx(1.0 / 32.0, rel=3e-3)


def test_light_is_even_in_the_tangent_plane():
    """Power per tangent-plane area is 1 / field: at nadir 1 / (field H^2), dark beside it."""
    optics = optics_of()
    x, y = optics.position[:2]
    field = 0.03**2 * 32.0
    assert light_on_water(optics, LEVEL, x + 1.0, y + 1.0, 0, False) == pytest.approx(
        1.0 / (field * HEIGHT**2), rel=1e-12
    )
    assert light_on_water(optics, LEVEL, x + 0.061 * HEIGHT, y, 0, False) == 0.0
    assert light_on_water(optics, LEVEL, x + 0.059 * HEIGHT, y, 0, False) > 0.0


def test_an_isolated_pixel_lights_its_own_place():
    """Flying north, row 0 is the left and column 0 the front: pixel 5 is left, somewhat behind."""
    optics = optics_of()
    x, y = optics.position[:2]
    left, behind = -1.5 * 0.03 * HEIGHT, -1.5 * 0.03 * HEIGHT
    assert light_on_water(optics, LEVEL, x + left, y + behind, 5, True) > 0.0
    assert light_on_water(optics, LEVEL, x - left, y + behind, 5, True) == 0.0
    assert light_on_water(optics, LEVEL, x + left, y - behind, 5, True) == 0.0


def test_a_laser_turned_away_lights_nothing():
    optics = optics_of(roll=180.0)
    assert light_on_water(optics, LEVEL, optics.position[0], optics.position[1], 0, False) == 0.0

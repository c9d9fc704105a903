"""From pixel and time to a place: Snell, the speeds, and which way pixels look on the map."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import pytest
from scipy.constants import speed_of_light

from survey.cloud.georeference import (
    bend_at_surface,
    depth_of,
    pixel_rays,
    place_in_air,
    place_in_water,
)
from survey.flight.pose import Pose
from survey.sensor.camera import Camera

Looks = Callable[..., Any]
TILTS = [(0.0, 0.0, 0.0), (5.0, -3.0, 20.0), (-8.0, 6.0, 135.0), (2.0, 9.0, 290.0)]


def test_snell_by_hand() -> None:
    ray = np.array([0.3, -0.4, -np.sqrt(0.75)])
    path = bend_at_surface(
        position=np.array([1.0, 2.0, 10.0]), rays=ray, level=3.0, refractive_index=1.25
    )
    assert path.direction == pytest.approx([0.24, -0.32, -np.sqrt(1.0 - 0.16)])
    assert path.entry == pytest.approx([1.0 + 7.0 * 0.3 / 0.75**0.5, 2.0 - 2.8 / 0.75**0.5, 3.0])
    assert path.air_time == pytest.approx(14.0 / 0.75**0.5 / speed_of_light)


def test_the_ray_to_nadir_goes_on_straight() -> None:
    path = bend_at_surface(
        position=np.array([5.0, 6.0, 200.0]),
        rays=np.array([0.0, 0.0, -1.0]),
        level=0.5,
        refractive_index=1.34,
    )
    assert path.direction.tolist() == [0.0, 0.0, -1.0]
    assert path.air_time == pytest.approx(2.0 * 199.5 / speed_of_light)
    time = path.air_time + np.array(80e-9)
    depth = 0.5 * 80e-9 * speed_of_light / 1.36
    assert place_in_water(path=path, time=time, group_index=1.36) == pytest.approx(
        [5.0, 6.0, 0.5 - depth]
    )
    assert depth_of(time=80e-9, group_index=1.36) == pytest.approx(depth)
    straight = place_in_air(position=np.array([5.0, 6.0, 200.0]), rays=path.direction, time=time)
    assert straight == pytest.approx([5.0, 6.0, 0.5 - 1.36 * depth])


def test_refraction_there_and_back_is_the_ray_itself(look_at: Looks) -> None:
    look = look_at(roll_deg=10.0)
    path = bend_at_surface(
        position=look.frame.pose.position, rays=look.rays, level=0.0, refractive_index=1.34
    )
    back = path.direction * 1.34
    back[..., 2] = -np.sqrt(1.0 - np.sum(back[..., :2] ** 2, axis=-1))
    assert np.abs(back - look.rays).max() < 1e-14
    assert np.abs(np.linalg.norm(path.direction, axis=-1) - 1.0).max() < 1e-14


@pytest.mark.parametrize("long_side", ["along", "across"])
@pytest.mark.parametrize(("roll", "pitch", "heading"), TILTS)
def test_the_true_time_of_a_ray_leads_to_its_true_end(
    look_at: Looks, long_side: str, roll: float, pitch: float, heading: float
) -> None:
    look = look_at(roll_deg=roll, pitch_deg=pitch, heading_deg=heading, long_side=long_side)
    path = bend_at_surface(
        position=look.frame.pose.position,
        rays=look.rays,
        level=look.surface.level,
        refractive_index=look.water.refractive_index,
    )
    place = place_in_water(path=path, time=look.targets.time, group_index=1.36)
    assert np.abs(place - look.targets.position).max() < 1e-9


@pytest.mark.parametrize(("roll", "pitch", "heading"), TILTS)
def test_the_true_way_is_the_quickest_one(
    look_at: Looks, roll: float, pitch: float, heading: float
) -> None:
    look = look_at(roll_deg=roll, pitch_deg=pitch, heading_deg=heading)
    sensor, entry, end = look.frame.pose.position, look.targets.surface, look.targets.position
    out, on = entry - sensor, end - entry
    toward = out / np.linalg.norm(out, axis=-1, keepdims=True)
    onward = on / np.linalg.norm(on, axis=-1, keepdims=True)
    gain = toward[..., :2] - look.water.refractive_index * onward[..., :2]
    assert np.abs(gain).max() < 1e-12
    bed = -6.0 - 0.05 * (end[..., 0] - 30.0)
    assert np.abs(end[..., 2] - bed).max() < 1e-9
    two_way = 2.0 * (np.linalg.norm(out, axis=-1) + 1.36 * np.linalg.norm(on, axis=-1))
    assert np.abs(two_way / speed_of_light - look.targets.time).max() < 1e-18


@pytest.mark.parametrize("long_side", ["along", "across"])
@pytest.mark.parametrize("heading", [0.0, 90.0, 200.0])
def test_pixels_look_where_the_camera_says(
    long_side: Literal["along", "across"], heading: float
) -> None:
    camera = Camera(rows=6, columns=10, pixel_tangent=0.01, long_side=long_side)
    angle = np.radians(heading)
    pose = Pose(position=np.array([0.0, 0.0, 100.0]), roll=0.0, pitch=0.0, heading=float(angle))
    rays = pixel_rays(camera=camera, pose=pose)
    ground = (rays / -rays[..., 2:])[..., :2] * 100.0
    ahead = ground @ [np.sin(angle), np.cos(angle)]
    right = ground @ [np.cos(angle), -np.sin(angle)]
    half_ahead, half_right = (4.5, 2.5) if long_side == "along" else (2.5, 4.5)
    assert (ahead[0, 0], right[0, 0]) == pytest.approx((half_ahead, -half_right))
    assert (ahead[-1, -1], right[-1, -1]) == pytest.approx((-half_ahead, half_right))
    step = (ahead[0, 1] - ahead[0, 0], right[0, 1] - right[0, 0])
    assert step == pytest.approx((-1.0, 0.0) if long_side == "along" else (0.0, 1.0))


def test_a_lifted_nose_looks_ahead_and_a_lowered_right_wing_to_the_left() -> None:
    camera = Camera(rows=1, columns=1, pixel_tangent=0.01, long_side="along")
    for roll, pitch, wanted in ((0.0, 0.1, (0.0, np.tan(0.1))), (0.1, 0.0, (-np.tan(0.1), 0.0))):
        pose = Pose(position=np.zeros(3), roll=roll, pitch=pitch, heading=0.0)
        ray = pixel_rays(camera=camera, pose=pose)[0, 0]
        assert ray[:2] / -ray[2] == pytest.approx(wanted, abs=1e-12)


def test_later_is_deeper(look_at: Looks) -> None:
    look = look_at()
    path = bend_at_surface(
        position=look.frame.pose.position, rays=look.rays, level=0.4, refractive_index=1.34
    )
    places = [
        place_in_water(path=path, time=path.air_time + delay, group_index=1.36)[..., 2]
        for delay in (0.0, 1e-9, 50e-9)
    ]
    assert np.abs(places[0] - 0.4).max() < 1e-9
    assert np.all(places[1] < places[0])
    assert np.all(places[2] < places[1] - 5.0)

"""The flight lies where the plan says and the camera looks where the documents say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from survey.flight.plan import FlightPlan
from survey.flight.pose import Pose
from survey.flight.trajectory import fly_lines, footprint
from survey.sensor.camera import Camera

PLAN = FlightPlan(
    start=(1000.0, 2000.0),
    heading=0.0,
    height=200.0,
    water_level=1.5,
    speed=100.0,
    flash_rate=1.0,
    frames_per_line=4,
    lines=3,
    swath=51.2,
    sidelap=0.2,
    turn="alternate",
    turn_time=60.0,
)


def camera(long_side: str = "along") -> Camera:
    assert long_side in {"along", "across"}
    return Camera(
        rows=32,
        columns=64,
        pixel_tangent=0.008,
        long_side="along" if long_side == "along" else "across",
    )


def pose(*, roll_deg: float = 0.0, pitch_deg: float = 0.0, heading_deg: float = 0.0) -> Pose:
    return Pose(
        position=np.array([0.0, 0.0, 200.0]),
        roll=np.radians(roll_deg),
        pitch=np.radians(pitch_deg),
        heading=np.radians(heading_deg),
    )


@pytest.mark.parametrize(
    ("heading_deg", "ahead", "right"),
    [(0, (0, 1), (1, 0)), (90, (1, 0), (0, -1)), (180, (0, -1), (-1, 0)), (270, (-1, 0), (0, 1))],
)
def test_heading_counts_from_north_to_east_and_lines_step_to_the_right(
    heading_deg: float, ahead: tuple[int, int], right: tuple[int, int]
) -> None:
    frames = fly_lines(replace(PLAN, heading=np.radians(heading_deg), turn="same"))
    first = frames[0].pose.position[:2]
    assert frames[1].pose.position[:2] - first == pytest.approx(100.0 * np.array(ahead))
    assert frames[4].pose.position[:2] - first == pytest.approx(40.96 * np.array(right))


def test_positions_keep_the_height_above_the_water() -> None:
    assert {frame.pose.position[2] for frame in fly_lines(PLAN)} == {201.5}


def test_alternate_lines_fly_back_over_the_same_places_abreast() -> None:
    there, back = fly_lines(PLAN)[:4], fly_lines(PLAN)[4:8]
    for outward, homeward in zip(there, reversed(back), strict=True):
        offset = homeward.pose.position - outward.pose.position
        assert offset == pytest.approx([40.96, 0.0, 0.0], abs=1e-9)
        assert homeward.pose.heading == pytest.approx(np.pi)


def test_frames_are_numbered_and_timed_in_order_of_flight() -> None:
    frames = fly_lines(PLAN)
    assert [frame.index for frame in frames] == list(range(12))
    assert [frame.line for frame in frames] == [0] * 4 + [1] * 4 + [2] * 4
    assert [frame.time for frame in frames[:6]] == [0.0, 1.0, 2.0, 3.0, 63.0, 64.0]


def test_sidelap_is_the_part_of_the_swath_seen_twice() -> None:
    view = camera()
    swath = 2.0 * view.half_tangents[1] * PLAN.height
    frames = fly_lines(replace(PLAN, swath=swath, turn="same"))
    one = footprint(view, frames[0].pose, PLAN.water_level)
    other = footprint(view, frames[4].pose, PLAN.water_level)
    overlap = one[:, 0].max() - other[:, 0].min()
    assert overlap / swath == pytest.approx(0.2)


def test_turned_camera_leaves_gaps_of_49_m_between_flashes() -> None:
    frames = fly_lines(PLAN)
    first, second = (footprint(camera("across"), frame.pose, 1.5) for frame in frames[:2])
    assert second[:, 1].min() - first[:, 1].max() == pytest.approx(48.8)


def test_corners_come_forward_left_first_and_turn_with_the_heading() -> None:
    assert footprint(camera(), pose(heading_deg=90), 0.0) == pytest.approx(
        np.array([[51.2, 25.6], [51.2, -25.6], [-51.2, -25.6], [-51.2, 25.6]])
    )


def test_right_wing_down_moves_the_view_to_the_left() -> None:
    centre = footprint(camera(), pose(roll_deg=5), 0.0).mean(axis=0)
    assert centre[0] == pytest.approx(-200.0 * np.tan(np.radians(5)), rel=0.03)
    assert centre[1] == pytest.approx(0.0, abs=1e-9)


def test_nose_up_moves_the_view_forward() -> None:
    centre = footprint(camera(), pose(pitch_deg=5), 0.0).mean(axis=0)
    assert centre[1] == pytest.approx(200.0 * np.tan(np.radians(5)), rel=0.08)
    assert centre[0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("long_side", ["along", "across"])
def test_first_pixel_lies_in_the_forward_left_corner(long_side: str) -> None:
    view = camera(long_side)
    forward, right = view.pixel_centres()
    corner = footprint(view, pose(), 0.0)[0]
    assert (200.0 * right[0, 0], 200.0 * forward[0, 0]) == pytest.approx(
        (corner[0] + 0.8, corner[1] - 0.8)
    )


def test_a_view_above_the_horizon_is_refused() -> None:
    with pytest.raises(ValueError, match="tilt the sensor less"):
        footprint(camera(), pose(roll_deg=85), 0.0)

"""Motion has the stated spectrum; navigation errs as stated; what is switched off does nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import welch

from survey.flight.motion import CHANNELS, Motion, Swing, moved
from survey.flight.navigation import (
    QUANTITIES,
    Mounting,
    Navigation,
    NavigationError,
    navigated,
)
from survey.flight.plan import FlightPlan
from survey.flight.pose import Frame, Pose
from survey.flight.trajectory import fly_lines

PLAN = FlightPlan(
    start=(0.0, 0.0),
    heading=0.5,
    height=200.0,
    water_level=0.0,
    speed=100.0,
    flash_rate=1.0,
    frames_per_line=200,
    lines=3,
    swath=50.0,
    sidelap=0.2,
    turn="alternate",
    turn_time=90.0,
)
ROLL = Swing(rms=0.03, period=6.0, damping=0.2)


def chances(count: int, seed: int = 1) -> list[np.random.Generator]:
    return [np.random.default_rng([seed, i]) for i in range(count)]


def drawn(swing: Swing, times: np.ndarray, seed: int) -> np.ndarray:
    return swing.drawn(times, np.random.default_rng(seed))


@pytest.mark.parametrize("damping", [0.1, 0.7, 1.0, 3.0])
def test_swings_have_the_stated_rms_at_every_time(damping: float) -> None:
    swing = Swing(rms=2.0, period=8.0, damping=damping)
    times = np.array([0.0, 0.01, 1.0, 1.5, 100.0])
    values = np.array([drawn(swing, times, seed) for seed in range(3000)])
    assert values.mean(axis=0) == pytest.approx(0.0, abs=0.15)
    assert values.std(axis=0) == pytest.approx(2.0, rel=0.06)


@pytest.mark.parametrize("damping", [0.1, 0.4])
def test_swings_correlate_as_a_damped_spring(damping: float) -> None:
    swing = Swing(rms=1.0, period=8.0, damping=damping)
    times = np.array([0.0, 2.0, 5.0])
    values = np.array([drawn(swing, times, seed) for seed in range(6000)])
    w = 2.0 * np.pi / 8.0
    ringing = w * np.sqrt(1.0 - damping**2)
    for i, lag in ((1, 2.0), (2, 5.0)):
        wanted = np.exp(-damping * w * lag) * (
            np.cos(ringing * lag) + damping * w / ringing * np.sin(ringing * lag)
        )
        assert np.mean(values[:, 0] * values[:, i]) == pytest.approx(wanted, abs=0.05)


def test_the_spectrum_is_the_stated_one() -> None:
    swing = Swing(rms=1.5, period=6.0, damping=0.3)
    step = 0.25
    values = drawn(swing, step * np.arange(200_000), seed=3)
    frequency, found = welch(values, fs=1.0 / step, nperseg=512)
    band = (frequency > 0.03) & (frequency < 0.5)
    assert found[band] == pytest.approx(swing.spectrum(frequency[band]), rel=0.25)
    assert found[band].mean() == pytest.approx(swing.spectrum(frequency[band]).mean(), rel=0.03)
    fine = np.linspace(0.0, 50.0, 500_001)
    assert np.trapezoid(swing.spectrum(fine), fine) == pytest.approx(1.5**2, rel=1e-3)


def test_means_and_sums_of_swings_reach_the_poses() -> None:
    motion = Motion(roll_mean=0.01, pitch_mean=0.02, roll=(ROLL, replace(ROLL, period=60.0)))
    frames = moved(fly_lines(PLAN), motion, chances(5))
    roll = np.array([frame.pose.roll for frame in frames])
    assert roll.std() == pytest.approx(0.03 * np.sqrt(2.0), rel=0.25)
    assert {frame.pose.pitch for frame in frames} == {0.02}
    assert [f.pose.heading for f in frames] == [f.pose.heading for f in fly_lines(PLAN)]
    assert all(f.measured is f.pose for f in frames)


def test_off_track_lies_to_the_right_of_the_heading_and_height_is_up() -> None:
    motion = Motion(
        cross_track=(Swing(rms=3.0, period=30.0, damping=1.0),),
        height=(Swing(rms=2.0, period=30.0, damping=1.0),),
    )
    for before, after in zip(
        fly_lines(PLAN), moved(fly_lines(PLAN), motion, chances(5)), strict=True
    ):
        way = after.pose.position - before.pose.position
        ahead = before.pose.body_to_map() @ [1.0, 0.0, 0.0]
        assert way @ ahead == pytest.approx(0.0, abs=1e-9)
        assert abs(way[2]) > 0.0


@pytest.mark.parametrize("channel", CHANNELS)
def test_one_motion_leaves_the_others_as_they_were(channel: str) -> None:
    everything = Motion(**dict.fromkeys(CHANNELS, (ROLL,)))
    without = replace(everything, **{channel: ()})
    one = moved(fly_lines(PLAN), everything, chances(5))[7].pose
    other = moved(fly_lines(PLAN), without, chances(5))[7].pose
    for name in ("roll", "pitch", "heading"):
        assert (getattr(one, name) == getattr(other, name)) == (name != channel)


def test_same_seed_same_flight_and_another_seed_another() -> None:
    motion = Motion(roll=(ROLL,))
    rolls = [
        [frame.pose.roll for frame in moved(fly_lines(PLAN), motion, chances(5, seed))]
        for seed in (1, 1, 2)
    ]
    assert rolls[0] == rolls[1] != rolls[2]


def test_still_air_and_perfect_navigation_change_nothing() -> None:
    frames = fly_lines(PLAN)
    same = navigated(moved(frames, Motion(), chances(5)), Navigation(), chances(6))
    assert all(one is other for one, other in zip(frames, same, strict=True))


def test_drift_is_slow_and_white_is_new_at_every_flash() -> None:
    times = np.arange(4000.0)
    error = NavigationError(bias=0.3, drift=0.2, drift_time=50.0, white=0.1)
    values = np.array([error.drawn(times, np.random.default_rng(seed)) for seed in range(40)])
    assert values.mean() == pytest.approx(0.3, abs=0.02)
    assert values.std() == pytest.approx(np.hypot(0.2, 0.1), rel=0.03)
    assert error.deviation == pytest.approx(np.hypot(0.2, 0.1))
    apart = values - 0.3
    for lag in (1, 50, 150):
        found = np.mean(apart[:, lag:] * apart[:, :-lag])
        assert found == pytest.approx(0.04 * np.exp(-lag / 50.0), abs=0.003)


def test_measured_less_true_is_the_stated_error() -> None:
    navigation = Navigation(
        east=NavigationError(bias=0.5),
        up=NavigationError(bias=-0.1),
        roll=NavigationError(bias=0.01),
        heading=NavigationError(bias=-0.02),
    )
    for before, frame in zip(
        fly_lines(PLAN)[:5], navigated(fly_lines(PLAN)[:5], navigation, chances(6)), strict=True
    ):
        assert (frame.pose.position == before.pose.position).all()
        assert frame.measured.position - frame.pose.position == pytest.approx([0.5, 0.0, -0.1])
        assert frame.measured.roll == pytest.approx(0.01)
        assert frame.measured.heading == pytest.approx(frame.pose.heading - 0.02)


def test_white_errors_reach_every_quantity_with_their_own_numbers() -> None:
    white = NavigationError(white=1e-3)
    navigation = Navigation(**dict.fromkeys(QUANTITIES, white))
    frames = navigated(fly_lines(PLAN), navigation, chances(6))
    errors = np.array(
        [
            [
                *(frame.measured.position - frame.pose.position),
                frame.measured.roll - frame.pose.roll,
                frame.measured.pitch - frame.pose.pitch,
                frame.measured.heading - frame.pose.heading,
            ]
            for frame in frames
        ]
    )
    assert errors.std(axis=0) == pytest.approx(1e-3, rel=0.15)
    assert np.abs(np.corrcoef(errors.T) - np.eye(6)).max() < 0.2
    assert navigation.deviations == pytest.approx([1e-3] * 6)


def test_a_mounting_turns_the_sensor_within_the_body() -> None:
    body = Pose(position=np.zeros(3), roll=0.2, pitch=-0.1, heading=1.0)
    mounting = Mounting(roll=0.03, pitch=0.05, heading=np.pi / 2)
    sensor = mounting.sensor_pose(body)
    forward = sensor.body_to_map() @ [1.0, 0.0, 0.0]
    right_of_body = body.body_to_map() @ [0.0, 1.0, 0.0]
    assert forward @ right_of_body == pytest.approx(np.cos(0.05))
    back = body.body_to_map().T @ sensor.body_to_map()
    assert np.linalg.det(back) == pytest.approx(1.0)


def test_a_believed_mounting_is_what_georeferencing_takes() -> None:
    frame = Frame(
        index=0,
        line=0,
        time=0.0,
        pose=Pose(position=np.array([0.0, 0.0, 200.0]), roll=0.0, pitch=0.0, heading=0.0),
    )
    navigation = Navigation(
        mounting=Mounting(roll=0.02, lever_arm=(1.0, 0.0, 0.0)),
        believed_mounting=Mounting(roll=0.01),
    )
    (found,) = navigated([frame], navigation, chances(6))
    assert (found.pose.roll, found.measured.roll) == pytest.approx((0.02, 0.01))
    assert found.pose.position == pytest.approx([0.0, 1.0, 200.0])
    assert found.measured.position == pytest.approx([0.0, 0.0, 200.0])

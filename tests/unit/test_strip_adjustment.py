"""Strips flown by hand, without light, over beds with and without shape, and brought together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import asin, atan, cos, radians, sin, tan
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from survey.cloud.matching import nearest, normals_of
from survey.cloud.sights import Sights, moved, placed, sights_of
from survey.cloud.strip_adjustment import Adjustment, AdjustmentError, adjust
from survey.cloud.strips import Strip, strips_of
from survey.flight.navigation import Mounting
from survey.flight.pose import Frame, Pose
from survey.sensor.camera import Camera

FloatArray = NDArray[np.float64]
Bed = Callable[[FloatArray, FloatArray], FloatArray]

WATER = {"refractive_index": 1.34, "group_index": 1.36}
CELL = 2.1
BELIEVED = Mounting()
WRONG = Mounting(roll=radians(0.3), pitch=radians(0.2), heading=radians(0.5))
LINE, FRAME = np.full(3, 0.1), np.full(3, 0.02)
NOISE = 0.1


def shaped(x: FloatArray, y: FloatArray) -> FloatArray:
    """Mounds of a metre, 60 m apart, on a swell: slopes of a tenth."""
    waves = np.sin(x / 9.0) * np.cos(y / 11.0) + 0.6 * np.sin((x + 2.0 * y) / 23.0)
    return np.asarray(waves - 6.0)


def flat(x: FloatArray, y: FloatArray) -> FloatArray:
    """Level."""
    return np.asarray(0.0 * x - 6.0)


def ridges(x: FloatArray, y: FloatArray) -> FloatArray:
    """Ridges that run from south to north."""
    return np.asarray(np.sin(x / 9.0) - 6.0)


@dataclass(frozen=True, kw_only=True)
class Flown:
    """Strips, and what was wrong with each line's place (lines, 3)."""

    strips: list[Strip]
    wrong: FloatArray


def fly(bed: Bed, *, mounting: Mounting = BELIEVED, seed: int = 1, line: float = 0.1) -> Flown:
    """Return three lines to and fro, 40 m apart, and one across."""
    chance = np.random.default_rng(seed)
    wrong = chance.normal(0.0, line, (4, 3))
    starts = [
        (0.0, 0.0, 90.0, 3),
        (180.0, 40.0, 270.0, 3),
        (0.0, 80.0, 90.0, 3),
        (90.0, 0.0, 0.0, 2),
    ]
    strips = []
    for number, (east, north, heading, count) in enumerate(starts):
        ahead = np.array([sin(radians(heading)), cos(radians(heading))])
        looks = []
        for step in range(count):
            place = np.array([*(np.array([east, north]) + 90.0 * step * ahead), 200.0])
            true = Pose(position=place, roll=0.0, pitch=0.0, heading=radians(heading))
            error = wrong[number] + chance.normal(0.0, FRAME)
            looks.append(look(bed, true, error, mounting, chance))
        sights = Sights(
            **{
                name: np.concatenate([vars(each)[name] for each in looks])
                for name in vars(looks[0])
            }
        )
        frame = np.repeat(np.arange(count) + 10 * number, len(looks[0].length))
        strips.append(
            Strip(
                line=number,
                frame=frame.astype(np.uint32),
                position=placed(sights, mounting=Mounting(), **WATER).position,
                sights=sights,
                **WATER,
            )
        )
    return Flown(strips=strips, wrong=wrong)


def look(
    bed: Bed, pose: Pose, error: FloatArray, mounting: Mounting, chance: np.random.Generator
) -> Sights:
    """Return the looks of one frame as its navigation has them: by bisection for the bed."""
    forward, right = Camera(
        rows=24, columns=48, pixel_tangent=0.0107, long_side="along"
    ).pixel_centres()
    ray = np.stack([forward, right, np.ones_like(forward)], axis=-1).reshape(-1, 3)
    ray /= np.linalg.norm(ray, axis=1)[:, None]
    count = len(ray)
    true = Sights(
        sensor=np.tile(pose.position, (count, 1)),
        to_map=np.tile(pose.body_to_map(), (count, 1, 1)),
        ray=ray,
        length=np.zeros(count),
        level=np.zeros(count),
    )
    short, long = np.full(count, 195.0), np.full(count, 240.0)
    for _ in range(20):
        middle = 0.5 * (short + long)
        x, y, z = placed(replace(true, length=middle), mounting=mounting, **WATER).position.T
        short, long = np.where(z > bed(x, y), middle, short), np.where(z > bed(x, y), long, middle)
    return replace(
        true,
        sensor=true.sensor + error,
        length=short + chance.normal(0.0, NOISE, count),
        level=true.level + error[2],
    )


def solved(flown: Flown, **changes: Any) -> Adjustment:
    """Return the adjustment of strips."""
    given: dict[str, Any] = {
        "mode": "boresight",
        "line_deviations": LINE,
        "frame_deviations": FRAME,
    }
    return adjust(flown.strips, cell_size=CELL, **given | changes)


@pytest.fixture(scope="module")
def calibrated() -> tuple[Flown, Adjustment]:
    """Strips over mounds by a camera that is mounted wrongly, and their adjustment."""
    flown = fly(shaped, mounting=WRONG)
    return flown, solved(flown)


@pytest.fixture(scope="module")
def shifted() -> tuple[Flown, Adjustment]:
    """Strips over mounds whose lines are 0.3 m off, and their adjustment by offsets alone."""
    flown = fly(shaped, line=0.3)
    return flown, solved(flown, mode="offsets")


@pytest.fixture(scope="module")
def level() -> Flown:
    """Strips over a level bed by a camera that is mounted wrongly."""
    return fly(flat, mounting=WRONG)


def test_boresight_is_found_within_three_standard_errors(
    calibrated: tuple[Flown, Adjustment],
) -> None:
    _, found = calibrated
    true = np.array([WRONG.roll, WRONG.pitch, WRONG.heading])
    mounting = np.array([found.mounting.roll, found.mounting.pitch, found.mounting.heading])
    errors = found.errors[:3] / found.unknowns.arms
    assert (found.resolved[:3] > 0.9).all()
    assert (np.abs(mounting - true) < 3.0 * errors).all()
    assert (3.0 * errors < true).all()


def test_lever_arm_and_height_are_not_told_by_strips(
    calibrated: tuple[Flown, Adjustment],
) -> None:
    _, found = calibrated
    assert (found.resolved[3:6] < 0.1).all()
    assert (found.resolved[6:9] == 0.0).all()


def test_points_come_to_where_the_bed_is(calibrated: tuple[Flown, Adjustment]) -> None:
    flown, found = calibrated
    before, after = [], []
    for strip in flown.strips:
        x, y, z = strip.position.T
        before.append(z - shaped(x, y))
        x, y, z = (strip.placed(found.mounting) + found.offset(strip.line)).T
        after.append(z - shaped(x, y))
    assert np.std(np.concatenate(after)) < 0.6 * np.std(np.concatenate(before))
    assert found.noise.deviation == pytest.approx(NOISE, rel=0.15)


def test_offsets_are_found_against_their_mean(shifted: tuple[Flown, Adjustment]) -> None:
    flown, found = shifted
    offsets, errors = (found.unknowns.offsets(part) for part in (found.values, found.errors))
    true = -(flown.wrong - flown.wrong.mean(axis=0))
    assert np.abs(offsets.mean(axis=0)).max() < 1e-6
    assert (np.abs(offsets - true) < 3.0 * errors).all()
    assert (errors[:, :2] < 0.1).all()
    assert found.mounting == Mounting()


def test_pairs_agree_after_the_adjustment(shifted: tuple[Flown, Adjustment]) -> None:
    _, found = shifted
    assert [pair.lines for pair in found.pairs] == [(0, 1), (0, 3), (1, 2), (1, 3), (2, 3)]
    for pair in found.pairs:
        assert (np.abs(pair.shift) < 4.0 * np.hypot(pair.shift_error, FRAME)).all()
        assert (np.diff(pair.information) <= 0.0).all()


def test_open3d_registers_a_pair_to_the_same_shift(shifted: tuple[Flown, Adjustment]) -> None:
    from open3d.geometry import PointCloud
    from open3d.pipelines import registration as open3d
    from open3d.utility import Vector3dVector

    flown, found = shifted
    first, cross = (PointCloud(Vector3dVector(flown.strips[i].position)) for i in (0, 3))
    cross.normals = Vector3dVector(normals_of(flown.strips[3].position, radius=5.0))
    icp = open3d.registration_icp(
        first, cross, CELL, np.eye(4), open3d.TransformationEstimationPointToPlane()
    )
    met = np.asarray(icp.correspondence_set)[:, 0]
    centre = flown.strips[0].position[met].mean(axis=0)
    shift = icp.transformation[:3, :3] @ centre + icp.transformation[:3, 3] - centre
    assert shift == pytest.approx(found.offset(0) - found.offset(3), abs=0.15)


@pytest.mark.parametrize("mode", ["boresight", "offsets"])
def test_a_flat_bed_is_refused(level: Flown, mode: str) -> None:
    with pytest.raises(AdjustmentError, match="too little shape"):
        solved(level, mode=mode)


def test_open3d_takes_a_flat_bed_for_one_that_fixes_east_and_north() -> None:
    from open3d.geometry import PointCloud
    from open3d.pipelines.registration import get_information_matrix_from_point_clouds
    from open3d.utility import Vector3dVector

    x, y = (axis.ravel() for axis in np.mgrid[0:40, 0:40].astype(np.float64))
    bed = PointCloud(Vector3dVector(np.column_stack([x, y, flat(x, y)])))
    information = get_information_matrix_from_point_clouds(bed, bed, 1.0, np.eye(4))
    assert np.diag(information)[3:].tolist() == [1600.0] * 3


def test_ridges_tell_what_lies_across_them() -> None:
    found = solved(fly(ridges, line=0.3), mode="offsets")
    shares = found.unknowns.offsets(found.resolved)
    assert (shares[:, 0] > 0.9).all()
    assert (shares[:, 1] < 0.1).all()


def test_what_cannot_be_adjusted_says_why(level: Flown) -> None:
    with pytest.raises(AdjustmentError, match=r"1 line .* fly more lines"):
        adjust(level.strips[:1], mode="offsets", cell_size=CELL)
    with pytest.raises(AdjustmentError, match="no two lines overlap"):
        adjust([level.strips[0], level.strips[2]], mode="offsets", cell_size=CELL)
    few = [thinned(level.strips[i], 20) for i in (0, 3)]
    with pytest.raises(AdjustmentError, match=r"only \d+ points lie in overlaps"):
        adjust(few, mode="offsets", cell_size=4.0 * CELL)


def thinned(strip: Strip, step: int) -> Strip:
    which = np.arange(0, len(strip), step)
    return replace(
        strip,
        frame=strip.frame[which],
        position=strip.position[which],
        sights=strip.sights.select(which),
    )


def test_neighbours_are_those_that_brute_force_finds() -> None:
    one, other = np.random.default_rng(1).uniform(0.0, 10.0, (2, 60, 3))
    distance = np.linalg.norm(one[:, None] - other, axis=2)
    i, j = nearest(one, other, reach=2.0)
    assert i.tolist() == np.flatnonzero(distance.min(axis=1) < 2.0).tolist()
    assert j.tolist() == distance.argmin(axis=1)[i].tolist()


def test_a_roll_moves_a_point_in_the_water_as_snell_has_it() -> None:
    tilt, height, length = radians(2.0), 200.0, 206.0
    sights = Sights(
        sensor=np.array([[0.0, 0.0, height]]),
        to_map=np.array([[[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]]),
        ray=np.array([[0.0, 0.0, 1.0]]),
        length=np.array([length]),
        level=np.zeros(1),
    )
    below = (length - height / cos(tilt)) / 1.36
    bent = asin(sin(tilt) / 1.34)
    wanted = [-height * tan(tilt) - below * sin(bent), 0.0, -below * cos(bent)]
    found = placed(sights, mounting=Mounting(roll=tilt), **WATER)
    assert found.position[0] == pytest.approx(wanted, abs=1e-9)
    assert atan(-found.straight[0, 0] / (height - found.straight[0, 2])) == pytest.approx(tilt)


def test_points_of_a_cloud_move_with_mounting_and_line(small_survey: Any) -> None:
    frames: dict[int, Frame] = {frame.index: frame for frame in small_survey.frames}
    cloud = small_survey.bottom
    nothing = np.zeros((len(cloud), 3))
    same = moved(cloud, frames, mounting=Mounting(), shift=nothing, **WATER)
    assert np.array_equal(same.position, cloud.position)
    arm = Mounting(lever_arm=(0.0, 0.0, 0.5))
    lower = moved(cloud, frames, mounting=arm, shift=nothing + np.array([1.0, 0.0, 0.0]), **WATER)
    assert lower.position - cloud.position == pytest.approx(
        nothing + np.array([1.0, 0.0, -0.5]), abs=1e-9
    )
    assert lower.depth == pytest.approx(same.depth)
    assert np.isfinite(sights_of(cloud, frames).level).any()


def test_strips_are_bounded_and_hold_bottom_and_land_alone(small_survey: Any) -> None:
    frames = {frame.index: frame for frame in small_survey.frames}
    bottom = small_survey.bottom
    clouds = [bottom.select(bottom.frame == index) for index in frames]
    strips = strips_of(clouds, frames, cell_size=1.0, most=300, **WATER)
    assert [strip.line for strip in strips] == [0, 1, 2, 3]
    assert all(100 < len(strip) <= 300 for strip in strips)
    places = {tuple(place) for place in bottom.position[np.isin(bottom.classification, (2, 40))]}
    assert all(tuple(place) in places for strip in strips for place in strip.position)
    again = strips_of(clouds[::-1], frames, cell_size=1.0, most=300, **WATER)
    assert all(
        np.array_equal(one.position, other.position)
        for one, other in zip(strips, again, strict=True)
    )

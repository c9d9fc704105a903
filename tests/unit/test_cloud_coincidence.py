"""Frames that believe each other's weak echoes: true ones become bottoms, false ones no oftener."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import binom

from survey.cloud.coincidence import Coincidence
from survey.cloud.points import BOTTOM_CLASSES, Outcome, PointClass, PointCloud
from survey.cloud.shared_views import SharedViews
from survey.flight.pose import Frame, Pose
from survey.products.frame_file import FrameResult
from survey.products.helped_frames import MOST_FRAMES, TOLERANCE, HelpedFrames
from survey.sensor.camera import Camera

FloatArray = NDArray[np.float64]

CAMERA = Camera(rows=8, columns=16, pixel_tangent=0.008, long_side="along")
HEIGHT, SEARCHED, INDEX = 200.0, 40.0, 1.33
RULE = Coincidence(candidate_rate=0.05, false_alarm_rate=1e-3, depth_searched=SEARCHED)
TVU, THU = 0.8, 1.0


def overhead(count: int, *, step: float) -> list[Frame]:
    """Return frames on a line northward, so many metres apart."""
    return [
        Frame(
            index=10 + number,
            line=0,
            time=1.0 * number,
            pose=Pose(
                position=np.array([0.0, step * number, HEIGHT]), roll=0.0, pitch=0.0, heading=0.0
            ),
        )
        for number in range(count)
    ]


def seen(
    small_survey: Any, frame: Frame, weak: NDArray[np.bool_], depth: FloatArray
) -> FrameResult:
    """Return a frame without any bottom, with candidates in some pixels (128,) at depths (128,)."""
    forward, right = (part.ravel() for part in CAMERA.pixel_centres())
    row, column = (part.ravel() for part in np.indices(CAMERA.shape))
    place = frame.pose.position[:2] + HEIGHT * np.column_stack([right, forward])
    count = row.size
    entry = np.column_stack([place, np.zeros(count)])
    none = replace(
        small_survey.bottom.select(np.zeros(count, np.intp)),
        position=entry,
        classification=np.full(count, PointClass.NO_BOTTOM_FOUND, np.uint8),
        true_classification=np.full(count, PointClass.BATHYMETRIC, np.uint8),
        true_elevation=np.full(count, -20.0),
        depth=np.zeros(count),
        tvu=np.full(count, np.nan, np.float32),
        thu=np.full(count, np.nan, np.float32),
        frame=np.full(count, frame.index, np.uint32),
        row=row.astype(np.uint16),
        column=column.astype(np.uint16),
    )
    found = replace(
        none,
        position=entry - depth[:, None] * [0.0, 0.0, 1.0],
        classification=np.full(count, PointClass.BATHYMETRIC, np.uint8),
        depth=depth,
        tvu=np.full(count, TVU, np.float32),
        thu=np.full(count, THU, np.float32),
    )
    record = replace(
        small_survey.records[0], outcome=np.full(CAMERA.shape, Outcome.TOO_DEEP, np.uint8)
    )
    return FrameResult(
        bottom=none,
        surface=none,
        record=record,
        candidates=found.select(weak) if any(weak) else None,
    )


def judged(frames: list[Frame], results: list[FrameResult], rule: Coincidence) -> list[FrameResult]:
    by_number = {frame.index: result for frame, result in zip(frames, results, strict=True)}
    helped = HelpedFrames(
        by_number.__getitem__,
        frames,
        views=SharedViews.of(frames, CAMERA, level=0.0, refractive_index=INDEX, deepest=SEARCHED),
        rule=rule,
        pixel_tangent=CAMERA.pixel_tangent,
        level=0.0,
    )
    return [helped(frame.index) for frame in frames]


def test_weak_echoes_of_a_true_bed_become_bottoms(small_survey: Any) -> None:
    """Half of the pixels have one, off by chance by 0.2 m, and one in twenty a false one."""
    random, frames = np.random.default_rng(1), overhead(6, step=3.0)
    results, weak = [], 0
    for frame in frames:
        kind = random.random(128)
        depth = np.where(kind < 0.5, random.normal(20.0, 0.2, 128), random.uniform(0, 40, 128))
        results.append(seen(small_survey, frame, kind < 0.55, depth))
        weak += int((kind < 0.5).sum())
    found = judged(frames, results, RULE)
    points = PointCloud.concatenate([result.bottom for result in found])
    solid = points.select(np.isin(points.classification, BOTTOM_CLASSES))
    true = np.abs(solid.position[:, 2] + 20.0) < 1.0
    assert true.sum() > 0.9 * weak
    assert (~true).sum() <= 1
    assert len(points) == 6 * 128
    assert sum(result.helped for result in found) == len(solid)


def test_what_is_believed_is_told_in_the_record(small_survey: Any) -> None:
    frames, chosen = overhead(3, step=1.0), np.arange(128) < 32
    depth = np.where(np.arange(128) < 16, 20.4, 23.0)
    results = [seen(small_survey, frame, chosen, depth) for frame in frames]
    result = judged(frames, results, RULE)[1]
    outcome = result.record.outcome.ravel()
    assert set(outcome[:16]) == {Outcome.FOUND}
    assert set(outcome[16:32]) == {Outcome.FALSE_BOTTOM}
    assert set(outcome[32:]) == {Outcome.TOO_DEEP}
    assert result.candidates is None
    assert result.bottom.depth[:16].tolist() == [20.4] * 16
    assert results[1].bottom.depth[0] == 0.0


@pytest.mark.parametrize(("rate", "stated"), [(0.1, 5e-3), (0.3, 5e-3)])
def test_false_candidates_agree_as_rarely_as_the_rule_says(
    small_survey: Any, rate: float, stated: float
) -> None:
    """Of the pixels in the middle: their neighbours are all there, and so are the other frames."""
    rule = Coincidence(candidate_rate=rate, false_alarm_rate=stated, depth_searched=SEARCHED)
    random, frames, draws = np.random.default_rng(2), overhead(5, step=0.0), 120
    believed = 0
    for _ in range(draws):
        results = [
            seen(small_survey, frame, random.random(128) < rate, random.uniform(0, 40, 128))
            for frame in frames
        ]
        for result in judged(frames, results, rule):
            solid = np.isin(result.bottom.classification, BOTTOM_CLASSES)
            believed += int(solid.reshape(CAMERA.shape)[2:-2, 2:-2].sum())
    trials = draws * 5 * 4 * 12
    reach = 1.6 + THU
    chance = rule.chance(
        pixels=np.array([np.pi * (reach / 1.6) ** 2]), tolerance=np.array([TOLERANCE * TVU])
    )
    needed = rule.needed(looks=np.array([4]), chance=chance)
    expected = float(rate * binom.sf(needed - 1, 4, chance)[0])
    assert expected <= stated
    assert binom.ppf(1e-4, trials, 0.5 * expected) <= believed <= binom.isf(1e-4, trials, expected)


def test_a_frame_does_not_believe_itself(small_survey: Any) -> None:
    everywhere = np.ones(128, np.bool_)
    apart = overhead(2, step=60.0)
    results = [seen(small_survey, frame, everywhere, np.full(128, 20.0)) for frame in apart]
    assert [result.helped for result in judged(apart, results, RULE)] == [0, 0]


def test_a_frame_is_the_same_whichever_is_read_first(small_survey: Any) -> None:
    """Of forty frames over one place each asks the nearest."""
    random, frames = np.random.default_rng(3), overhead(40, step=0.3)
    results = [
        seen(small_survey, frame, random.random(128) < 0.4, random.uniform(18, 22, 128))
        for frame in frames
    ]
    forth = judged(frames, results, RULE)
    back = judged(frames[::-1], results[::-1], RULE)[::-1]
    views = SharedViews.of(frames, CAMERA, level=0.0, refractive_index=INDEX, deepest=SEARCHED)
    assert len(views.around(20, most=MOST_FRAMES)) == MOST_FRAMES
    assert forth[20].helped > 0
    for one, other in zip(forth, back, strict=True):
        assert np.array_equal(one.bottom.position, other.bottom.position)


def test_more_frames_that_look_there_must_agree_more_often() -> None:
    chance = RULE.chance(pixels=np.full(5, 7.9), tolerance=np.array([0.5, 1.0, 1.0, 1.0, 50.0]))
    looks = np.array([1, 1, 8, 24, 3])
    needed = RULE.needed(looks=looks, chance=chance)
    assert needed.tolist() == [1, 1, 2, 3, 4]
    false = RULE.candidate_rate * binom.sf(needed - 1, looks, chance)
    assert (false <= RULE.false_alarm_rate).all()

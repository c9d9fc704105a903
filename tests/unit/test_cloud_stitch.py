"""All frames in one cloud: which point of a cell stays, and that order does not matter."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import PointClass, PointCloud
from survey.cloud.stitch import stitched


def whole_frames(cloud: PointCloud) -> list[PointCloud]:
    return [cloud.select(cloud.frame == frame) for frame in np.unique(cloud.frame)]


def equal(first: PointCloud, second: PointCloud) -> bool:
    pairs = zip(first.columns().values(), second.columns().values(), strict=True)
    return all(np.array_equal(one, other) for one, other in pairs)


def points(cloud: PointCloud, **columns: Any) -> PointCloud:
    few = cloud.select(np.arange(len(columns["frame"])))
    return replace(few, **{name: np.asarray(value) for name, value in columns.items()})


@pytest.fixture
def cloud(small_survey: Any) -> PointCloud:
    bottom: PointCloud = small_survey.bottom
    snr = np.random.default_rng(1).integers(1, 6, len(bottom)).astype(np.float32)
    return replace(bottom, snr=snr)


def test_without_thinning_every_point_stays_in_the_order_of_pixels(cloud: PointCloud) -> None:
    parts = [part.select(np.arange(len(part))[::-1]) for part in whole_frames(cloud)[::-1]]
    whole = stitched(parts, cell_size=0.0)
    assert len(whole) == len(cloud)
    assert np.array_equal(np.lexsort((whole.column, whole.row, whole.frame)), np.arange(len(whole)))


def test_the_best_point_of_every_cell_stays(cloud: PointCloud) -> None:
    side = 9.0
    thinned = stitched(whole_frames(cloud), cell_size=side)
    cells: dict[tuple[int, int], list[Any]] = {}
    for i, place in enumerate(cloud.position):
        key = (int(place[0] // side), int(place[1] // side))
        rank = (
            cloud.classification[i] == PointClass.NO_BOTTOM_FOUND,
            -cloud.snr[i],
            cloud.frame[i],
            cloud.row[i],
            cloud.column[i],
        )
        cells.setdefault(key, []).append(rank)
    assert any(place[0] < 0.0 for place in cloud.position)
    assert max(len(ranks) for ranks in cells.values()) > 2
    best = sorted((rank[2:], rank[1]) for rank in map(min, cells.values()))
    kept = zip(thinned.frame, thinned.row, thinned.column, thinned.snr, strict=True)
    assert [((frame, row, column), -snr) for frame, row, column, snr in kept] == best


def test_the_order_of_frames_and_points_does_not_matter(cloud: PointCloud) -> None:
    wanted = stitched(whole_frames(cloud), cell_size=9.0)
    chance = np.random.default_rng(2)
    for _ in range(3):
        shuffled = cloud.select(chance.permutation(len(cloud)))
        parts = whole_frames(shuffled)
        order = chance.permutation(len(parts))
        assert equal(stitched([parts[i] for i in order], cell_size=9.0), wanted)


def test_thinning_twice_changes_nothing(cloud: PointCloud) -> None:
    once = stitched(whole_frames(cloud), cell_size=9.0)
    assert len(once) < len(cloud)
    assert equal(stitched([once], cell_size=9.0), once)


def test_a_found_echo_wins_over_none_and_then_the_clearer_one(cloud: PointCloud) -> None:
    three = points(
        cloud,
        position=np.array([[1.2, 1.2, 0.0], [1.4, 1.9, -3.0], [1.9, 1.1, -3.1]]),
        classification=np.array([45, 40, 40], np.uint8),
        snr=np.array([9.0, 2.0, 3.0], np.float32),
        frame=np.array([0, 0, 1], np.uint32),
    )
    assert stitched([three], cell_size=1.0).position[:, 2].tolist() == [-3.1]
    assert stitched([three.select(np.array([0, 1]))], cell_size=1.0).depth.size == 1
    assert stitched([three.select(np.array([0]))], cell_size=1.0).classification.tolist() == [45]
    tied = replace(three, snr=np.full(3, 2.0, np.float32))
    assert stitched([tied], cell_size=1.0).position[:, 2].tolist() == [-3.0]


def test_cells_on_both_sides_of_zero_are_different_cells(cloud: PointCloud) -> None:
    two = points(
        cloud,
        position=np.array([[-0.4, 0.5, 0.0], [0.4, 0.5, 0.0]]),
        frame=np.array([0, 0], np.uint32),
    )
    assert len(stitched([two], cell_size=1.0)) == 2


def test_no_points_are_an_empty_cloud(cloud: PointCloud) -> None:
    nothing = cloud.select(np.zeros(0, np.int64))
    assert len(stitched([nothing, nothing], cell_size=1.0)) == 0

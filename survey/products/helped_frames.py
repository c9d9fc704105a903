"""Frames as they are read, their weak echoes judged together with those of other frames."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import chain

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from survey.cloud.coincidence import Coincidence
from survey.cloud.points import BOTTOM_CLASSES, Outcome, PixelRecord, PointClass, PointCloud
from survey.cloud.shared_views import SharedViews
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.flight.pose import Frame
from survey.products.frame_file import FrameResult

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

TOLERANCE = 0.5
"""Over a candidate's TVU: wider ones add more that is off by over 1 m than that is right."""
MOST_FRAMES = 24
WITNESSES_AT_HAND = 64


class HelpedFrames:
    """Reads frames, and makes bottoms of the candidates that enough other frames agree with.

    Whatever is asked for in whatever order, a frame is the same: its neighbours are those whose
    measured views meet its own, at most `MOST_FRAMES` of them, and they tell what they saw alone.

    Parameters
    ----------
    read : callable
        Returns a frame as it was flown by its number; called from several threads.
    frames : sequence of Frame
        Those to take.
    views : SharedViews
        Of the same frames.
    rule : Coincidence
        How many must agree.
    pixel_tangent : float
        Side of a pixel [1].
    level : float
        Elevation of the water [m, local].
    """

    def __init__(
        self,
        read: Callable[[int], FrameResult],
        frames: Sequence[Frame],
        *,
        views: SharedViews,
        rule: Coincidence,
        pixel_tangent: float,
        level: float,
    ) -> None:
        self._read, self._views, self._rule = read, views, rule
        self._number = np.array([frame.index for frame in frames])
        self._place = {frame.index: place for place, frame in enumerate(frames)}
        height = np.array([frame.measured.position[2] for frame in frames]) - level
        self._spacing = pixel_tangent * height
        self._witness = lru_cache(WITNESSES_AT_HAND)(self._witness_of)
        self._believed: dict[int, NDArray[np.uint16]] = {}

    def __call__(self, index: int) -> FrameResult:
        """Return a frame by its number, without candidates: they are bottoms or nothing."""
        result = self._read(index)
        if result.candidates is None:
            return result
        if index not in self._believed:
            believed = self._agreed(self._place[index], result.candidates)
            self._believed[index] = np.flatnonzero(believed).astype(np.uint16)
        return with_bottoms(result, result.candidates.select(self._believed[index]))

    def _agreed(self, place: int, weak: PointCloud) -> BoolArray:
        """Tell with which candidates of a frame enough others agree."""
        spacing = self._spacing[place]
        reach = spacing + weak.thu.astype(np.float64)
        tolerance = TOLERANCE * weak.tvu.astype(np.float64)
        others = self._views.around(place, most=MOST_FRAMES)
        if others.size == 0:
            return np.zeros(len(weak), np.bool_)
        looks = self._views.see(others, weak.position[:, :2], depth=weak.depth, reach=reach)
        agree = agreement(
            weak.position,
            [self._witness(int(other)) for other in others],
            reach=reach,
            tolerance=tolerance,
        )
        needed = self._rule.needed(
            looks=looks.sum(axis=0),
            chance=self._rule.chance(pixels=np.pi * (reach / spacing) ** 2, tolerance=tolerance),
        )
        return np.asarray((looks & agree).sum(axis=0) >= needed)

    def _witness_of(self, place: int) -> FloatArray:
        """Return where a frame alone saw the bottom, or what it took for one (m, 3) [m]."""
        result = self._read(int(self._number[place]))
        solid = result.bottom.position[np.isin(result.bottom.classification, BOTTOM_CLASSES)]
        weak = () if result.candidates is None else (result.candidates.position,)
        return np.concatenate([solid, *weak])


def agreement(
    places: FloatArray, others: Sequence[FloatArray], *, reach: FloatArray, tolerance: FloatArray
) -> BoolArray:
    """Tell which of the others have a point near each place (others, n).

    Parameters
    ----------
    places : array (n, 3)
        [m].
    others : sequence of array (m, 3)
        Their points [m].
    reach, tolerance : array (n,)
        How far from a place such a point may lie on the map, and in elevation [m].

    Examples
    --------
    >>> places = np.array([[0.0, 0.0, -20.0], [9.0, 0.0, -20.0]])
    >>> others = [np.array([[1.0, 0.0, -20.4], [8.0, 0.0, -23.0]]), np.zeros((0, 3))]
    >>> agreement(places, others, reach=np.full(2, 2.0), tolerance=np.full(2, 0.5)).tolist()
    [[True, False], [False, False]]
    """
    points = np.concatenate(others)
    owner = np.repeat(np.arange(len(others)), [len(one) for one in others])
    near = cKDTree(points[:, :2]).query_ball_point(places[:, :2], reach)
    place = np.repeat(np.arange(len(places)), [len(one) for one in near])
    point = np.fromiter(chain.from_iterable(near), np.intp, len(place))
    close = np.abs(points[point, 2] - places[place, 2]) <= tolerance[place]
    result = np.zeros((len(others), len(places)), np.bool_)
    result[owner[point[close]], place[close]] = True
    return result


def with_bottoms(result: FrameResult, found: PointCloud) -> FrameResult:
    """Return a frame in which some pixels without a bottom have one.

    Parameters
    ----------
    result : FrameResult
    found : PointCloud
        A bottom point of each such pixel, in the order of rows and columns.
    """
    shape = result.record.outcome.shape
    pixel = np.ravel_multi_index((found.row, found.column), shape)
    own = np.ravel_multi_index((result.bottom.row, result.bottom.column), shape)
    place = np.flatnonzero(
        np.isin(own, pixel) & (result.bottom.classification == PointClass.NO_BOTTOM_FOUND)
    )
    columns = {name: column.copy() for name, column in result.bottom.columns().items()}
    for name, column in found.columns().items():
        columns[name][place] = column
    return replace(
        result,
        bottom=PointCloud(**columns),
        record=_with_outcomes(result.record, found),
        candidates=None,
        helped=len(found),
    )


def _with_outcomes(record: PixelRecord, found: PointCloud) -> PixelRecord:
    """Return the record with what became of the pixels; land that was taken for water stays so."""
    off = np.abs(found.position[:, 2] - found.true_elevation)
    outcome = np.where(off <= FALSE_BOTTOM_ERROR, Outcome.FOUND, Outcome.FALSE_BOTTOM)
    dry = found.true_classification == PointClass.GROUND
    changed = record.outcome.copy()
    changed[found.row, found.column] = np.where(dry, Outcome.DRY, outcome)
    return replace(record, outcome=changed)

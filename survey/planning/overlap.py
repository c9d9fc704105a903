"""How much neighbouring frames see twice: along the lines and from line to line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.flight.polygon import cross
from survey.flight.pose import Frame
from survey.planning.views import Views

FloatArray = NDArray[np.float64]
Indices = NDArray[np.intp]

PARALLEL_SINE = 0.35  # 20 degrees
NEAR_IN_VIEWS = 1.5
LEAST_LATERAL_SHARE = 0.1
STEPS_IN_VIEW = 8
NEAR_EDGE = 0.95
ROUNDING = 1e-6


@dataclass(frozen=True, kw_only=True)
class Neighbours:
    """Pairs of frames whose views should meet.

    Parameters
    ----------
    pairs : array (pairs, 2)
        Their places in the list of frames.
    direction : array (pairs, 2)
        Unit vector from the first to the second, along the flight or across it.
    """

    pairs: Indices
    direction: FloatArray


@dataclass(frozen=True, kw_only=True)
class Overlap:
    """What pairs see twice, measured through the middle of their views; below 0 is a gap.

    Parameters
    ----------
    length, least_length : float
        Median and least of all pairs [m].
    share, least_share : float
        The same over the length of the first view in that direction [1].
    """

    length: float
    least_length: float
    share: float
    least_share: float


def flight_directions(frames: Sequence[Frame]) -> FloatArray:
    """Return the unit vector (frames, 2) in which the sensor moves; its heading where it is alone.

    Examples
    --------
    >>> from survey.flight.pose import Pose
    >>> frames = [Frame(index=i, line=0, time=i, pose=Pose(position=np.array([0.0, 9.0 * i, 200]),
    ...           roll=0.0, pitch=0.0, heading=0.1)) for i in range(2)]
    >>> flight_directions(frames).tolist()
    [[0.0, 1.0], [0.0, 1.0]]
    """
    place = np.array([frame.pose.position[:2] for frame in frames])
    line = np.array([frame.line for frame in frames])
    heading = np.array([frame.pose.heading for frame in frames])
    step = np.zeros_like(place)
    same = (line[1:] == line[:-1])[:, None]
    moved = np.where(same, place[1:] - place[:-1], 0.0)
    step[:-1] += moved
    step[1:] += moved
    length = np.linalg.norm(step, axis=1)
    pointing = np.column_stack([np.sin(heading), np.cos(heading)])
    still = length < ROUNDING
    return np.asarray(
        np.where(still[:, None], pointing, step / np.where(still, 1.0, length)[:, None])
    )


def one_after_another(frames: Sequence[Frame]) -> Neighbours:
    """Return the frames that follow each other on a line; there, the direction of flight."""
    line = np.array([frame.line for frame in frames])
    first = np.flatnonzero(line[1:] == line[:-1])
    directions = flight_directions(frames)
    ahead = directions[first] + directions[first + 1]
    length = np.linalg.norm(ahead, axis=1, keepdims=True)
    onward = length[:, 0] > ROUNDING
    return Neighbours(
        pairs=np.column_stack([first, first + 1])[onward], direction=(ahead / length)[onward]
    )


def side_by_side(frames: Sequence[Frame], seen: Views) -> Neighbours:
    """Return the frames that lie abreast on parallel lines, each with the next on both sides.

    Lines more than one and a half views apart are no neighbours.
    """
    from scipy.spatial import cKDTree

    directions, place = flight_directions(frames), seen.centre[:, :2]
    width = 2.0 * float(np.nanmax(np.linalg.norm(seen.outline - seen.centre[:, None], axis=2)))
    spacing = _spacing(frames)
    few = _thinned(frames, spacing, step=width / STEPS_IN_VIEW)
    few = few[np.isfinite(place[few]).all(axis=1)]
    spacing = np.maximum(np.where(spacing > 0.0, spacing, width), width / STEPS_IN_VIEW)
    found = few[cKDTree(place[few]).query_pairs(NEAR_IN_VIEWS * width, output_type="ndarray")]
    one, other = np.concatenate([found, found[:, ::-1]]).T
    apart = place[other] - place[one]
    along = _along(apart, directions[one])
    lateral = cross(directions[one], apart)
    parallel = np.abs(cross(directions[one], directions[other])) < PARALLEL_SINE
    near = np.abs(along) <= 0.5 * np.maximum(spacing[one], spacing[other]) * (1.0 + ROUNDING)
    chosen = parallel & near & (np.abs(lateral) > LEAST_LATERAL_SHARE * width)
    return _nearest_on_each_side(one[chosen], other[chosen], lateral[chosen], directions)


def overlap(neighbours: Neighbours, seen: Views) -> Overlap | None:
    """Return what the pairs see twice; None where no pair lies on known ground."""
    one, other = neighbours.pairs.T
    ahead, centre = neighbours.direction, seen.centre[:, :2]
    front = _reach(seen, one, centre[one], ahead)
    back = _reach(seen, one, centre[one], -ahead)
    facing = _reach(seen, other, centre[other], -ahead)
    length = front + facing - _along(centre[other] - centre[one], ahead)
    known = np.isfinite(length)
    if not known.any():
        return None
    length, share = length[known], (length / (front + back))[known]
    return Overlap(
        length=float(np.median(length)),
        least_length=float(length.min()),
        share=float(np.median(share)),
        least_share=float(share.min()),
    )


def between(neighbours: Neighbours, seen: Views) -> list[FloatArray]:
    """Return what lies between the centres of pairs and abreast of both (4, 2) [m]: no holes there.

    A view is taken to be as wide as it is at its centre or near the edge that faces the other,
    whichever is less, so that ragged edges of a swath are no gaps.

    Parameters
    ----------
    neighbours : Neighbours
    seen : Views
    """
    ahead, centre = neighbours.direction, seen.centre[:, :2]
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    start, end = (centre[which] for which in neighbours.pairs.T)
    low, high = np.full(len(start), -np.inf), np.full(len(start), np.inf)
    for which, onward in zip(neighbours.pairs.T, (ahead, -ahead), strict=True):
        facing = _reach(seen, which, centre[which], onward)[:, None] * onward
        for origin in (centre[which], centre[which] + NEAR_EDGE * facing):
            aside = _along(origin - start, left)
            high = np.minimum(high, aside + _reach(seen, which, origin, left))
            low = np.maximum(low, aside - _reach(seen, which, origin, -left))
    across = np.stack([low, high, high, low], axis=1)[..., None] * left[:, None]
    onward = _along(end - start, ahead)[:, None] * ahead
    rings = start[:, None] + across
    rings[:, 2:] += onward[:, None]
    return list(rings[high > low])


def triangles(following: Neighbours, beside: Neighbours, seen: Views) -> list[FloatArray]:
    """Return the triangles (3, 2) of pairs on a line and a frame abreast [m]: no holes there.

    They close the corners where four frames meet.
    """
    abreast: dict[int, list[int]] = {}
    for one, other in beside.pairs.tolist():
        abreast.setdefault(one, []).append(other)
        abreast.setdefault(other, []).append(one)
    corners = [
        (one, other, third)
        for one, other in following.pairs.tolist()
        for third in (*abreast.get(one, []), *abreast.get(other, []))
    ]
    rings = (seen.centre[list(corner), :2] for corner in corners)
    return [ring for ring in rings if np.isfinite(ring).all()]


def _nearest_on_each_side(
    one: Indices, other: Indices, lateral: FloatArray, directions: FloatArray
) -> Neighbours:
    order = np.lexsort((np.abs(lateral), lateral > 0.0, one))
    one, other, lateral = one[order], other[order], lateral[order]
    side = 2 * one + (lateral > 0.0)
    first = np.concatenate([[True], side[1:] != side[:-1]]) if side.size else side.astype(bool)
    pairs = np.sort(np.column_stack([one[first], other[first]]), axis=1)
    pairs, kept = np.unique(pairs, axis=0, return_index=True)
    sign = np.where(one[first] < other[first], 1.0, -1.0)[kept] * np.sign(lateral[first])[kept]
    left = np.column_stack([-directions[one[first]][kept, 1], directions[one[first]][kept, 0]])
    return Neighbours(pairs=pairs, direction=sign[:, None] * left)


def _thinned(frames: Sequence[Frame], spacing: FloatArray, *, step: float) -> Indices:
    """Return the ends of each line and every so many frames that they lie a step apart [m]."""
    line = np.array([frame.line for frame in frames])
    other = line[1:] != line[:-1]
    first, last = np.append(True, other), np.append(other, True)
    count = np.arange(len(line))
    count -= np.maximum.accumulate(np.where(first, count, 0))
    every = np.maximum(step / np.maximum(spacing, ROUNDING * step), 1.0).astype(np.int64)
    return np.flatnonzero((count % every == 0) | last)


def _spacing(frames: Sequence[Frame]) -> FloatArray:
    """Return the longer way from each frame to those before and after it on its line [m]."""
    place = np.array([frame.pose.position[:2] for frame in frames])
    line = np.array([frame.line for frame in frames])
    steps = np.linalg.norm(np.diff(place, axis=0), axis=1) * (line[1:] == line[:-1])
    return np.asarray(np.maximum(np.append(steps, 0.0), np.insert(steps, 0, 0.0)))


def _along(apart: FloatArray, direction: FloatArray) -> FloatArray:
    return np.asarray(np.sum(apart * direction, axis=1))


def _reach(seen: Views, which: Indices, origin: FloatArray, direction: FloatArray) -> FloatArray:
    """Return how far views go from places (pairs, 2) in directions (pairs, 2) [m]."""
    ring = seen.outline[which, :, :2] - origin[:, None]
    along = np.einsum("pcx,px->pc", ring, direction)
    aside = ring[..., 1] * direction[:, None, 0] - ring[..., 0] * direction[:, None, 1]
    after, beside = np.roll(along, -1, axis=1), np.roll(aside, -1, axis=1)
    crosses = (aside <= 0.0) != (beside <= 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        meets = along + (after - along) * aside / (aside - beside)
    farthest = np.where(crosses, meets, -np.inf).max(axis=1, initial=-np.inf)
    whole = np.isfinite(ring).all(axis=(1, 2))
    return np.where(whole & (farthest > 0.0), farthest, np.nan)

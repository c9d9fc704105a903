r"""Normal equations of strips whose points lie on one another's planes.

A point p of one strip and its neighbour q in the other should lie in one plane:
n . (p - q) = 0 (point-to-plane: Chen and Medioni 1992). Over a flat bed the normals n carry noise
alone, and its square would pass for shape: \sum n_x^2 grows with every point. So each product takes
one factor from each strip's own normals, whose errors are independent:

    N = 1/2 \sum w (x z' + z x'),   b = 1/2 \sum w (z r_x + x r_z),

x and r_x by the normal at q, z and r_z by that at p (instrumental variables). N is the shape that
both strips see, and has no bias where they see none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.matching import nearest, normals_of
from survey.cloud.strip_unknowns import Unknowns
from survey.cloud.strips import Strip

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]

ROBUST = 2.0
"""Deviations beyond which a residual weighs less (Huber)."""
FALSE_MATCH = 1.5  # [m]
BLOCK = 10.0  # [m]


@dataclass(frozen=True, kw_only=True)
class Match:
    """Points of one strip against planes of another.

    Parameters
    ----------
    first, second : int
        Places of the strips in their sequence.
    i, j : array (k,)
        Matched points of the first and the second strip.
    apart : array (k, 3)
        First less second place [m].
    first_normal, second_normal : array (k, 3)
        Of the planes around them.
    """

    first: int
    second: int
    i: IndexArray
    j: IndexArray
    apart: FloatArray
    first_normal: FloatArray
    second_normal: FloatArray

    @property
    def residuals(self) -> FloatArray:
        """Distances from the planes, mean of both [m]."""
        normal = self.first_normal + self.second_normal
        return np.asarray(0.5 * np.sum(normal * self.apart, axis=1))

    def weights(self, deviation: float) -> FloatArray:
        """Return the weight of each pair, one half where nothing is wrong: it counts both ways."""
        size = np.abs(self.residuals)
        huber = ROBUST * deviation / np.maximum(size, ROBUST * deviation)
        return 0.5 * np.where(size > FALSE_MATCH, 0.0, huber)


def matches(
    strips: Sequence[Strip], places: Sequence[FloatArray], *, reach: float, radius: float
) -> list[Match]:
    """Return the matches of every two strips that overlap, both ways.

    Parameters
    ----------
    strips : sequence of Strip
    places : sequence of arrays (n, 3)
        Where their points are thought to be [m].
    reach, radius : float
        Distance of neighbours, and radius of the planes [m].
    """
    normals = [normals_of(place, radius=radius) for place in places]
    found = []
    for a, b in combinations(range(len(strips)), 2):
        for first, second in ((a, b), (b, a)):
            if not _boxes_meet(places[first], places[second], reach):
                continue
            i, j = nearest(places[first], places[second], reach=reach)
            if len(i):
                found.append(
                    Match(
                        first=first,
                        second=second,
                        i=i,
                        j=j,
                        apart=places[first][i] - places[second][j],
                        first_normal=normals[first][i],
                        second_normal=normals[second][j],
                    )
                )
    return found


def _boxes_meet(one: FloatArray, other: FloatArray, reach: float) -> bool:
    gap = np.maximum(one.min(axis=0) - other.max(axis=0), other.min(axis=0) - one.max(axis=0))
    return bool((gap <= reach).all())


@dataclass
class Equations:
    """Sums over matches, for unknowns of some number.

    Parameters
    ----------
    size : int
        Unknowns.
    matrix, right : array (size, size), (size,)
        N and b of the module's text.
    scatter : array (size, size)
        Covariance of b when residuals are independent and of unit variance.
    by_frame : dict
        How an offset of one frame moves b (size, 3), by frame.
    """

    size: int
    matrix: FloatArray = field(init=False)
    right: FloatArray = field(init=False)
    scatter: FloatArray = field(init=False)
    by_frame: dict[int, FloatArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.matrix, self.scatter = np.zeros((2, self.size, self.size))
        self.right = np.zeros(self.size)

    def add(
        self,
        match: Match,
        columns: FloatArray,
        at: IndexArray,
        weights: FloatArray,
        frames: tuple[NDArray[np.uint32], NDArray[np.uint32]],
    ) -> None:
        """Add a match.

        Parameters
        ----------
        match : Match
        columns : array (k, 3, m)
            How unknowns move `match.apart`.
        at : array (m,)
            Which unknowns these are.
        weights : array (k,)
        frames : arrays (k,), (k,)
            Frames of the first and the second points.
        """
        x = np.einsum("kj,kjm->km", match.second_normal, columns)
        z = np.einsum("kj,kjm->km", match.first_normal, columns)
        r_x = -np.sum(match.second_normal * match.apart, axis=1)
        r_z = -np.sum(match.first_normal * match.apart, axis=1)
        both, mean = x.T @ (z * weights[:, None]), 0.5 * (x + z)
        self.matrix[np.ix_(at, at)] += 0.5 * (both + both.T)
        self.right[at] += 0.5 * (z.T @ (weights * r_x) + x.T @ (weights * r_z))
        self.scatter[np.ix_(at, at)] += mean.T @ (mean * weights[:, None])
        lever = np.einsum("k,km,kj->kmj", 0.5 * weights, z, match.second_normal)
        lever += np.einsum("k,km,kj->kmj", 0.5 * weights, x, match.first_normal)
        for sign, frame in zip((1.0, -1.0), frames, strict=True):
            numbers, of_match = np.unique(frame, return_inverse=True)
            sums = np.zeros((len(numbers), *lever.shape[1:]))
            np.add.at(sums, of_match, lever)
            for number, part in zip(numbers.tolist(), sums, strict=True):
                self.by_frame.setdefault(number, np.zeros((self.size, 3)))[at] += sign * part


def equations_of(
    found: Sequence[Match],
    strips: Sequence[Strip],
    unknowns: Unknowns,
    values: FloatArray,
    deviation: float,
) -> Equations:
    """Return the normal equations of all matches at values of the unknowns."""
    derivatives = [unknowns.derivatives(strip, values) for strip in strips]
    common = len(unknowns.common)
    sums = Equations(size=len(values))
    for match in found:
        shared = derivatives[match.first][match.i] - derivatives[match.second][match.j]
        each = np.broadcast_to(np.eye(3), (len(match.i), 3, 3))
        at = [*range(common)]
        at += [
            common + 3 * strip + axis for strip in (match.first, match.second) for axis in range(3)
        ]
        sums.add(
            match,
            np.concatenate([shared, each, -each], axis=2),
            np.array(at),
            match.weights(deviation),
            (strips[match.first].frame[match.i], strips[match.second].frame[match.j]),
        )
    return sums


@dataclass(frozen=True, kw_only=True)
class Noise:
    """How residuals scatter.

    Parameters
    ----------
    deviation : float
        Of one, from their median [m].
    blocks : float
        Variance of means over 10 m over what independent residuals would give, at least 1.
    frame : float
        Of what all points of one frame share, up [m].
    """

    deviation: float
    blocks: float
    frame: float


def noise_of(
    found: Sequence[Match], strips: Sequence[Strip], places: Sequence[FloatArray]
) -> Noise:
    """Return how the residuals of matches scatter."""
    sizes = np.concatenate([np.abs(match.residuals) for match in found])
    deviation = max(1.4826 * float(np.median(sizes)), 1e-4)
    squares, blocks, means, expected = 0.0, 0, [0.0], [0.0]
    for match in found:
        kept = match.weights(deviation) > 0.25
        residuals = match.residuals[kept]
        frames = [strips[match.first].frame[match.i], strips[match.second].frame[match.j]]
        pair = np.column_stack(frames)[kept]
        block = np.floor(places[match.first][match.i][kept, :2] / BLOCK)
        sums, counts = _grouped(np.column_stack([pair, block]), residuals)
        squares, blocks = squares + float(np.sum(sums**2 / counts)), blocks + len(sums)
        sums, counts = _grouped(pair, residuals)
        means += (sums / counts)[counts >= 50].tolist()
        expected += (1.0 / counts)[counts >= 50].tolist()
    within = max(1.0, squares / max(blocks, 1) / deviation**2)
    shared = float(np.mean(np.square(means)) - np.mean(expected) * deviation**2 * within)
    frame = float(np.sqrt(max(shared, 0.0) / 2.0))
    return Noise(deviation=deviation, blocks=within, frame=frame)


def _grouped(keys: NDArray[Any], values: FloatArray) -> tuple[FloatArray, FloatArray]:
    _, group = np.unique(keys, axis=0, return_inverse=True)
    sums = np.bincount(group, values).astype(np.float64)
    return sums, np.bincount(group).astype(np.float64)

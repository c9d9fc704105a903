"""Strips brought together: unknowns solved for as far as the shape of the overlaps tells them.

All pairs of lines enter one least squares, a pose graph whose edges are the pairs' normal
equations. open3d's own graph optimisation is not used: its information matrix is that of points on
points, which takes a flat bed for one that fixes all six directions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from survey.cloud.strip_equations import (
    Equations,
    Match,
    Noise,
    equations_of,
    matches,
    noise_of,
)
from survey.cloud.strip_unknowns import ANGLES, AXES, Mode, Unknowns
from survey.cloud.strips import Strip
from survey.flight.navigation import Mounting

FloatArray = NDArray[np.float64]

LARGEST_ERROR = 0.25
"""Standard error above which a direction is not corrected [m]."""
LARGEST_SHARE = 0.5
"""The same, over what was expected before."""
RESOLVED = 0.5
"""Share of an unknown in the directions that are corrected, from which it counts as solved."""
FEWEST_MATCHES = 200
FEWEST_STEPS, MOST_STEPS, DAMPING = 4, 16, 0.5
"""The first look at strips far apart takes their distance for noise, and less for told. Later steps
are halved, for neighbours that change to and fro would keep whole ones going for ever."""
SMALL_STEP = 0.3
"""Step over standard error at which strips are at rest: some neighbours change for ever."""
LEAST_STEP = 0.002  # [m]
REACH, RADIUS = 1.0, 3.0  # [cells]


class AdjustmentError(ValueError):
    """Strips that cannot be adjusted; the text says why."""


@dataclass(frozen=True, kw_only=True)
class PairShape:
    """What one overlap tells by itself, after the adjustment.

    Parameters
    ----------
    lines : tuple of int
        Two lines.
    matches : int
        Points of one on planes of the other, both ways.
    shift, shift_error : array (3,)
        How far the first lies from the second: east, north, up, with standard errors [m], from 1 m
        of doubt before.
    information : array (6,)
        Eigenvalues of the normal equations of a shift and of turns, as told at the radius of
        gyration [1/m2]: the inverse squares of standard errors, small where there is no shape.
    """

    lines: tuple[int, int]
    matches: int
    shift: FloatArray
    shift_error: FloatArray
    information: FloatArray


@dataclass(frozen=True, kw_only=True)
class Adjustment:
    """What the strips tell.

    Parameters
    ----------
    unknowns : Unknowns
    values : array (size,)
        What is corrected [m]; zero where nothing is told.
    errors : array (size,)
        Standard errors of the unknowns [m].
    resolved : array (size,)
        How much of each unknown is told, from 0 to 1.
    noise : Noise
        Of the residuals that are left.
    pairs : sequence of PairShape
    """

    unknowns: Unknowns
    values: FloatArray
    errors: FloatArray
    resolved: FloatArray
    noise: Noise
    pairs: Sequence[PairShape]

    @property
    def mounting(self) -> Mounting:
        """How the sensor truly sits against what was believed."""
        return self.unknowns.mounting(self.values)

    def offset(self, line: int) -> FloatArray:
        """Return what to add to the points of a line (3,) [m]."""
        offsets = self.unknowns.offsets(self.values)
        return np.asarray(offsets[self.unknowns.lines.index(line)])


def adjust(
    strips: Sequence[Strip],
    *,
    mode: Mode,
    cell_size: float,
    line_deviations: FloatArray | None = None,
    frame_deviations: FloatArray | None = None,
    largest_error: float = LARGEST_ERROR,
) -> Adjustment:
    """Solve for mounting and offsets of lines from the differences of strips.

    Gauss-Newton steps, neighbours and planes sought anew at each. Every unknown has the deviation
    that is expected of it before; so the mean of the lines' offsets, which differences do not tell,
    stays zero.

    Parameters
    ----------
    strips : sequence of Strip
    mode : {"boresight", "offsets"}
        One mounting for the survey and an offset for each line, or offsets alone.
    cell_size : float
        Distance of neighbouring points [m].
    line_deviations : array (3,), optional
        Standard deviation of a line's place: east, north, up [m].
    frame_deviations : array (3,), optional
        The same for what is new at every frame.
    largest_error : float
        Standard error above which a direction is not corrected [m].

    Raises
    ------
    AdjustmentError
        When there are too few lines or overlaps, or when the overlaps carry no shape.
    """
    if len(strips) < 2:
        raise AdjustmentError(
            f"{len(strips)} line with points on bottom or land. Strips are adjusted by what two "
            "lines or more see in common: fly more lines"
        )
    unknowns = Unknowns.of(strips, mode=mode, line_deviations=line_deviations)
    values = np.zeros(len(unknowns.expected))
    for number in range(MOST_STEPS):
        found, noise, system = _look(strips, unknowns, values, cell_size)
        step = _solved(system, unknowns, noise, values)
        covariance = _covariance(system, unknowns, noise, frame_deviations)
        kept = _kept(covariance, unknowns, largest_error)
        values = values + (step if number < FEWEST_STEPS else DAMPING * step)
        told = np.abs(kept @ (step / unknowns.expected)) * unknowns.expected
        small = np.maximum(SMALL_STEP * _errors(covariance, unknowns), LEAST_STEP)
        if number + 1 >= FEWEST_STEPS and (told < small).all():
            break
    else:
        raise AdjustmentError(
            f"the strips do not come to rest: still {told.max():.2f} m after {MOST_STEPS} steps. "
            "The lines lie too far apart for their shapes to be matched; see the overlaps"
        )
    result = Adjustment(
        unknowns=unknowns,
        values=kept @ (values / unknowns.expected) * unknowns.expected,
        errors=_errors(covariance, unknowns),
        resolved=_resolved(kept, unknowns),
        noise=noise,
        pairs=_pairs(found, strips, [unknowns.places(strip, values) for strip in strips], noise),
    )
    _require_shape(result)
    return result


def _look(
    strips: Sequence[Strip], unknowns: Unknowns, values: FloatArray, cell_size: float
) -> tuple[list[Match], Noise, Equations]:
    places = [unknowns.places(strip, values) for strip in strips]
    found = matches(strips, places, reach=REACH * cell_size, radius=RADIUS * cell_size)
    count = sum(len(match.i) for match in found)
    if count < FEWEST_MATCHES:
        overlap = "no two lines overlap" if count == 0 else f"only {count} points lie in overlaps"
        raise AdjustmentError(
            f"{overlap}, where {FEWEST_MATCHES} are needed. Fly with more sidelap, or a cross line"
        )
    noise = noise_of(found, strips, places)
    return found, noise, equations_of(found, strips, unknowns, values, noise.deviation)


def _solved(system: Equations, unknowns: Unknowns, noise: Noise, values: FloatArray) -> FloatArray:
    """Return the next step [m]."""
    right = system.right * unknowns.expected / _variance(noise) - values / unknowns.expected
    return np.asarray(_inverse(system, unknowns, noise) @ right * unknowns.expected)


def _inverse(system: Equations, unknowns: Unknowns, noise: Noise) -> FloatArray:
    """Return the inverse of the normal matrix with what is expected, in units of the expected."""
    matrix = system.matrix * np.outer(unknowns.expected, unknowns.expected) / _variance(noise)
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray((vectors / (1.0 + np.maximum(values, 0.0))) @ vectors.T)


def _variance(noise: Noise) -> float:
    return noise.deviation**2 * noise.blocks


def _covariance(
    system: Equations, unknowns: Unknowns, noise: Noise, frame_deviations: FloatArray | None
) -> FloatArray:
    """Return the covariance of the unknowns in units of what was expected of them.

    Of independent residuals, of what the points of a frame share, and of what was expected.
    """
    variance = _variance(noise)
    shared = np.zeros(3) if frame_deviations is None else frame_deviations.copy()
    shared[2] = max(shared[2], noise.frame)
    right = system.scatter / variance
    for part in system.by_frame.values():
        moved = part * shared / variance
        right += moved @ moved.T
    right *= np.outer(unknowns.expected, unknowns.expected)
    inverse = _inverse(system, unknowns, noise)
    return np.asarray(inverse @ (right + np.eye(len(right))) @ inverse)


def _kept(covariance: FloatArray, unknowns: Unknowns, largest_error: float) -> FloatArray:
    """Return the matrix that keeps the directions of the unknowns that are told well enough."""
    free = np.flatnonzero(~unknowns.is_ranging)
    variances, vectors = np.linalg.eigh(covariance[np.ix_(free, free)])
    errors = np.sqrt(np.maximum(variances, 0.0))
    metres = errors * np.linalg.norm(vectors * unknowns.expected[free, None], axis=0)
    good = vectors[:, (errors < LARGEST_SHARE) & (metres < largest_error)]
    kept = np.zeros(covariance.shape)
    kept[np.ix_(free, free)] = good @ good.T
    return kept


def _errors(covariance: FloatArray, unknowns: Unknowns) -> FloatArray:
    """Return standard errors [m]; of offsets alone, against their mean, which nothing tells."""
    centre = np.eye(len(covariance))
    if unknowns.mode == "offsets":
        lines = len(unknowns.lines)
        centre -= np.kron(np.full((lines, lines), 1.0 / lines), np.eye(3))
    variances = np.diag(centre @ covariance @ centre)
    return np.asarray(np.sqrt(variances) * unknowns.expected)


def _resolved(kept: FloatArray, unknowns: Unknowns) -> FloatArray:
    """Return how much of each unknown is told, from 0 to 1; of offsets, against their mean."""
    share = np.diag(kept).copy()
    lines = len(unknowns.lines)
    share[len(unknowns.common) :] *= lines / (lines - 1.0)
    return np.minimum(share, 1.0)


def _require_shape(found: Adjustment) -> None:
    """Raise unless something is told of what moves points sideways."""
    unknowns, boresight = found.unknowns, slice(len(ANGLES))
    shares, errors = (unknowns.offsets(part) for part in (found.resolved, found.errors))
    sideways, least = shares[:, :2].max(), errors[:, :2].min()
    if unknowns.mode == "boresight":
        sideways, least = found.resolved[boresight].max(), found.errors[boresight].min()
    if sideways >= RESOLVED:
        return
    told = [axis for axis, share in zip(AXES, shares.max(axis=0), strict=True) if share >= RESOLVED]
    what = "roll, pitch and heading" if unknowns.mode == "boresight" else "east and north"
    raise AdjustmentError(
        "refused: the overlaps carry too little shape. Over a flat or evenly sloping bed strips "
        f"fit wherever they lie: of {what} the best would have a standard error of {least:.2f} m, "
        f"and {' and '.join(told) or 'nothing'} alone is told. Fly over relief or land"
    )


def _pairs(
    found: Sequence[Match], strips: Sequence[Strip], places: Sequence[FloatArray], noise: Noise
) -> list[PairShape]:
    """Return what each overlap tells; the two matches of a pair follow one another."""
    shapes = []
    for forth, back in pairwise(found):
        if (forth.first, forth.second) != (back.second, back.first) or forth.first > forth.second:
            continue
        centre = places[forth.first][forth.i].mean(axis=0)
        spread = places[forth.first][forth.i] - centre
        radius = float(np.sqrt(np.mean(np.sum(spread**2, axis=1))))
        system = Equations(size=6)
        for sign, match in ((1.0, forth), (-1.0, back)):
            out = (places[match.first][match.i] - centre) / max(radius, 1e-9)
            turns = np.stack([np.cross(axis, out) for axis in np.eye(3)], axis=2)
            each = np.broadcast_to(np.eye(3), turns.shape)
            columns = sign * np.concatenate([each, turns], axis=2)
            frames = (strips[match.first].frame[match.i], strips[match.second].frame[match.j])
            system.add(match, columns, np.arange(6), match.weights(noise.deviation), frames)
        shift, error = _shift(system, noise)
        shapes.append(
            PairShape(
                lines=(strips[forth.first].line, strips[forth.second].line),
                matches=len(forth.i) + len(back.i),
                shift=shift,
                shift_error=error,
                information=np.asarray(np.linalg.eigvalsh(system.matrix)[::-1] / _variance(noise)),
            )
        )
    return shapes


def _shift(system: Equations, noise: Noise) -> tuple[FloatArray, FloatArray]:
    """Return how far a pair lies apart, and the standard error, from 1 m of doubt before [m]."""
    values, vectors = np.linalg.eigh(system.matrix[:3, :3] / _variance(noise))
    inverse = (vectors / (1.0 + np.maximum(values, 0.0))) @ vectors.T
    scatter = system.scatter[:3, :3] / _variance(noise) + np.eye(3)
    error = np.sqrt(np.diag(inverse @ scatter @ inverse))
    return -inverse @ system.right[:3] / _variance(noise), error

"""Random walks in open water, drawn once for a flash and then laid anywhere, in any direction.

Where the water is the same everywhere a walk may be shifted and turned at will. A few thousand
tracks therefore serve all light paths of a flash, from the laser's side and from the pixels'.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from survey.transport.directions import drawn, turned
from survey.transport.random import TRACKS, exponential, start_stream, uniform
from survey.transport.scene import Medium
from terrain.kernels import kernel, leaf_kernel

LOST_CHANCE = 0.25


class Course(NamedTuple):
    """A track of a set, taken for a walk: its number, weight and first optical length."""

    track: int
    weight: float
    optical: float


class Tracks(NamedTuple):
    """Sets of tracks: of every replicate one for the light's way down, one for the way back.

    ``legs`` (sets, tracks, legs, 4) holds the direction of every leg, in a frame whose third axis
    is the first leg, and its optical length in scatterings. ``first_wide`` (sets, tracks) is the
    first leg after a scattering by more than the split angle, the number of legs if there is none.
    Tracks of a set stand in the order of their paths to a certain depth, so that numbers spread
    evenly over a set choose fast and late light evenly; ``reached`` (sets,) of them get there
    within their legs.
    """

    legs: NDArray[np.float32]
    first_wide: NDArray[np.int64]
    reached: NDArray[np.int64]


@leaf_kernel
def way_to(depth: float, legs: NDArray[np.float32]) -> tuple[float, float, float]:
    """Path of a track to a depth along its first leg, and how far aside it is there.

    All in scatterings; a track that does not get there within its legs has an infinite path, and
    is where its legs end.
    """
    x = y = path = reached = 0.0
    for k in range(legs.shape[0]):
        sinking, length = legs[k, 2], legs[k, 3]
        there = reached + sinking * length >= depth
        if there:
            length = (depth - reached) / sinking
        x, y, path = x + legs[k, 0] * length, y + legs[k, 1] * length, path + length
        if there:
            return path, x, y
        reached += sinking * length
    return math.inf, x, y


@kernel
def draw_tracks(
    medium: Medium,
    sets: int,
    tracks: int,
    legs: int,
    depth: float,
    split_cosine: float,
    seed: int,
    frame: int,
) -> Tracks:
    """Draw the tracks of a flash and order them by their paths to a ``depth`` [m].

    In each set the first optical lengths are stratified. Tracks of equal paths, as those of all
    light that has not scattered yet, stay in the order in which they were drawn.
    """
    result = np.empty((sets, tracks, legs, 4), np.float32)
    first_wide, reached = np.empty((sets, tracks), np.int64), np.empty(sets, np.int64)
    unordered = np.empty((tracks, legs, 4), np.float32)
    wide, path = np.empty(tracks, np.int64), np.empty(tracks)
    state = np.empty(2, np.uint64)
    for i in range(sets):
        for j in range(tracks):
            start_stream(state, seed, TRACKS, frame, i, j)
            dx, dy, dz = 0.0, 0.0, 1.0
            optical = -math.log(1.0 - (j + uniform(state)) / tracks)
            wide[j] = legs
            for k in range(legs):
                if k > 0:
                    bend = drawn(medium.sampler, medium.sampler_share, state)
                    dx, dy, dz = turned(dx, dy, dz, bend, 2.0 * math.pi * uniform(state))
                    if 1.0 - bend < split_cosine:
                        wide[j] = min(wide[j], k)
                    optical = exponential(state)
                leg = unordered[j, k]
                leg[0], leg[1], leg[2], leg[3] = dx, dy, dz, optical
            path[j], _, _ = way_to(depth * medium.scattering, unordered[j])
        order = np.argsort(path, kind="mergesort")
        reached[i] = np.isfinite(path).sum()
        for j in range(tracks):
            result[i, j] = unordered[order[j]]
            first_wide[i, j] = wide[order[j]]
    return Tracks(result, first_wide, reached)


@leaf_kernel
def course(tracks: Tracks, which: int, track: int, weight: float) -> Course:
    """Take a track of a set."""
    return Course(track, weight, tracks.legs[which, track, 0, 3])


@leaf_kernel
def chosen(tracks: Tracks, which: int, place: float) -> Course:
    """Take the track of a set at a ``place`` from 0 to 1.

    Tracks that do not reach the depth matter little: where they are few, they are chosen a quarter
    as often.
    """
    n, reached = tracks.first_wide.shape[1], tracks.reached[which]
    rarely = max(LOST_CHANCE, (n - reached) / n)
    share = 1.0 - rarely * (n - reached) / n
    if place < share:
        return course(tracks, which, int(place / share * reached), reached / (n * share))
    lost = (place - share) / (1.0 - share)
    return course(tracks, which, min(n - 1, reached + int(lost * (n - reached))), 1.0 / rarely)


@leaf_kernel
def axes_around(
    dx: float, dy: float, dz: float, circle: NDArray[np.float64], state: NDArray[np.uint64]
) -> tuple[float, float, float, float, float, float]:
    """Two unit vectors that make a frame with d, turned about d by an azimuth of ``circle``."""
    i = int(uniform(state) * circle.shape[0])
    c, s = circle[i, 0], circle[i, 1]
    sign = 1.0 if dz >= 0.0 else -1.0
    shear = -1.0 / (sign + dz)
    mixed = dx * dy * shear
    ax, ay, az = 1.0 + sign * dx * dx * shear, sign * mixed, -sign * dx
    bx, by, bz = mixed, sign + dy * dy * shear, -dy
    return (
        c * ax + s * bx, c * ay + s * by, c * az + s * bz,
        c * bx - s * ax, c * by - s * ay, c * bz - s * az,
    )  # fmt: skip

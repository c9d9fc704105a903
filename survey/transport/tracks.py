"""Random walks in open water, drawn once for a flash and then laid anywhere, in any direction.

Where the water is the same everywhere a walk may be shifted and turned at will; where it changes
with depth alone its turns and optical lengths may. A few thousand tracks therefore serve all light
paths of a flash, from the laser's side and from the pixels'.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from survey.optics.interface import reflected
from survey.transport.directions import turned
from survey.transport.layers import Layers, bend_at, free_path
from survey.transport.random import TRACKS, exponential, start_stream, uniform
from terrain.kernels import inlined_fused_kernel, kernel, leaf_kernel

LOST_CHANCE = 0.5


class Course(NamedTuple):
    """A track of a set, taken for a walk: its number, weight and first optical length."""

    track: int
    weight: float
    optical: float


class Tracks(NamedTuple):
    """Sets of tracks: of every replicate one for the light's way down, one for the way back.

    ``legs`` (sets, tracks, legs, 4) holds the direction of every leg, in a frame whose third axis
    is the first leg, and its optical length in scatterings. Where the phase function changes with
    depth it holds, instead of a direction, how likely a smaller turn is than that which leads to
    the leg, and the turn's azimuth [rad]. Tracks of a set stand in the order of their paths to a
    certain depth, so that numbers spread evenly over a set choose fast and late light evenly;
    ``reached`` (sets,) of them get there within their legs. ``aside`` (sets, tracks, 2) is how far
    sideways they are there, or where their legs end [m]: along the first axis, but for tracks whose
    turns are looked up, which cannot be turned as one.
    """

    legs: NDArray[np.float32]
    aside: NDArray[np.float64]
    reached: NDArray[np.int64]


class Frame(NamedTuple):
    """Axes that a track is laid by, the third along its first leg."""

    ax: float
    ay: float
    az: float
    bx: float
    by: float
    bz: float
    cx: float
    cy: float
    cz: float


@inlined_fused_kernel
def direction_along(
    layers: Layers,
    row: NDArray[np.float32],
    turning: bool,
    depth: float,
    frame: Frame,
    dx: float,
    dy: float,
    dz: float,
) -> tuple[float, float, float]:
    """Return a leg's direction; it begins at a depth, ``turning`` from d or going on along it."""
    if layers.samplers.shape[0] > 1:
        if turning:
            return turned(dx, dy, dz, bend_at(layers, depth, row[0]), row[1])
        return dx, dy, dz
    ax, ay, az, bx, by, bz, cx, cy, cz = frame
    return (
        row[0] * ax + row[1] * bx + row[2] * cx,
        row[0] * ay + row[1] * by + row[2] * cy,
        row[0] * az + row[1] * bz + row[2] * cz,
    )


@leaf_kernel
def way_to(layers: Layers, depth: float, legs: NDArray[np.float32]) -> tuple[float, float, float]:
    """Path of a track that begins straight down to a depth, and how far aside it is there [m].

    A track that does not get there within its legs has an infinite path, and is where they end.
    """
    frame = Frame(1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0)
    x = y = path = reached = dx = dy = 0.0
    dz = -1.0
    for k in range(legs.shape[0]):
        dx, dy, dz = direction_along(layers, legs[k], k > 0, reached, frame, dx, dy, dz)
        length = free_path(layers, reached, -dz, legs[k, 3])
        there = reached - dz * length >= depth
        if there:
            length = (depth - reached) / -dz
        x, y, path = x + dx * length, y + dy * length, path + length
        if there:
            return path, x, y
        reached -= dz * length
    return math.inf, x, y


@kernel
def draw_tracks(
    layers: Layers, sets: int, tracks: int, legs: int, depth: float, seed: int, frame: int
) -> Tracks:
    """Draw the tracks of a flash and order them by their paths to a ``depth`` [m].

    In each set the first optical lengths are stratified. Tracks of equal paths, as those of all
    light that has not scattered yet, stay in the order in which they were drawn.
    """
    result = np.empty((sets, tracks, legs, 4), np.float32)
    aside, reached = np.empty((sets, tracks, 2)), np.empty(sets, np.int64)
    unordered, path = np.empty((tracks, legs, 4), np.float32), np.empty(tracks)
    strayed = np.empty((tracks, 2))
    state = np.empty(2, np.uint64)
    several = layers.samplers.shape[0] > 1
    for i in range(sets):
        for j in range(tracks):
            start_stream(state, seed, TRACKS, frame, i, j)
            dx, dy, dz = 0.0, 0.0, 1.0
            optical = -math.log(1.0 - (j + uniform(state)) / tracks)
            unordered[j, 0] = dx, dy, dz, optical
            for k in range(1, legs):
                chance, azimuth = uniform(state), 2.0 * math.pi * uniform(state)
                optical = exponential(state)
                if several:
                    unordered[j, k] = chance, azimuth, 0.0, optical
                    continue
                dx, dy, dz = turned(dx, dy, dz, bend_at(layers, 0.0, chance), azimuth)
                unordered[j, k] = dx, dy, dz, optical
            path[j], strayed[j, 0], strayed[j, 1] = way_to(layers, depth, unordered[j])
        order = np.argsort(path, kind="mergesort")
        reached[i] = np.isfinite(path).sum()
        for j in range(tracks):
            result[i, j], aside[i, j] = unordered[order[j]], strayed[order[j]]
            if not several:
                turn_aside(result[i, j], aside[i, j])
    return Tracks(result, aside, reached)


@leaf_kernel
def turn_aside(legs: NDArray[np.float32], aside: NDArray[np.float64]) -> None:
    """Turn a track about its first leg until it strays along the first axis."""
    away = math.sqrt(aside[0] * aside[0] + aside[1] * aside[1])
    if away == 0.0:
        return
    c, s = aside[0] / away, aside[1] / away
    for k in range(legs.shape[0]):
        a, b = legs[k, 0], legs[k, 1]
        legs[k, 0], legs[k, 1] = c * a - s * b, s * a + c * b
    aside[0], aside[1] = away, 0.0


@leaf_kernel
def course(tracks: Tracks, which: int, track: int, weight: float) -> Course:
    """Take a track of a set."""
    return Course(track, weight, tracks.legs[which, track, 0, 3])


@leaf_kernel
def chosen(tracks: Tracks, which: int, place: float) -> Course:
    """Take the track of a set at a ``place`` from 0 to 1.

    Tracks that do not reach the depth light the column alone: where they are few, they are chosen
    half as often. A quarter as often would treble the column's variance in harbor water.
    """
    n, reached = tracks.legs.shape[1], tracks.reached[which]
    rarely = max(LOST_CHANCE, (n - reached) / n)
    share = 1.0 - rarely * (n - reached) / n
    if place < share:
        return course(tracks, which, int(place / share * reached), reached / (n * share))
    lost = (place - share) / (1.0 - share)
    return course(tracks, which, min(n - 1, reached + int(lost * (n - reached))), 1.0 / rarely)


@leaf_kernel
def frame_around(
    dx: float, dy: float, dz: float, circle: NDArray[np.float64], turn: float
) -> Frame:
    """Axes with d as the third, turned about it by the azimuth at a part ``turn`` of ``circle``."""
    i = int(turn * circle.shape[0])
    c, s = circle[i, 0], circle[i, 1]
    sign = 1.0 if dz >= 0.0 else -1.0
    shear = -1.0 / (sign + dz)
    mixed = dx * dy * shear
    ax, ay, az = 1.0 + sign * dx * dx * shear, sign * mixed, -sign * dx
    bx, by, bz = mixed, sign + dy * dy * shear, -dy
    return Frame(
        c * ax + s * bx, c * ay + s * by, c * az + s * bz,
        c * bx - s * ax, c * by - s * ay, c * bz - s * az,
        dx, dy, dz,
    )  # fmt: skip


@inlined_fused_kernel
def aside_of(
    layers: Layers,
    tracks: Tracks,
    which: int,
    way: Course,
    circle: NDArray[np.float64],
    turn: float,
) -> tuple[float, float]:
    """How far a track strays to east and north, laid straight down with an azimuth [m]."""
    aside = tracks.aside[which, way.track]
    if layers.samplers.shape[0] > 1:
        return aside[0], aside[1]
    i = int(turn * circle.shape[0])
    return circle[i, 0] * aside[0], -circle[i, 1] * aside[0]


@leaf_kernel
def mirrored(frame: Frame, mx: float, my: float, mz: float) -> Frame:
    """Axes reflected by a facet of unit normal m."""
    ax, ay, az = reflected(frame.ax, frame.ay, frame.az, mx, my, mz)
    bx, by, bz = reflected(frame.bx, frame.by, frame.bz, mx, my, mz)
    cx, cy, cz = reflected(frame.cx, frame.cy, frame.cz, mx, my, mz)
    return Frame(ax, ay, az, bx, by, bz, cx, cy, cz)

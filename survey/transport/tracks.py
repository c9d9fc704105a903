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
from survey.transport.launch import Optics, direction_of, tangents_at
from survey.transport.layers import Layers, bend_at, free_path
from survey.transport.random import TRACKS, exponential, start_stream, uniform
from terrain.kernels import inlined_fused_kernel, kernel, leaf_kernel

LOST_CHANCE = 0.5
TILTS, TILT_STEP = 8, 0.03
"""Directions by whose paths tracks are ordered: their number, and tangents between them."""


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
    ``reached`` (sets,) of them get there within their legs, ``early`` (sets,) of these with hardly
    any detour. ``aside`` (sets, tracks, 2) is how far sideways along the first two axes they are
    there, or where their legs end [m].

    Laid aslant, its first axis uphill, a track comes to the depth sooner or later: ``order``
    (tilts, sets, tracks) holds their numbers by the paths of each tilt. Tracks whose turns are
    looked up cannot be turned as one: their order is that of no tilt.
    """

    legs: NDArray[np.float32]
    aside: NDArray[np.float64]
    reached: NDArray[np.int64]
    early: NDArray[np.int64]
    order: NDArray[np.int64]


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


@leaf_kernel
def draw_track(
    layers: Layers, place: float, legs: NDArray[np.float32], state: NDArray[np.uint64]
) -> None:
    """Draw the legs of a track; ``place``, 0 to 1, tells the first one's optical length."""
    dx, dy, dz = 0.0, 0.0, 1.0
    legs[0] = dx, dy, dz, -math.log(1.0 - place)
    for k in range(1, legs.shape[0]):
        chance, azimuth = uniform(state), 2.0 * math.pi * uniform(state)
        optical = exponential(state)
        if layers.samplers.shape[0] > 1:
            legs[k] = chance, azimuth, 0.0, optical
        else:
            dx, dy, dz = turned(dx, dy, dz, bend_at(layers, 0.0, chance), azimuth)
            legs[k] = dx, dy, dz, optical


@kernel
def draw_tracks(
    layers: Layers,
    sets: int,
    tracks: int,
    legs: int,
    depth: float,
    detour: float,
    seed: int,
    frame: int,
) -> Tracks:
    """Draw the tracks of a flash and order them by their paths to a ``depth`` [m].

    Those are early whose path is longer than the depth by less than a ``detour`` [m]. In each set
    the first optical lengths are stratified. Tracks of equal paths, as those of all light that has
    not scattered yet, stay in the order in which they were drawn.
    """
    result = np.empty((sets, tracks, legs, 4), np.float32)
    aside, orders = np.empty((sets, tracks, 2)), np.empty((TILTS, sets, tracks), np.int64)
    reached, early = np.empty(sets, np.int64), np.empty(sets, np.int64)
    unordered, path = np.empty((tracks, legs, 4), np.float32), np.empty(tracks)
    strayed = np.empty((tracks, 2))
    state = np.empty(2, np.uint64)
    step = 0.0 if layers.samplers.shape[0] > 1 else TILT_STEP
    for i in range(sets):
        for j in range(tracks):
            start_stream(state, seed, TRACKS, frame, i, j)
            draw_track(layers, (j + uniform(state)) / tracks, unordered[j], state)
            path[j], strayed[j, 0], strayed[j, 1] = way_to(layers, depth, unordered[j])
        order = np.argsort(path, kind="mergesort")
        reached[i], early[i] = np.isfinite(path).sum(), (path < depth + detour).sum()
        for j in range(tracks):
            result[i, j], aside[i, j] = unordered[order[j]], strayed[order[j]]
        for tilt in range(TILTS):
            aslant = path[order] + tilt * step * aside[i, :, 0]
            orders[tilt, i] = np.argsort(aslant, kind="mergesort")
    return Tracks(result, aside, reached, early, orders)


@inlined_fused_kernel
def course(tracks: Tracks, which: int, track: int, weight: float) -> Course:
    """Take a track of a set."""
    return Course(track, weight, tracks.legs[which, track, 0, 3])


@inlined_fused_kernel
def part_reached(tracks: Tracks, which: int) -> tuple[float, float]:
    """How often tracks that do not reach the depth are chosen, and the part of the others."""
    n, reached = tracks.legs.shape[1], tracks.reached[which]
    rarely = max(LOST_CHANCE, (n - reached) / n)
    return rarely, 1.0 - rarely * (n - reached) / n


@inlined_fused_kernel
def part_early(tracks: Tracks, which: int) -> float:
    """Part of the places from 0 to 1 at which `chosen` takes an early track."""
    if tracks.early[which] == 0:
        return 0.0
    return float(part_reached(tracks, which)[1] * tracks.early[which] / tracks.reached[which])


@inlined_fused_kernel
def chosen(tracks: Tracks, which: int, place: float, tilt: int) -> Course:
    """Take the track of a set at a ``place`` from 0 to 1, in the order for a tilt.

    Tracks that do not reach the depth light the column alone: where they are few, they are chosen
    half as often. A quarter as often would treble the column's variance in harbor water.
    """
    n, reached = tracks.legs.shape[1], tracks.reached[which]
    rarely, share = part_reached(tracks, which)
    order = tracks.order[tilt, which]
    if place < share:
        return course(tracks, which, order[int(place / share * reached)], reached / (n * share))
    lost = (place - share) / (1.0 - share)
    rank = min(n - 1, reached + int(lost * (n - reached)))
    return course(tracks, which, order[rank], 1.0 / rarely)


@leaf_kernel
def frame_around(
    dx: float, dy: float, dz: float, circle: NDArray[np.float64], turn: float
) -> Frame:
    """Axes with d as the third, turned about it by the azimuth at a part ``turn`` of ``circle``."""
    i = int(turn * circle.shape[0])
    return turned_frame(dx, dy, dz, circle[i, 0], circle[i, 1])


@inlined_fused_kernel
def frame_straying(
    tracks: Tracks,
    which: int,
    track: int,
    dx: float,
    dy: float,
    dz: float,
    circle: NDArray[np.float64],
    turn: float,
) -> Frame:
    """Axes with d as the third by which a track strays to the azimuth of a ``turn``."""
    i, (east, north) = int(turn * circle.shape[0]), tracks.aside[which, track]
    c, s, away = circle[i, 0], circle[i, 1], math.sqrt(east * east + north * north)
    if away > 0.0:
        east, north = east / away, north / away
        c, s = c * east - s * north, s * east + c * north
    return turned_frame(dx, dy, dz, c, s)


@inlined_fused_kernel
def turned_frame(dx: float, dy: float, dz: float, c: float, s: float) -> Frame:
    """Axes with d as the third, turned about it by an azimuth of cosine c and sine s."""
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
def frame_uphill(dx: float, dy: float, dz: float) -> Frame:
    """Axes with d, going down, as the third; the first leads uphill."""
    level = math.sqrt(dx * dx + dy * dy)
    east, north = (dx / level, dy / level) if level > 0.0 else (1.0, 0.0)
    return Frame(-dz * east, -dz * north, level, north, -east, 0.0, dx, dy, dz)


@leaf_kernel
def tilt_of(optics: Optics, index: float, pixel: int) -> int:
    """Which of the orders of tracks is for the way a pixel looks in level water."""
    row, column = pixel // optics.columns, pixel % optics.columns
    forward, right = tangents_at(optics, (row + 0.5) / optics.rows, (column + 0.5) / optics.columns)
    dx, dy, _, _ = direction_of(optics, forward, right)
    sine = math.sqrt(dx * dx + dy * dy) / index
    return min(TILTS - 1, int(sine / math.sqrt(1.0 - sine * sine) / TILT_STEP + 0.5))


@inlined_fused_kernel
def aside_of(
    layers: Layers,
    tracks: Tracks,
    which: int,
    way: Course,
    circle: NDArray[np.float64],
    turn: float,
) -> tuple[float, float]:
    """How far a track strays to east and north, laid straight down to stray to an azimuth [m]."""
    aside = tracks.aside[which, way.track]
    if layers.samplers.shape[0] > 1:
        return aside[0], aside[1]
    i, away = int(turn * circle.shape[0]), math.sqrt(aside[0] * aside[0] + aside[1] * aside[1])
    return circle[i, 0] * away, -circle[i, 1] * away


@leaf_kernel
def mirrored(frame: Frame, mx: float, my: float, mz: float) -> Frame:
    """Axes reflected by a facet of unit normal m."""
    ax, ay, az = reflected(frame.ax, frame.ay, frame.az, mx, my, mz)
    bx, by, bz = reflected(frame.bx, frame.by, frame.bz, mx, my, mz)
    cx, cy, cz = reflected(frame.cx, frame.cy, frame.cz, mx, my, mz)
    return Frame(ax, ay, az, bx, by, bz, cx, cy, cz)

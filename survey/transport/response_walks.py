"""Walks straight down into a bottomless, index-matched half-space, and how they are paired.

Water is the same everywhere, so a walk may be shifted sideways at will: a forward and a backward
walk meet on every plane that both cross. Lit everywhere (flood), each meeting counts in full; lit
and seen through the same square (isolated), it counts by the share of places in the square from
which both walks can start: the product of two triangles of the distance they are apart.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from survey.transport.directions import drawn, turned
from survey.transport.random import exponential, uniform
from survey.transport.scene import Medium
from survey.transport.table import value_at
from terrain.kernels import leaf_kernel

FloatArray = NDArray[np.float64]

FLOOD, ISOLATED = 0, 1
BATCHES = 64
ROULETTE_BELOW, ROULETTE_SURVIVAL = 1e-5, 0.1


class Planes(NamedTuple):
    """Level planes at ``first`` + k ``spacing`` under the surface [m], and the longest path."""

    first: float
    spacing: float
    number: int
    longest_path: float


class Footprint(NamedTuple):
    """What a pixel lights and sees: a square of ``side`` at the surface [m].

    Each metre of depth adds ``growth`` [1] to its side; scattered light spreads on top of that.
    """

    side: float
    growth: float


class Tracks(NamedTuple):
    """Crossings of planes by some walks, chained plane by plane; ``filled`` counts them.

    ``head`` (planes,) and ``following`` (room,) chain the crossings; ``state`` (room, 7) holds
    x, y, path, weight / |cosine|, and the direction.
    """

    head: NDArray[np.int64]
    following: NDArray[np.int64]
    state: FloatArray
    filled: NDArray[np.int64]


@leaf_kernel
def note_crossings(
    tracks: Tracks,
    planes: Planes,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
    length: float,
    path: float,
    weight: float,
    attenuation: float,
) -> None:
    """Note every plane that a straight path crosses; z is depth here, positive down."""
    low = (min(z, z + dz * length) - planes.first) / planes.spacing
    high = (max(z, z + dz * length) - planes.first) / planes.spacing
    for k in range(max(0, math.ceil(low)), min(planes.number - 1, math.floor(high)) + 1):
        i = tracks.filled[0]
        tracks.filled[0] = i + 1
        if i >= tracks.following.shape[0]:
            continue
        along = (planes.first + k * planes.spacing - z) / dz
        tracks.following[i] = tracks.head[k]
        tracks.head[k] = i
        tracks.state[i, 0] = x + dx * along
        tracks.state[i, 1] = y + dy * along
        tracks.state[i, 2] = path + along
        tracks.state[i, 3] = weight * math.exp(-attenuation * along) / abs(dz)
        tracks.state[i, 4], tracks.state[i, 5], tracks.state[i, 6] = dx, dy, dz


@leaf_kernel
def walk_down(
    medium: Medium,
    planes: Planes,
    tracks: Tracks,
    arrivals: FloatArray,
    depths: FloatArray,
    state: NDArray[np.uint64],
) -> None:
    """Follow one walk from the surface until it leaves, is too long, or reaches the last depth.

    ``arrivals`` (depths, 4) takes x, y, path and weight where the walk first comes to each of the
    ``depths``, which grow. Light that goes up through the surface is gone.
    """
    x, y, z, dx, dy, dz = 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
    weight, path = 1.0, 0.0
    reached, levels = 0, depths.shape[0]
    depth = depths[levels - 1] if levels > 0 else math.inf
    while path < planes.longest_path:
        length = exponential(state) / medium.scattering
        wall = (depth - z) / dz if dz > 0.0 else (-z / dz if dz < 0.0 else math.inf)
        stopped = wall <= length
        length = min(length, wall)
        if planes.number > 0:
            note_crossings(
                tracks, planes, x, y, z, dx, dy, dz, length, path, weight, medium.attenuation
            )
        while reached < levels - 1 and z + dz * length >= depths[reached]:
            along = (depths[reached] - z) / dz
            at = arrivals[reached]
            at[0], at[1], at[2] = x + dx * along, y + dy * along, path + along
            at[3] = weight * math.exp(-medium.attenuation * along)
            reached += 1
        x, y, z = x + dx * length, y + dy * length, z + dz * length
        path += length
        weight *= math.exp(-medium.attenuation * length)
        if stopped:
            if dz > 0.0:
                at = arrivals[levels - 1]
                at[0], at[1], at[2], at[3] = x, y, path, weight
            return
        if weight < ROULETTE_BELOW:
            if uniform(state) >= ROULETTE_SURVIVAL:
                return
            weight /= ROULETTE_SURVIVAL
        azimuth = 2.0 * math.pi * uniform(state)
        one_minus_cos = drawn(medium.sampler, medium.sampler_share, state)
        dx, dy, dz = turned(dx, dy, dz, one_minus_cos, azimuth)


@leaf_kernel
def triangle(apart: float, side: float) -> float:
    """Share of a square's places that stay in it when shifted along one side."""
    return max(0.0, 1.0 - abs(apart) / side)


@leaf_kernel
def pair_tracks(
    column: FloatArray,
    planes: Planes,
    forward: Tracks,
    backward: Tracks,
    cosine_table: FloatArray,
    split_cosine: float,
    factor: float,
    footprint: Footprint,
    bin_width: float,
) -> None:
    """Add all meetings of two sets of walks to ``column`` (2, bins) of half the path length."""
    for k in range(planes.number):
        side = footprint.side + footprint.growth * (planes.first + k * planes.spacing)
        f = forward.head[k]
        while f >= 0:
            a = forward.state
            b = backward.head[k]
            while b >= 0:
                s = backward.state
                cosine = -(a[f, 4] * s[b, 4] + a[f, 5] * s[b, 5] + a[f, 6] * s[b, 6])
                at = int(0.5 * (a[f, 2] + s[b, 2]) / bin_width)
                if cosine < split_cosine and at < column.shape[1]:
                    density = value_at(cosine_table, max(0.0, 0.5 * (cosine + 1.0)))
                    light = factor * density * a[f, 3] * s[b, 3]
                    column[FLOOD, at] += light
                    overlap = triangle(a[f, 0] - s[b, 0], side)
                    column[ISOLATED, at] += light * overlap * triangle(a[f, 1] - s[b, 1], side)
                b = backward.following[b]
            f = forward.following[f]

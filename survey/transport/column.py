"""Light of the column: where a track of the laser's light and the walk from a pixel are joined.

Points are set along both, evenly in scatterings. Wherever the other has a leg at a point's depth
the track is shifted sideways to meet the walk, and light scatters from one into the other.

A light path can be made in several ways: split at each of its wide turns, at a point of the track
or of the walk. Each way gets a share of the path's light by the balance heuristic (Veach 1997,
section 9.2.2) for what differs among the ways: the density of the turn that is told and not drawn,
and how much depth a leg of unit length covers. A likely turn after an unlikely one, or a level leg
that hardly ever is at a certain depth, thus never makes a spike.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.transport.beam import Ray
from survey.transport.launch import Optics, fraction
from survey.transport.layers import Layers, crossed, density_at, free_path
from survey.transport.light_sent import Facet, Method, Sight, is_open, light_sent
from survey.transport.random import uniform
from survey.transport.scene import Scene
from survey.transport.sheet import crest_or_trough
from survey.transport.tally import COLUMN, Tally, deposit
from terrain.kernels import inlined_fused_kernel

MANY = 8.0
"""Scatterings of a path from which on not every pair of a point and a leg is joined."""
FLATTEST = 0.01
"""Least cosine to the vertical of a leg that is taken to cross a depth [1]."""


@inlined_fused_kernel
def join(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tally: Tally,
    sight: Sight,
    ray: Ray,
    facet: Facet,
    depth: float,
    number: int,
    along: float,
    back_number: int,
    to: float,
    at_walk: bool,
    chance: float,
) -> None:
    """Let light scatter from a leg of the track into one of the walk, which meet at a depth.

    The point is the walk's if ``at_walk``, and the track's depth is where it crosses that of the
    point; else it is the track's, and the walk crosses. On waves what crosses slides. The light
    stands for that of all pairs, of which only this ``chance`` is taken.
    """
    leg, back = tally.down[number], tally.back[back_number]
    cosine = -(leg[3] * back[3] + leg[4] * back[4] + leg[5] * back[5])
    if cosine >= method.split_cosine:
        return
    east, north = leg[0] + leg[3] * along, leg[1] + leg[4] * along
    x, y = back[0] + back[3] * to, back[1] + back[4] * to
    crossing = leg if at_walk else back
    light, in_air, deeper, _, lift = light_sent(
        scene, optics, method, sight, ray, x, y, depth, east, north,
        -crossing[3] * crossing[12], -crossing[4] * crossing[12], facet, 1.0 if at_walk else 0.0,
    )  # fmt: skip
    if light == 0.0:
        return
    if scene.wavy and at_walk:
        further = -lift * leg[12]
        along, east, north = along + further, east + leg[3] * further, north + leg[4] * further
        if not 0.0 <= along < leg[6]:
            return
    elif scene.wavy:
        further = lift * back[12]
        to, x, y = to + further, x + back[3] * further, y + back[4] * further
        if not 0.0 <= to < back[6]:
            return
    level, deepest = scene.sea.level + lift, max(leg[13], leg[2] - leg[5] * along)
    if level - deepest < scene.bounds.highest and not is_open(
        scene, tally, number + 1, along, x - east, y - north, level
    ):
        return
    if at_walk:
        along = max(0.0, along + deeper * leg[12])
    else:
        to = max(0.0, to - deeper * back[12])
    whole, absorbed = leg[7] + along + back[7] + to, leg[8] + back[8]
    absorbed += crossed(layers, layers.absorption, layers.absorbed, leg[2], -leg[5], along)
    absorbed += crossed(layers, layers.absorption, layers.absorbed, back[2], -back[5], to)
    density = density_at(layers, depth, cosine)
    turn = density / (1.0 + density * (leg[11] + back[11]))
    upright = sinking_of(leg[5]) + sinking_of(back[5])
    photons = method.photons * leg[10] * light * sight.importance * back[10] * turn
    deposit(
        tally, COLUMN, sight.batch, sight.time + in_air / speed_of_light + whole / layers.speed,
        photons * 2.0 * method.spacing / upright / chance * math.exp(-absorbed),
    )  # fmt: skip


@inlined_fused_kernel
def sinking_of(dz: float) -> float:
    """Depth that a leg covers in a metre [1]; none if it is too flat to cross a depth."""
    return abs(dz) if abs(dz) >= FLATTEST else 0.0


@inlined_fused_kernel
def light_column(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tally: Tally,
    sight: Sight,
    ray: Ray,
    facet: Facet,
    legs: int,
    start: float,
    state: NDArray[np.uint64],
) -> None:
    """Join the track, of so many legs, and the walk at points of both.

    Points of either stand two spacings apart and begin at ``start`` of that, 0 to 1; those of the
    walk stand midway between those of the track. There are as many pairs of n scatterings as n: of
    more than `MANY` a share of `MANY` / n is joined, first of the points, then of their pairs.
    """
    slack, apart = crest_or_trough(scene), 2.0 * method.spacing
    for side in range(2):
        at_walk = side == 1
        points, others = tally.down, tally.back
        count, other_count = legs, tally.noted[0]
        if at_walk:
            points, others, count, other_count = others, points, other_count, count
        sample = fraction(start + 0.5 * side) * apart
        for number in range(count):
            leg = points[number]
            ahead = crossed(layers, layers.scattering, layers.scattered, leg[2], -leg[5], leg[6])
            while sample < leg[9] + ahead:
                along = free_path(layers, leg[2], -leg[5], sample - leg[9])
                sample += apart
                taken = min(1.0, MANY / (number + 1.0))
                if taken < 1.0 and uniform(state) >= taken:
                    continue
                depth = leg[2] - leg[5] * along
                for other in range(other_count):
                    crossing = others[other]
                    to = (crossing[2] - depth) * crossing[12]
                    beyond = slack * abs(crossing[12])
                    if abs(crossing[5]) < FLATTEST or not -beyond <= to < crossing[6] + beyond:
                        continue
                    chance = min(1.0, MANY / (number + other + 1.0))
                    if chance < 1.0 and uniform(state) * taken >= chance:
                        continue
                    join(
                        scene, layers, optics, method, tally, sight, ray, facet, depth,
                        other if at_walk else number, to if at_walk else along,
                        number if at_walk else other, along if at_walk else to, at_walk,
                        chance,
                    )  # fmt: skip

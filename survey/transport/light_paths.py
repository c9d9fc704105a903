"""One light path after the other: seen from a pixel, lit by the laser.

A walk runs back from the pixel, through its aperture and the sea surface. Wherever it touches the
bottom, and at some depths of the column on its way, light of the laser is brought there: a track
of open water is turned into the direction of the laser's ray and laid so that it leads to the very
place. The track begins somewhere on the sea surface; if that is lit, the two make a light path.

Light of the bottom is split at its first touch, so the track is light that has touched nothing.
Light of the column is split at any of its scatterings by more than the split angle (`column`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.interface import fresnel_reflectance, reflected
from survey.transport.aim import aimed
from survey.transport.beam import Ray, ray_to
from survey.transport.column import FLATTEST, light_column
from survey.transport.launch import Optics
from survey.transport.layers import Layers, crossed, free_path, wide_turn
from survey.transport.light_sent import GAP, Facet, Method, Sight, is_open, light_sent, longest_path
from survey.transport.random import uniform
from survey.transport.scene import Scene
from survey.transport.surface import (
    drawn_normal,
    enter_water,
    facing_from_below,
    passing,
    tilted,
)
from survey.transport.tally import BOTTOM, Tally, deposit, note_leg
from survey.transport.tracks import (
    Course,
    Frame,
    Tracks,
    direction_along,
    frame_around,
    frame_straying,
    frame_uphill,
    mirrored,
)
from terrain.kernels import inlined_fused_kernel

CHANCE_BEYOND = 0.25
ROULETTE_BELOW, ROULETTE_SURVIVAL = 1e-4, 0.1


class Place(NamedTuple):
    """Where a walk touches the bottom: ``gain`` is its importance times reflectance over pi.

    ``absorbed`` is the optical depth of absorption on its ``path`` [m].
    """

    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float
    path: float
    absorbed: float
    gain: float


@inlined_fused_kernel
def add_bottom(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tally: Tally,
    sight: Sight,
    place: Place,
    ray: Ray,
    legs: int,
    along: float,
    path: float,
    absorbed: float,
    strength: float,
    facet: Facet,
) -> None:
    """Light a place of the bottom by the track whose last leg crosses its depth at ``along``.

    Its depth under mean level; under a wave the leg crosses it elsewhere, or not at all.
    """
    leg = tally.down[legs - 1]
    dx, dy, dz = leg[3], leg[4], leg[5]
    facing = -(dx * place.nx + dy * place.ny + dz * place.nz)
    if facing <= 0.0 or abs(dz) < FLATTEST:
        return
    east, north = leg[0] + dx * along, leg[1] + dy * along
    light, in_air, deeper, straight, lift = light_sent(
        scene, optics, method, sight, ray, place.x, place.y, scene.sea.level - place.z,
        east, north, dx / -dz, dy / -dz, facet, 1.0,
    )  # fmt: skip
    if light == 0.0:
        return
    if scene.wavy:
        further = lift / -dz
        along, east, north = along + further, east + dx * further, north + dy * further
        if not 0.0 <= along < leg[6]:
            return
    if not is_open(
        scene, tally, legs, along, place.x - east, place.y - north, scene.sea.level + lift
    ):
        return
    absorbed += crossed(layers, layers.absorption, layers.absorbed, leg[2], -dz, along)
    straightened = max(path + along + deeper / dz, straight)
    absorbed *= straightened / max(path + along, GAP)
    whole = straightened + place.path
    photons = method.photons * strength * light * facing / abs(dz) * place.gain
    deposit(
        tally, BOTTOM, sight.batch, sight.time + in_air / speed_of_light + whole / layers.speed,
        photons * math.exp(-absorbed - place.absorbed),
    )  # fmt: skip


@inlined_fused_kernel
def send_light(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tracks: Tracks,
    tally: Tally,
    sight: Sight,
    place: Place,
    way: Course,
    turn: float,
    weight: float,
    with_column: bool,
    state: NDArray[np.uint64],
) -> None:
    """Send a track down from the surface, and light the place of the bottom and the column.

    Where it has to be aimed, it is laid to stray to the azimuth ``turn``, unless another is more
    likely to bring light. A place with gain 0 counts as no bottom: light is sent towards it for the
    column alone.
    """
    sea = scene.sea
    target = sea.level - place.z
    ray = ray_to(optics, sea.level, layers.refractive_index, place.x, place.y, target)
    dx, dy = ray.x - optics.position[0], ray.y - optics.position[1]
    dz = sea.level - optics.position[2]
    norm = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
    facet = Facet(0.0, 0.0, 1.0)
    at_will = scene.wavy or (sight.rim and place.gain > 0.0)
    if at_will:
        turn, facet, odds = aimed(
            scene, layers, optics, method, tracks, sight, ray, target, -dz * norm, way, turn,
            state,
        )  # fmt: skip
        weight *= odds
        mx, my, mz = tilted(0.0, 0.0, 1.0, facet.slope_x, facet.slope_y)
    else:
        mx, my, mz = drawn_normal(sea, method.quantiles, state)
    dx, dy, dz, caught, reflectance = enter_water(
        layers.refractive_index, dx * norm, dy * norm, dz * norm, mx, my, mz
    )
    if caught <= 0.0 or dz >= 0.0:
        return
    if at_will:
        which = 2 * sight.batch
        frame = frame_straying(tracks, which, way.track, dx, dy, dz, method.circle, turn)
    else:
        frame = frame_uphill(dx, dy, dz)
    strength = weight * caught * (1.0 - reflectance) * passing(sea)
    start = uniform(state)
    legs = follow(
        scene, layers, optics, method, tracks, tally, sight, place, ray, facet, way, frame,
        strength, dx, dy, dz, state,
    )  # fmt: skip
    if with_column:
        light_column(scene, layers, optics, method, tally, sight, ray, facet, legs, start, state)


@inlined_fused_kernel
def follow(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tracks: Tracks,
    tally: Tally,
    sight: Sight,
    place: Place,
    ray: Ray,
    facet: Facet,
    way: Course,
    frame: Frame,
    strength: float,
    dx: float,
    dy: float,
    dz: float,
    state: NDArray[np.uint64],
) -> int:
    """Follow a track that enters the water along d, light the place and note the track's legs.

    Returns how many there are. Beyond the place a track goes on for the column and for overhangs.
    """
    sea = scene.sea
    target = sea.level - place.z
    which, k, turning, legs = 2 * sight.batch, 0, False, 0
    x = y = depth = path = absorbed = scattered = deepest = turns = 0.0
    limit = longest_path(scene, layers, optics, sight)
    floor = scene.waves.highest - scene.bounds.lowest
    over, under = scene.waves.highest - sea.level, sea.level - scene.waves.lowest
    beyond = place.gain == 0.0
    track, optical = way.track, way.optical
    while True:
        ox, oy, oz = dx, dy, dz
        row = tracks.legs[which, track, k]
        dx, dy, dz = direction_along(layers, row, turning, depth, frame, dx, dy, dz)
        turns += wide_turn(layers, depth, dx * ox + dy * oy + dz * oz, method.split_cosine)
        length = min(free_path(layers, depth, -dz, optical), limit - path)
        surfaced = dz > 0.0 and depth < dz * length
        if surfaced:
            length = depth / dz
        if legs == tally.down.shape[0]:
            return legs
        note_leg(
            tally.down[legs], x, y, depth, dx, dy, dz, length, path, absorbed, scattered, strength,
            turns, deepest,
        )  # fmt: skip
        legs += 1
        sinking = -dz * length
        ahead = crossed(layers, layers.scattering, layers.scattered, depth, -dz, length)
        at_place = (depth < target) != (depth + sinking < target)
        if scene.wavy:
            shallow, deep = min(depth, depth + sinking), max(depth, depth + sinking)
            at_place = shallow < target + over and deep > target - under
        if place.gain > 0.0 and at_place:
            add_bottom(
                scene, layers, optics, method, tally, sight, place, ray, legs,
                (target - depth) / -dz, path, absorbed, strength, facet,
            )  # fmt: skip
            if target > floor - GAP:
                return legs
            if not beyond and depth + sinking >= target + over:
                beyond = True
                if uniform(state) >= CHANCE_BEYOND:
                    return legs
                strength /= CHANCE_BEYOND
        path, scattered = path + length, scattered + ahead
        absorbed += crossed(layers, layers.absorption, layers.absorbed, depth, -dz, length)
        x, y, depth = x + dx * length, y + dy * length, depth + sinking
        deepest = max(deepest, depth)
        if path >= limit or depth > floor:
            return legs
        if surfaced:
            depth = 0.0
            mx, my, mz = drawn_normal(sea, method.quantiles, state)
            mx, my, mz = facing_from_below(dx, dy, dz, mx, my, mz, 0.0, 0.0)
            cosine = dx * mx + dy * my + dz * mz
            if uniform(state) >= fresnel_reflectance(cosine, layers.refractive_index):
                return legs
            dx, dy, dz = reflected(dx, dy, dz, mx, my, mz)
            frame, turning = mirrored(frame, mx, my, mz), False
            optical -= ahead
            continue
        k += 1
        tally.noted[1] += 1
        if k == tracks.legs.shape[2]:
            if strength * math.exp(-absorbed) < ROULETTE_BELOW:
                if uniform(state) >= ROULETTE_SURVIVAL:
                    return legs
                strength /= ROULETTE_SURVIVAL
            frame = frame_around(dx, dy, dz, method.circle, uniform(state))
            track, k = int(uniform(state) * tracks.legs.shape[1]), 1
        turning, optical = True, tracks.legs[which, track, k, 3]

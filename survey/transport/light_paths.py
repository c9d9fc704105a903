"""One light path after the other: seen from a pixel, lit by the laser.

A walk runs back from the pixel, through its aperture and the sea surface. Wherever it touches the
bottom, and at some depths of the column on its way, light of the laser is brought there: a track
of open water is turned into the direction of the laser's ray and laid so that it leads to the very
place. The track begins somewhere on the sea surface; if that is lit, the two make a light path.

Light of the bottom is split at its first touch, so the track is light that has touched nothing.
Light of the column is split at its last scattering by more than the split angle.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.interface import fresnel_reflectance, reflected
from survey.transport.beam import Ray, light_on_water, ray_to
from survey.transport.launch import Optics
from survey.transport.random import uniform
from survey.transport.scene import Medium, Scene
from survey.transport.surface import drawn_normal, enter_water, facing_from_below
from survey.transport.tally import BOTTOM, COLUMN, Tally, deposit
from survey.transport.tracks import Course, Tracks, axes_around
from terrain.kernels import inlined_kernel
from terrain.raycast import first_hit

FLATTEST = 0.01
GAP = 1e-3
CHANCE_BEYOND = 0.25
ROULETTE_BELOW, ROULETTE_SURVIVAL = 1e-4, 0.1


class Method(NamedTuple):
    """How light paths are made: see `TransportSettings`; ``photons`` launched in a pulse."""

    split_cosine: float
    spacing: float
    isolated: bool
    photons: float
    cosine_table: NDArray[np.float64]
    quantiles: NDArray[np.float64]
    circle: NDArray[np.float64]


class Sight(NamedTuple):
    """A walk from a pixel as it enters the water.

    ``importance`` is its share of the pixel's etendue behind the surface [m2 sr].
    """

    pixel: int
    batch: int
    time: float
    importance: float


class Place(NamedTuple):
    """Where a walk touches the bottom: ``gain`` is its importance times reflectance over pi."""

    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float
    path: float
    gain: float


@inlined_kernel
def light_sent(
    scene: Scene,
    optics: Optics,
    method: Method,
    sight: Sight,
    ray: Ray,
    x: float,
    y: float,
    depth: float,
    east: float,
    north: float,
    slope_x: float,
    slope_y: float,
) -> tuple[float, float, float]:
    """Return what the laser sends along a track to a place [1/m2], the way in air, how much deeper.

    The track goes (``east``, ``north``) sideways to the place's ``depth``. Where it enters is where
    the flat surface's ray does, but for what it strays from that ray; neighbours part with depth,
    and what strays does less so at the surface. The ray that enters there leans the other way: it
    tilts the track, which is then somewhat deeper [m] and, on what goes through the place by
    (``slope_x``, ``slope_y``) per metre of depth, thinned further. Departure: to first order, and
    as if neighbours parted alike in all directions.
    """
    spread_r, spread_t = 1.0 + depth * ray.radial, 1.0 + depth * ray.tangential
    thinned = 1.0 / (spread_r * spread_t)
    shrink = math.sqrt(thinned)
    flat_x, flat_y = depth * ray.slope_x, depth * ray.slope_y
    stray_x, stray_y = east - flat_x, north - flat_y
    px, py = x - flat_x - stray_x * shrink, y - flat_y - stray_y * shrink
    lean = 0.5 * (ray.radial + ray.tangential) * shrink
    thinned *= min(2.0, max(0.0, 1.0 - lean * (stray_x * slope_x + stray_y * slope_y)))
    level = scene.sea.level
    light = light_on_water(optics, level, px, py, sight.pixel, method.isolated)
    if light == 0.0:
        return 0.0, 0.0, 0.0
    dx, dy, dz = px - optics.position[0], py - optics.position[1], level - optics.position[2]
    in_air = math.sqrt(dx * dx + dy * dy + dz * dz)
    if scene.bounds.highest > level:
        _, face = first_hit(
            scene.grid, optics.position[0], optics.position[1], optics.position[2],
            dx / in_air, dy / in_air, dz / in_air, in_air,
        )  # fmt: skip
        if face >= 0:
            return 0.0, 0.0, 0.0
    return light * thinned, in_air, lean * (stray_x * stray_x + stray_y * stray_y)


@inlined_kernel
def is_open(scene: Scene, tally: Tally, legs: int, last: float, x: float, y: float) -> bool:
    """Tell whether a track, begun at (x, y), meets no bottom on its legs.

    Of the last leg only the length ``last`` counts, but for a last millimetre.
    """
    for i in range(legs):
        leg = tally.down[i]
        length = leg[6] if i < legs - 1 else last - GAP
        if length <= 0.0:
            continue
        z = scene.sea.level - leg[2]
        if min(z, z + leg[5] * length) > scene.bounds.highest:
            continue
        _, face = first_hit(scene.grid, x + leg[0], y + leg[1], z, leg[3], leg[4], leg[5], length)
        if face >= 0:
            return False
    return True


@inlined_kernel
def add_bottom(
    scene: Scene,
    medium: Medium,
    optics: Optics,
    method: Method,
    tally: Tally,
    sight: Sight,
    place: Place,
    ray: Ray,
    legs: int,
    along: float,
    path: float,
    strength: float,
) -> None:
    """Light a place of the bottom by the track whose last leg crosses its depth at ``along``."""
    leg = tally.down[legs - 1]
    dx, dy, dz = leg[3], leg[4], leg[5]
    facing = -(dx * place.nx + dy * place.ny + dz * place.nz)
    if facing <= 0.0 or abs(dz) < FLATTEST:
        return
    east, north = leg[0] + dx * along, leg[1] + dy * along
    light, in_air, deeper = light_sent(
        scene, optics, method, sight, ray, place.x, place.y, scene.sea.level - place.z,
        east, north, dx / -dz, dy / -dz,
    )  # fmt: skip
    if light == 0.0:
        return
    if not is_open(scene, tally, legs, along, place.x - east, place.y - north):
        return
    path += along - min(deeper / -dz, along)
    whole = path + place.path
    photons = method.photons * strength * light * facing / abs(dz) * place.gain
    deposit(
        tally, BOTTOM, sight.batch, sight.time + in_air / speed_of_light + whole / medium.speed,
        photons * math.exp(-medium.attenuation * whole),
    )  # fmt: skip


@inlined_kernel
def add_column(
    scene: Scene,
    medium: Medium,
    optics: Optics,
    method: Method,
    tally: Tally,
    sight: Sight,
    ray: Ray,
    legs: int,
    along: float,
    path: float,
    strength: float,
    deepest: float,
) -> None:
    """Let a point of a track scatter into the walk from the pixel, where that has its depth."""
    leg = tally.down[legs - 1]
    dx, dy, dz = leg[3], leg[4], leg[5]
    depth = leg[2] - dz * along
    east, north = leg[0] + dx * along, leg[1] + dy * along
    z = scene.sea.level - depth
    table = method.cosine_table
    for i in range(tally.noted[0]):
        back = tally.back[i]
        to = (z - back[2]) * back[8]
        if not 0.0 <= to < back[6]:
            continue
        cosine = -(dx * back[3] + dy * back[4] + dz * back[5])
        if cosine >= method.split_cosine:
            continue
        x, y = back[0] + back[3] * to, back[1] + back[4] * to
        light, in_air, deeper = light_sent(
            scene, optics, method, sight, ray, x, y, depth, east, north,
            -back[3] * back[8], -back[4] * back[8],
        )  # fmt: skip
        if light == 0.0:
            continue
        if scene.sea.level - deepest < scene.bounds.highest and not is_open(
            scene, tally, legs, along, x - east, y - north
        ):
            continue
        at = max(0.0, 0.5 * (cosine + 1.0) * (table.shape[0] - 1))
        entry = min(int(at), table.shape[0] - 2)
        density = table[entry] + (at - entry) * (table[entry + 1] - table[entry])
        whole = path + along + back[7] + to - deeper * back[8]
        photons = method.photons * strength * light * sight.importance * abs(back[8])
        photons *= medium.scattering * method.spacing * density
        deposit(
            tally, COLUMN, sight.batch,
            sight.time + in_air / speed_of_light + whole / medium.speed,
            photons * math.exp(-medium.attenuation * whole),
        )  # fmt: skip


@inlined_kernel
def send_light(
    scene: Scene,
    medium: Medium,
    optics: Optics,
    method: Method,
    tracks: Tracks,
    tally: Tally,
    sight: Sight,
    place: Place,
    way: Course,
    weight: float,
    with_column: bool,
    state: NDArray[np.uint64],
) -> None:
    """Follow a track down from the surface and light the place of the bottom and the column.

    A place with gain 0 is no bottom: light is then sent towards it for the column alone.
    """
    sea = scene.sea
    target = sea.level - place.z
    ray = ray_to(optics, sea.level, medium.refractive_index, place.x, place.y, target)
    dx, dy = ray.x - optics.position[0], ray.y - optics.position[1]
    dz = sea.level - optics.position[2]
    norm = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
    mx, my, mz = drawn_normal(sea, method.quantiles, state)
    dx, dy, dz, caught, reflectance = enter_water(
        medium.refractive_index, dx * norm, dy * norm, dz * norm, mx, my, mz
    )
    if caught <= 0.0 or dz >= 0.0:
        return
    strength = weight * caught * (1.0 - reflectance)
    ax, ay, az, bx, by, bz = axes_around(dx, dy, dz, method.circle, state)
    cx, cy, cz = dx, dy, dz
    which, k, legs = 2 * sight.batch, 0, 0
    x = y = depth = path = deepest = 0.0
    height = optics.position[2] - sea.level
    limit = (scene.bounds.latest - sight.time - height / speed_of_light) * medium.speed
    floor = sea.level - scene.bounds.lowest
    sample = method.spacing * uniform(state)
    beyond = place.gain == 0.0
    track, optical = way.track, way.optical
    while True:
        row = tracks.legs[which, track, k]
        dx = row[0] * ax + row[1] * bx + row[2] * cx
        dy = row[0] * ay + row[1] * by + row[2] * cy
        dz = row[0] * az + row[1] * bz + row[2] * cz
        length = min(optical / medium.scattering, limit - path)
        surfaced = dz > 0.0 and depth < dz * length
        if surfaced:
            length = depth / dz
        if legs == tally.down.shape[0]:
            return
        leg = tally.down[legs]
        leg[0], leg[1], leg[2], leg[3], leg[4], leg[5], leg[6] = x, y, depth, dx, dy, dz, length
        legs += 1
        sinking = -dz * length
        if with_column:
            while sample < path + length:
                along = sample - path
                add_column(
                    scene, medium, optics, method, tally, sight, ray, legs, along, path, strength,
                    max(deepest, depth - dz * along),
                )  # fmt: skip
                sample += method.spacing
        if place.gain > 0.0 and (depth < target) != (depth + sinking < target):
            add_bottom(
                scene, medium, optics, method, tally, sight, place, ray, legs,
                (target - depth) / -dz, path, strength,
            )  # fmt: skip
            if target > floor - GAP:
                return
            if not beyond:
                beyond = True
                if uniform(state) >= CHANCE_BEYOND:
                    return
                strength /= CHANCE_BEYOND
        path += length
        x, y, depth = x + dx * length, y + dy * length, depth + sinking
        deepest = max(deepest, depth)
        if path >= limit or depth > floor:
            return
        if surfaced:
            depth = 0.0
            mx, my, mz = drawn_normal(sea, method.quantiles, state)
            mx, my, mz = facing_from_below(dx, dy, dz, mx, my, mz)
            cosine = dx * mx + dy * my + dz * mz
            if uniform(state) >= fresnel_reflectance(cosine, medium.refractive_index):
                return
            ax, ay, az = reflected(ax, ay, az, mx, my, mz)
            bx, by, bz = reflected(bx, by, bz, mx, my, mz)
            cx, cy, cz = reflected(cx, cy, cz, mx, my, mz)
            optical -= length * medium.scattering
            continue
        k += 1
        tally.noted[1] += 1
        if k == tracks.legs.shape[2]:
            if strength * math.exp(-medium.attenuation * path) < ROULETTE_BELOW:
                if uniform(state) >= ROULETTE_SURVIVAL:
                    return
                strength /= ROULETTE_SURVIVAL
            ax, ay, az, bx, by, bz = axes_around(dx, dy, dz, method.circle, state)
            cx, cy, cz = dx, dy, dz
            track, k = int(uniform(state) * tracks.legs.shape[1]), 1
        optical = tracks.legs[which, track, k, 3]

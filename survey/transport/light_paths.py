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
from survey.transport.layers import Layers, crossed, density_at, free_path
from survey.transport.random import uniform
from survey.transport.scene import FOLLOWED, Scene
from survey.transport.sheet import crest_or_trough, through_waves
from survey.transport.surface import (
    drawn_normal,
    enter_water,
    facing_from_below,
    passing,
    slope_density,
    tilted,
)
from survey.transport.tally import BOTTOM, COLUMN, Tally, deposit
from survey.transport.tracks import (
    Course,
    Tracks,
    direction_along,
    frame_around,
    mirrored,
)
from terrain.kernels import inlined_kernel
from terrain.raycast import first_hit
from terrain.waves.lattice import elevation_and_slopes

FLATTEST = 0.01
GAP = 1e-3
CHANCE_BEYOND = 0.25
ROULETTE_BELOW, ROULETTE_SURVIVAL = 1e-4, 0.1


class Method(NamedTuple):
    """How light paths are made: see `TransportSettings`.

    ``spacing`` of the points that light the column in scatterings [1], ``photons`` launched in a
    pulse.
    """

    split_cosine: float
    spacing: float
    isolated: bool
    photons: float
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


class Facet(NamedTuple):
    """Where on waves a track is laid through: its slopes, and the ``density`` it was drawn by."""

    slope_x: float
    slope_y: float
    density: float


class Sent(NamedTuple):
    """What the laser sends along a track to a place: ``light`` [1/m2] and lengths [m].

    ``in_air``, how much ``deeper`` the track goes for its tilt, the ``straight`` way in the water,
    and the ``lift`` of the wave above mean level where the track enters.
    """

    light: float
    in_air: float
    deeper: float
    straight: float
    lift: float


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
    facet: Facet,
    deepening: float,
) -> Sent:
    """Return what the laser sends along a track to a place.

    The track goes (``east``, ``north``) sideways to the place's ``depth``. Laid to the place it
    would begin somewhat ``aside`` of where the ray enters whose direction it has. The ray that
    enters there leans the other way, the more so the shallower neighbours part: it tilts the track,
    which then begins nearer, goes somewhat deeper and, on what passes through the place by
    (``slope_x``, ``slope_y``) per metre of depth, is thinned further. Departure: to first order, as
    if neighbours parted alike in all directions, and no more than doubled.

    Where a wave stands at the entry the track slides there along what goes through the place: the
    light slides over a fixed place, which then is deeper under the wave (``deepening`` 1), or a
    place of fixed depth over its light (0).
    """
    spread_r, spread_t = 1.0 + depth * ray.radial, 1.0 + depth * ray.tangential
    thinned = 1.0 / (spread_r * spread_t)
    shrink = math.sqrt(thinned)
    aside_x, aside_y = x - east - ray.x, y - north - ray.y
    px, py = ray.x + aside_x * shrink, ray.y + aside_y * shrink
    lean = 0.5 * (ray.radial + ray.tangential) * shrink
    stray_x, stray_y = east - depth * ray.slope_x, north - depth * ray.slope_y
    thinned *= min(2.0, max(0.0, 1.0 - lean * (stray_x * slope_x + stray_y * slope_y)))
    level, lift = scene.sea.level, 0.0
    if scene.wavy:
        lift, density = through_waves(scene, px, py, slope_x, slope_y, facet.slope_x, facet.slope_y)
        px, py, level = px - lift * slope_x, py - lift * slope_y, level + lift
        deeper_by = deepening * lift
        thinned *= density / facet.density * spread_r * spread_t
        thinned /= (spread_r + deeper_by * ray.radial) * (spread_t + deeper_by * ray.tangential)
    light = light_on_water(optics, level, px, py, sight.pixel, method.isolated)
    if light == 0.0:
        return Sent(0.0, 0.0, 0.0, 0.0, lift)
    dx, dy, dz = px - optics.position[0], py - optics.position[1], level - optics.position[2]
    in_air = math.sqrt(dx * dx + dy * dy + dz * dz)
    if scene.bounds.highest > scene.waves.lowest:
        _, face = first_hit(
            scene.grid, optics.position[0], optics.position[1], optics.position[2],
            dx / in_air, dy / in_air, dz / in_air, in_air,
        )  # fmt: skip
        if face >= 0:
            return Sent(0.0, 0.0, 0.0, 0.0, lift)
    deeper = -lean * (aside_x * stray_x + aside_y * stray_y)
    down = depth + deepening * lift
    straight = math.sqrt((x - px) ** 2 + (y - py) ** 2 + down * down)
    return Sent(light * thinned, in_air, deeper, straight, lift)


@inlined_kernel
def is_open(
    scene: Scene, tally: Tally, legs: int, last: float, x: float, y: float, level: float
) -> bool:
    """Tell whether a track, begun at (x, y, level), meets no bottom on its legs.

    Of the last leg only the length ``last`` counts, but for a last millimetre.
    """
    for i in range(legs):
        leg = tally.down[i]
        length = leg[6] if i < legs - 1 else last - GAP
        if length <= 0.0:
            continue
        z = level - leg[2]
        if min(z, z + leg[5] * length) > scene.bounds.highest:
            continue
        _, face = first_hit(scene.grid, x + leg[0], y + leg[1], z, leg[3], leg[4], leg[5], length)
        if face >= 0:
            return False
    return True


@inlined_kernel
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


@inlined_kernel
def add_column(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tally: Tally,
    sight: Sight,
    ray: Ray,
    legs: int,
    along: float,
    path: float,
    absorbed: float,
    strength: float,
    deepest: float,
    facet: Facet,
) -> None:
    """Let a point of a track scatter into the walk from the pixel, where that has its depth."""
    leg = tally.down[legs - 1]
    dx, dy, dz = leg[3], leg[4], leg[5]
    depth = leg[2] - dz * along
    east, north = leg[0] + dx * along, leg[1] + dy * along
    z = scene.sea.level - depth
    slack = crest_or_trough(scene)
    absorbed += crossed(layers, layers.absorption, layers.absorbed, leg[2], -dz, along)
    for i in range(tally.noted[0]):
        back = tally.back[i]
        to = (z - back[2]) * back[8]
        if not -slack * abs(back[8]) <= to < back[6] + slack * abs(back[8]):
            continue
        cosine = -(dx * back[3] + dy * back[4] + dz * back[5])
        if cosine >= method.split_cosine:
            continue
        x, y = back[0] + back[3] * to, back[1] + back[4] * to
        light, in_air, deeper, _, lift = light_sent(
            scene, optics, method, sight, ray, x, y, depth, east, north,
            -back[3] * back[8], -back[4] * back[8], facet, 0.0,
        )  # fmt: skip
        if light == 0.0:
            continue
        if scene.wavy:
            further = lift * back[8]
            to, x, y = to + further, x + back[3] * further, y + back[4] * further
            if not 0.0 <= to < back[6]:
                continue
        level = scene.sea.level + lift
        if level - deepest < scene.bounds.highest and not is_open(
            scene, tally, legs, along, x - east, y - north, level
        ):
            continue
        to = max(0.0, to - deeper * back[8])
        whole = path + along + back[7] + to
        kept = absorbed + back[9]
        kept += crossed(
            layers, layers.absorption, layers.absorbed, scene.sea.level - back[2], -back[5], to
        )
        photons = method.photons * strength * light * sight.importance * abs(back[8])
        photons *= method.spacing * density_at(layers, depth, cosine)
        deposit(
            tally, COLUMN, sight.batch,
            sight.time + in_air / speed_of_light + whole / layers.speed,
            photons * math.exp(-kept),
        )  # fmt: skip


@inlined_kernel
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
    weight: float,
    with_column: bool,
    state: NDArray[np.uint64],
) -> None:
    """Follow a track down from the surface and light the place of the bottom and the column.

    A place with gain 0 is no bottom: light is then sent towards it for the column alone.
    """
    sea = scene.sea
    target = sea.level - place.z
    ray = ray_to(optics, sea.level, layers.refractive_index, place.x, place.y, target)
    dx, dy = ray.x - optics.position[0], ray.y - optics.position[1]
    dz = sea.level - optics.position[2]
    norm = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
    mx, my, mz = drawn_normal(scene.drawn, method.quantiles, state)
    facet = Facet(0.0, 0.0, 1.0)
    if scene.wavy:
        _, wave_x, wave_y = elevation_and_slopes(scene.waves, ray.x, ray.y)
        density = slope_density(scene.drawn, -mx / mz, -my / mz)
        mx, my, mz = tilted(mx, my, mz, FOLLOWED * wave_x, FOLLOWED * wave_y)
        facet = Facet(-mx / mz, -my / mz, density)
    dx, dy, dz, caught, reflectance = enter_water(
        layers.refractive_index, dx * norm, dy * norm, dz * norm, mx, my, mz
    )
    if caught <= 0.0 or dz >= 0.0:
        return
    strength = weight * caught * (1.0 - reflectance) * passing(sea)
    frame = frame_around(dx, dy, dz, method.circle, state)
    which, k, turning, legs = 2 * sight.batch, 0, False, 0
    x = y = depth = path = absorbed = scattered = deepest = 0.0
    height = optics.position[2] - scene.waves.highest
    limit = (scene.bounds.latest - sight.time - height / speed_of_light) * layers.speed
    floor = scene.waves.highest - scene.bounds.lowest
    over, under = scene.waves.highest - sea.level, sea.level - scene.waves.lowest
    sample = method.spacing * uniform(state)
    beyond = place.gain == 0.0
    track, optical = way.track, way.optical
    while True:
        row = tracks.legs[which, track, k]
        dx, dy, dz = direction_along(layers, row, turning, depth, frame, dx, dy, dz)
        length = min(free_path(layers, depth, -dz, optical), limit - path)
        surfaced = dz > 0.0 and depth < dz * length
        if surfaced:
            length = depth / dz
        if legs == tally.down.shape[0]:
            return
        leg = tally.down[legs]
        leg[0], leg[1], leg[2], leg[3], leg[4], leg[5], leg[6] = x, y, depth, dx, dy, dz, length
        legs += 1
        sinking = -dz * length
        ahead = crossed(layers, layers.scattering, layers.scattered, depth, -dz, length)
        if with_column:
            while sample < scattered + ahead:
                along = free_path(layers, depth, -dz, sample - scattered)
                add_column(
                    scene, layers, optics, method, tally, sight, ray, legs, along, path, absorbed,
                    strength, max(deepest, depth - dz * along), facet,
                )  # fmt: skip
                sample += method.spacing
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
                return
            if not beyond and depth + sinking >= target + over:
                beyond = True
                if uniform(state) >= CHANCE_BEYOND:
                    return
                strength /= CHANCE_BEYOND
        path, scattered = path + length, scattered + ahead
        absorbed += crossed(layers, layers.absorption, layers.absorbed, depth, -dz, length)
        x, y, depth = x + dx * length, y + dy * length, depth + sinking
        deepest = max(deepest, depth)
        if path >= limit or depth > floor:
            return
        if surfaced:
            depth = 0.0
            mx, my, mz = drawn_normal(scene.drawn, method.quantiles, state)
            mx, my, mz = facing_from_below(dx, dy, dz, mx, my, mz, 0.0, 0.0)
            cosine = dx * mx + dy * my + dz * mz
            if uniform(state) >= fresnel_reflectance(cosine, layers.refractive_index):
                return
            dx, dy, dz = reflected(dx, dy, dz, mx, my, mz)
            frame, turning = mirrored(frame, mx, my, mz), False
            optical -= ahead
            continue
        k += 1
        tally.noted[1] += 1
        if k == tracks.legs.shape[2]:
            if strength * math.exp(-absorbed) < ROULETTE_BELOW:
                if uniform(state) >= ROULETTE_SURVIVAL:
                    return
                strength /= ROULETTE_SURVIVAL
            frame = frame_around(dx, dy, dz, method.circle, state)
            track, k = int(uniform(state) * tracks.legs.shape[1]), 1
        turning, optical = True, tracks.legs[which, track, k, 3]

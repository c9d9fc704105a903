"""Pixel by pixel: walks back through the sea, lit by the laser, and their sum as a waveform."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.interface import fresnel_reflectance, reflected
from survey.transport.beam import light_on_water
from survey.transport.directions import lambert_direction
from survey.transport.launch import Optics, direction_of, tangents_at
from survey.transport.layers import Layers, crossed, free_path, wide_turn
from survey.transport.light_paths import (
    ROULETTE_BELOW,
    ROULETTE_SURVIVAL,
    Place,
    send_light,
)
from survey.transport.light_sent import Method, Sight, longest_path
from survey.transport.random import PIXELS, start_stream, uniform
from survey.transport.scene import Scene
from survey.transport.sheet import BELOW, first_water, sea_under, water_above
from survey.transport.spread import Evenly, Shifts, shared_out, spread_evenly
from survey.transport.surface import (
    drawn_normal,
    enter_water,
    facing_from_below,
    passing,
    tilted,
)
from survey.transport.tally import BOTTOM, Tally, add_up, clear, deposit, note_leg, tell_variance
from survey.transport.tracks import (
    Course,
    Frame,
    Tracks,
    chosen,
    course,
    direction_along,
    frame_around,
    frame_uphill,
    mirrored,
    part_early,
    tilt_of,
)
from terrain.kernels import fused_kernel, inlined_fused_kernel, leaf_kernel
from terrain.raycast import first_hit

BOUNCE_CHANCE = 0.25
LIFT = 1e-7

LAUNCHED, FACETS, REFLECTED, ABSORBED, ESCAPED, ASIDE, LATE, SEABED, ROULETTE = range(9)
LEDGER_NAMES = (
    "launched",
    "facet weighting",
    "reflected at the surface",
    "absorbed by water",
    "escaped through the surface",
    "left sideways",
    "later than the gate",
    "absorbed by the bottom",
    "roulette",
)


class Touch(NamedTuple):
    """Where a walk met the bottom; ``face`` is -1 when it did not.

    ``absorbed`` is the optical depth of absorption on its ``path`` [m]; ``weight`` is without it,
    and ``kept`` is what it leaves of that.
    """

    face: int
    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float
    path: float
    absorbed: float
    weight: float
    kept: float


class Address(NamedTuple):
    """Which random numbers a flash draws."""

    seed: int
    frame: int


@leaf_kernel
def facing_normal(
    scene: Scene, face: int, dx: float, dy: float, dz: float
) -> tuple[float, float, float]:
    """Unit normal of a face on the side that a ray comes from."""
    normals = scene.grid.normals
    nx, ny, nz = normals[face, 0], normals[face, 1], normals[face, 2]
    if nx * dx + ny * dy + nz * dz > 0.0:
        return -nx, -ny, -nz
    return nx, ny, nz


@inlined_fused_kernel
def walk_back(
    scene: Scene,
    layers: Layers,
    method: Method,
    tracks: Tracks,
    tally: Tally,
    which: int,
    way: Course,
    frame: Frame,
    start: Touch,
    limit: float,
    noting: bool,
    state: NDArray[np.uint64],
) -> Touch:
    """Follow a walk along tracks until it touches the bottom, escapes, leaves or is too late.

    The weight does not hold the absorption, which is told beside. Legs are noted if ``noting``.
    The first track is laid by the axes of ``frame``.
    """
    ledger, sea = tally.ledger, scene.sea
    _, x, y, z, dx, dy, dz, path, absorbed, weight, unabsorbed = start
    k, turning, fate, entered = 0, False, LATE, weight
    turns = scattered = 0.0
    track, optical = way.track, way.optical
    while True:
        depth, ox, oy, oz = sea.level - z, dx, dy, dz
        row = tracks.legs[which, track, k]
        dx, dy, dz = direction_along(layers, row, turning, depth, frame, dx, dy, dz)
        turns += wide_turn(layers, depth, dx * ox + dy * oy + dz * oz, method.split_cosine)
        length = min(free_path(layers, depth, -dz, optical), limit - path)
        to_air, slope_x, slope_y = water_above(scene, x, y, z, dx, dy, dz, length)
        surfaced = to_air < math.inf
        if surfaced:
            length = to_air
        face = -1
        if min(z, z + dz * length) <= scene.bounds.highest:
            to_bottom, face = first_hit(scene.grid, x, y, z, dx, dy, dz, length)
            if face >= 0:
                length = to_bottom
        if noting and tally.noted[0] < tally.back.shape[0]:
            note_leg(
                tally.back[tally.noted[0]], x, y, depth, dx, dy, dz, length, path, absorbed,
                scattered, weight / entered, turns, depth,
            )  # fmt: skip
            tally.noted[0] += 1
        ahead = crossed(layers, layers.scattering, layers.scattered, depth, -dz, length)
        scattered += ahead
        absorbed += crossed(layers, layers.absorption, layers.absorbed, depth, -dz, length)
        x, y, z, path = x + dx * length, y + dy * length, z + dz * length, path + length
        if face >= 0:
            kept = weight * math.exp(-absorbed)
            ledger[ABSORBED] += unabsorbed - kept
            return Touch(face, x, y, z, dx, dy, dz, path, absorbed, weight, kept)
        if path >= limit:
            break
        if not (
            scene.bounds.west < x < scene.bounds.east
            and scene.bounds.south < y < scene.bounds.north
        ):
            fate = ASIDE
            break
        if surfaced:
            z = sea.level
            mx, my, mz = drawn_normal(sea, method.quantiles, state)
            if scene.wavy:
                z = sea_under(scene, x, y)
                mx, my, mz = tilted(mx, my, mz, slope_x, slope_y)
            mx, my, mz = facing_from_below(dx, dy, dz, mx, my, mz, slope_x, slope_y)
            cosine = dx * mx + dy * my + dz * mz
            if uniform(state) >= fresnel_reflectance(cosine, layers.refractive_index):
                fate = ESCAPED
                break
            optical -= ahead
            dx, dy, dz = reflected(dx, dy, dz, mx, my, mz)
            frame, turning = mirrored(frame, mx, my, mz), False
            continue
        k += 1
        tally.noted[1] += 1
        if k == tracks.legs.shape[2]:
            kept = weight * math.exp(-absorbed)
            if kept < ROULETTE_BELOW:
                ledger[ABSORBED] += unabsorbed - kept
                if uniform(state) >= ROULETTE_SURVIVAL:
                    ledger[ROULETTE] += kept
                    return Touch(-1, x, y, z, dx, dy, dz, path, absorbed, 0.0, 0.0)
                weight /= ROULETTE_SURVIVAL
                unabsorbed = kept / ROULETTE_SURVIVAL
                ledger[ROULETTE] += kept - unabsorbed
            frame = frame_around(dx, dy, dz, method.circle, uniform(state))
            track, k = int(uniform(state) * tracks.legs.shape[1]), 1
        turning, optical = True, tracks.legs[which, track, k, 3]
    kept = weight * math.exp(-absorbed)
    ledger[ABSORBED] += unabsorbed - kept
    ledger[fate] += kept
    return Touch(-1, x, y, z, dx, dy, dz, path, absorbed, 0.0, 0.0)


@leaf_kernel
def see_land(
    scene: Scene, optics: Optics, method: Method, tally: Tally, sight: Sight, touch: Touch
) -> None:
    """Light dry land where the pixel sees it: the laser's ray is the pixel's."""
    nx, ny, nz = facing_normal(scene, touch.face, touch.dx, touch.dy, touch.dz)
    facing = -(touch.dx * nx + touch.dy * ny + touch.dz * nz)
    light = light_on_water(optics, touch.z, touch.x, touch.y, sight.pixel, method.isolated)
    gain = scene.reflectance[touch.face] / math.pi * sight.importance
    deposit(
        tally, BOTTOM, sight.batch, 2.0 * touch.path / speed_of_light,
        method.photons * light * facing / -touch.dz * gain,
    )  # fmt: skip


@inlined_fused_kernel
def see_bottom(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tracks: Tracks,
    tally: Tally,
    sight: Sight,
    start: Touch,
    evenly: Evenly,
    state: NDArray[np.uint64],
) -> None:
    """Walk back from under the surface, from touch to touch of the bottom, and light it all.

    At the rim of what is lit, on a level sea, the column has a track of its own: one chosen to
    light the bottom is no guide to light that begins elsewhere.
    """
    limit = longest_path(scene, layers, optics, sight)
    tally.noted[0], entered, which = 0, start.weight, 2 * sight.batch
    back = chosen(tracks, which + 1, evenly.back, sight.tilt)
    down = chosen(tracks, which, evenly.down, 0 if sight.rim or scene.wavy else sight.tilt)
    frame = frame_uphill(start.dx, start.dy, start.dz)
    turn, entry_weight, touches = evenly.turn, back.weight, 0
    while True:
        touch = walk_back(
            scene, layers, method, tracks, tally, which + 1, back, frame, start, limit,
            touches == 0, state,
        )  # fmt: skip
        nx, ny, nz, rho = 0.0, 0.0, 1.0, 0.0
        x, y, z = start.x, start.y, start.z
        if touch.face >= 0:
            rho = scene.reflectance[touch.face]
            nx, ny, nz = facing_normal(scene, touch.face, touch.dx, touch.dy, touch.dz)
            x, y, z = touch.x, touch.y, touch.z
        elif touches > 0:
            return
        gain = sight.importance * touch.weight / entered * rho / math.pi
        apart = touches == 0 and gain > 0.0 and sight.rim and not scene.wavy
        for part in range(2 if apart else 1):
            send_light(
                scene, layers, optics, method, tracks, tally, sight,
                Place(x, y, z, nx, ny, nz, touch.path, touch.absorbed, gain if part == 0 else 0.0),
                down, turn, entry_weight * down.weight,
                touches == 0 and part == (1 if apart else 0), state,
            )  # fmt: skip
        if touch.face < 0:
            return
        touches += 1
        kept = touch.kept
        tally.ledger[SEABED] += kept * (1.0 - rho)
        kept *= rho
        if uniform(state) >= BOUNCE_CHANCE:
            tally.ledger[ROULETTE] += kept
            return
        tally.ledger[ROULETTE] += kept * (1.0 - 1.0 / BOUNCE_CHANCE)
        dx, dy, dz = lambert_direction(nx, ny, nz, state)
        start = Touch(
            -1, x + nx * LIFT, y + ny * LIFT, z + nz * LIFT, dx, dy, dz,
            touch.path, touch.absorbed, touch.weight * rho / BOUNCE_CHANCE, kept / BOUNCE_CHANCE,
        )  # fmt: skip
        back = course(tracks, which + 1, int(uniform(state) * tracks.legs.shape[1]), 1.0)
        frame = frame_around(dx, dy, dz, method.circle, uniform(state))
        down, turn = chosen(tracks, which, uniform(state), 0), uniform(state)


@inlined_fused_kernel
def see(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tracks: Tracks,
    tally: Tally,
    pixel: int,
    batch: int,
    walks: int,
    rim: bool,
    tilt: int,
    evenly: Evenly,
    state: NDArray[np.uint64],
) -> None:
    """Send one of many walks from a pixel, through the aperture and the air, to land or into water.

    The etendue of a direction is aperture area x cos^4 (to boresight) x tangent-plane area.
    """
    row, column = pixel // optics.columns, pixel % optics.columns
    forward, right = tangents_at(
        optics, (row + evenly.in_rows) / optics.rows, (column + evenly.in_columns) / optics.columns
    )
    dx, dy, dz, cosine = direction_of(optics, forward, right)
    ahead = aside = 1.0
    while ahead * ahead + aside * aside >= 1.0:
        ahead, aside = 2.0 * uniform(state) - 1.0, 2.0 * uniform(state) - 1.0
    ahead, aside = ahead * optics.aperture_radius, aside * optics.aperture_radius
    t = optics.turn
    x = optics.position[0] + t[0, 0] * ahead + t[0, 1] * aside
    y = optics.position[1] + t[1, 0] * ahead + t[1, 1] * aside
    z = optics.position[2] + t[2, 0] * ahead + t[2, 1] * aside
    ledger, stands_for = tally.ledger, evenly.weight
    ledger[LAUNCHED] += stands_for
    if dz >= 0.0:
        ledger[REFLECTED] += stands_for
        return
    solid = 4.0 * optics.half_forward * optics.half_right / (optics.rows * optics.columns)
    importance = math.pi * optics.aperture_radius**2 * solid * cosine**4 / walks
    importance *= stands_for
    length, slope_x, slope_y = first_water(scene, x, y, z, dx, dy, dz)
    to_land, face = math.inf, -1
    if scene.bounds.highest > scene.waves.lowest:
        to_land, face = first_hit(scene.grid, x, y, z, dx, dy, dz, length)
    if face >= 0:
        x, y, z = x + dx * to_land, y + dy * to_land, z + dz * to_land
        sight = Sight(pixel, batch, 0.0, importance, rim, tilt)
        touch = Touch(face, x, y, z, dx, dy, dz, to_land, 0.0, 1.0, 1.0)
        see_land(scene, optics, method, tally, sight, touch)
        ledger[REFLECTED] += stands_for
        return
    if length == math.inf:
        ledger[REFLECTED] += stands_for
        return
    x, y, level = x + dx * length, y + dy * length, scene.sea.level
    mx, my, mz = drawn_normal(scene.sea, method.quantiles, state)
    onto = 1.0
    if scene.wavy:
        level = z + dz * length - BELOW
        onto = -dz / (dx * slope_x + dy * slope_y - dz)
        mx, my, mz = tilted(mx, my, mz, slope_x, slope_y)
    dx, dy, dz, caught, reflectance = enter_water(layers.refractive_index, dx, dy, dz, mx, my, mz)
    caught *= onto
    weight = caught * (1.0 - reflectance) * passing(scene.sea)
    importance *= weight * gain_of(layers)
    caught, weight = caught * stands_for, weight * stands_for
    ledger[FACETS] += caught - stands_for
    ledger[REFLECTED] += caught - weight
    if weight <= 0.0 or dz >= 0.0:
        ledger[ESCAPED] += weight
        return
    sight = Sight(pixel, batch, length / speed_of_light, importance, rim, tilt)
    start = Touch(-1, x, y, level, dx, dy, dz, 0.0, 0.0, weight, weight)
    see_bottom(scene, layers, optics, method, tracks, tally, sight, start, evenly, state)


@leaf_kernel
def gain_of(layers: Layers) -> float:
    """Radiance falls by n^2 as light leaves the water [1]."""
    return 1.0 / (layers.refractive_index * layers.refractive_index)


@fused_kernel
def see_all(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tracks: Tracks,
    tally: Tally,
    address: Address,
    walks: NDArray[np.int64],
    rims: NDArray[np.bool_],
    state: NDArray[np.uint64],
    mean: NDArray[np.float32],
    variance: NDArray[np.float32],
) -> None:
    """Fill ``mean`` and ``variance`` (2, pixels, bins) with column and bottom.

    ``walks`` (pixels,) are those of a replicate; ``rims`` tells where many begin in the dark.
    """
    for pixel in range(mean.shape[1]):
        clear(tally)
        tilt = tilt_of(optics, layers.refractive_index, pixel)
        for batch in range(tally.coarse.shape[0]):
            shares = shared_out(
                walks[pixel], part_early(tracks, 2 * batch + 1), part_early(tracks, 2 * batch)
            )
            start_stream(state, address.seed, PIXELS, address.frame, batch, pixel)
            shifts = Shifts(
                uniform(state), uniform(state), uniform(state), uniform(state), uniform(state)
            )
            for i in range(walks[pixel]):
                evenly = spread_evenly(i, shares, shifts)
                see(
                    scene, layers, optics, method, tracks, tally, pixel, batch, walks[pixel],
                    rims[pixel], tilt, evenly, state,
                )  # fmt: skip
        for origin in range(2):
            add_up(tally, origin, mean[origin, pixel])
            tell_variance(tally, origin, mean[origin, pixel], variance[origin, pixel])

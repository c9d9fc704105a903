"""One random walk in the water, forward from the laser or backward from a pixel alike."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from survey.transport.directions import drawn, lambert_direction, turned
from survey.transport.random import exponential, uniform
from survey.transport.records import (
    ABSORBED,
    ASIDE,
    ESCAPED,
    LATE,
    ROULETTE,
    SEABED,
    Records,
    record_arrival,
    record_crossings,
)
from survey.transport.scene import Bounds, Medium, Scene
from survey.transport.surface import reflectance_from_below
from terrain.kernels import leaf_kernel
from terrain.patches import patch_at
from terrain.raycast import first_hit

ROULETTE_BELOW = 1e-4
ROULETTE_SURVIVAL = 0.1
LIFT = 1e-7


@leaf_kernel
def arrive_at_bottom(
    scene: Scene,
    records: Records,
    owner: int,
    batch: int,
    face: int,
    x: float,
    y: float,
    z: float,
    dz: float,
    weight: float,
    time: float,
    speed: float,
    east_slowness: float,
    north_slowness: float,
) -> None:
    """Note an arrival on its patch, timed at the patch's centre.

    The whole walk is thought shifted sideways, as light that was launched beside it, and then
    lengthened or shortened to the centre's elevation.
    """
    patch, area, cx, cy, cz = patch_at(scene.patches, face, x, y, z)
    late = (cx - x) * east_slowness + (cy - y) * north_slowness + dz * (cz - z) / speed
    record_arrival(
        records,
        patch,
        owner,
        batch,
        time + late,
        weight,
        scene.reflectance[face] / (math.pi * area),
    )


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


@leaf_kernel
def is_inside(bounds: Bounds, x: float, y: float) -> bool:
    """Tell whether a walk is still within the box that is followed."""
    return bounds.west < x < bounds.east and bounds.south < y < bounds.north


@leaf_kernel
def walk_in_water(
    scene: Scene,
    medium: Medium,
    records: Records,
    state: NDArray[np.uint64],
    owner: int,
    batch: int,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
    weight: float,
    time: float,
    east_slowness: float,
    north_slowness: float,
    first_path: float,
    in_column: float,
    bounces: bool,
) -> None:
    """Follow one walk until it is absorbed, leaves, or is too late.

    It flies to the nearest of scattering, surface, bottom and time limit, then does what happens
    there. The slownesses are those of the launch eastwards and northwards [s/m], ``first_path``
    is the first optical path, ``in_column`` the factor with which crossings of the column's planes
    count (0: they do not; after the bottom none does), ``bounces`` whether it goes on from the
    bottom.
    """
    roulette_below = ROULETTE_BELOW * weight
    path = first_path
    ledger = records.ledger
    while True:
        to_scattering = path / medium.scattering if medium.scattering > 0.0 else math.inf
        to_surface = (scene.sea.level - z) / dz if dz > 0.0 else math.inf
        to_limit = (scene.bounds.latest - time) * medium.speed
        length = min(to_scattering, to_surface, to_limit)
        to_bottom, face = first_hit(scene.grid, x, y, z, dx, dy, dz, length)
        if face >= 0:
            length = to_bottom
        if in_column > 0.0:
            record_crossings(
                scene.layers, records, owner, batch, x, y, z, dx, dy, dz, length,
                weight * in_column, medium.attenuation, time, medium.speed, east_slowness,
                north_slowness,
            )  # fmt: skip
        x, y, z = x + dx * length, y + dy * length, z + dz * length
        time += length / medium.speed
        kept = math.exp(-medium.attenuation * length)
        ledger[ABSORBED] += weight * (1.0 - kept)
        weight *= kept
        path = exponential(state)
        if not is_inside(scene.bounds, x, y):
            ledger[ASIDE] += weight
            return
        if face >= 0:
            arrive_at_bottom(
                scene, records, owner, batch, face, x, y, z, dz, weight, time, medium.speed,
                east_slowness, north_slowness,
            )  # fmt: skip
            if not bounces:
                return
            ledger[SEABED] += weight * (1.0 - scene.reflectance[face])
            weight *= scene.reflectance[face]
            nx, ny, nz = facing_normal(scene, face, dx, dy, dz)
            dx, dy, dz = lambert_direction(nx, ny, nz, state)
            x, y, z = x + nx * LIFT, y + ny * LIFT, z + nz * LIFT
            in_column = 0.0
        elif length == to_limit:
            ledger[LATE] += weight
            return
        elif length == to_surface:
            z = scene.sea.level
            reflectance, rx, ry, rz = reflectance_from_below(
                scene.sea, medium.refractive_index, x, y, dx, dy, dz
            )
            if uniform(state) >= reflectance:
                ledger[ESCAPED] += weight
                return
            dx, dy, dz = rx, ry, rz
        else:
            records.filled[2] += 1
            azimuth = 2.0 * math.pi * uniform(state)
            dx, dy, dz = turned(
                dx, dy, dz, drawn(medium.sampler, medium.sampler_share, state), azimuth
            )
        if weight < roulette_below:
            if uniform(state) >= ROULETTE_SURVIVAL:
                ledger[ROULETTE] += weight
                return
            ledger[ROULETTE] -= weight * (1.0 / ROULETTE_SURVIVAL - 1.0)
            weight /= ROULETTE_SURVIVAL
        if weight <= 0.0:
            return

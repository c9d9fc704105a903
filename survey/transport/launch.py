"""How walks begin: from the laser into its field of view, from a pixel through the aperture."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.transport.random import FORWARD, start_stream, uniform
from survey.transport.records import ESCAPED, FACETS, LAUNCHED, REFLECTED, Records
from survey.transport.scene import Medium, Scene
from survey.transport.surface import enter_water
from survey.transport.walk import arrive_at_bottom, walk_in_water
from terrain.kernels import kernel, leaf_kernel
from terrain.raycast import first_hit

# Roberts (2018): additive recurrences of low discrepancy in one and three dimensions.
GOLDEN = 0.6180339887498949
PLASTIC_1, PLASTIC_2, PLASTIC_3 = 0.8191725133961645, 0.6710436067037893, 0.5497004779019703


class Optics(NamedTuple):
    """Laser and camera at one place: where they are, how they are turned, what they see.

    ``turn`` (3, 3) takes (forward, right, down) to (east, north, up); tangents are those of the
    whole field of view from its left and aft corner.
    """

    position: NDArray[np.float64]
    turn: NDArray[np.float64]
    half_forward: float
    half_right: float
    rows: int
    columns: int
    columns_forward: bool
    aperture_radius: float


class Address(NamedTuple):
    """Which random numbers a set of walks draws."""

    seed: int
    frame: int


@leaf_kernel
def fraction(value: float) -> float:
    """Part of a positive number behind the point."""
    return value - math.floor(value)


@leaf_kernel
def pixel_at(optics: Optics, forward: float, right: float) -> int:
    """Flat index of the pixel that looks along the tangents (forward, right); -1 outside."""
    from_front = 0.5 * (1.0 - forward / optics.half_forward)
    from_left = 0.5 * (1.0 + right / optics.half_right)
    if not (0.0 <= from_front < 1.0 and 0.0 <= from_left < 1.0):
        return -1
    if optics.columns_forward:
        return int(from_left * optics.rows) * optics.columns + int(from_front * optics.columns)
    return int(from_front * optics.rows) * optics.columns + int(from_left * optics.columns)


@leaf_kernel
def direction_of(optics: Optics, forward: float, right: float) -> tuple[float, float, float, float]:
    """Unit direction on the map of the tangents (forward, right), and its cosine to boresight."""
    cosine = 1.0 / math.sqrt(1.0 + forward * forward + right * right)
    t = optics.turn
    return (
        (t[0, 0] * forward + t[0, 1] * right + t[0, 2]) * cosine,
        (t[1, 0] * forward + t[1, 1] * right + t[1, 2]) * cosine,
        (t[2, 0] * forward + t[2, 1] * right + t[2, 2]) * cosine,
        cosine,
    )


@leaf_kernel
def fly_down(
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
    gain: float,
    first_path: float,
    in_column: float,
    bounces: bool,
) -> None:
    """Bring a walk through the air to land, where it ends, or into the water.

    ``gain`` multiplies the weight at the surface: 1 for light, 1/n^2 for importance.
    """
    ledger = records.ledger
    ledger[LAUNCHED] += weight
    if dz >= 0.0:
        ledger[REFLECTED] += weight
        return
    east_slowness, north_slowness = dx / speed_of_light, dy / speed_of_light
    length = (scene.sea.level - z) / dz
    to_land, face = first_hit(scene.grid, x, y, z, dx, dy, dz, length)
    if face >= 0:
        arrive_at_bottom(
            scene, records, owner, batch, face,
            x + dx * to_land, y + dy * to_land, z + dz * to_land, dz,
            weight, to_land / speed_of_light, speed_of_light, east_slowness, north_slowness,
        )  # fmt: skip
        ledger[REFLECTED] += weight
        return
    x, y = x + dx * length, y + dy * length
    dx, dy, dz, caught, reflectance = enter_water(
        scene.sea, medium.refractive_index, x, y, dx, dy, dz
    )
    ledger[FACETS] += weight * (caught - 1.0)
    weight *= caught
    ledger[REFLECTED] += weight * reflectance
    weight *= (1.0 - reflectance) * gain
    if weight <= 0.0 or dz >= 0.0:
        ledger[ESCAPED] += weight
        return
    walk_in_water(
        scene, medium, records, state, owner, batch, x, y, scene.sea.level, dx, dy, dz,
        weight, length / speed_of_light, east_slowness, north_slowness, first_path, in_column,
        bounces,
    )  # fmt: skip


@kernel
def launch_forward(
    scene: Scene,
    medium: Medium,
    optics: Optics,
    records: Records,
    address: Address,
    batch: int,
    along: int,
    across: int,
    column_stride: int,
    photons: float,
) -> None:
    """Launch along x across walks that share the pulse's photons evenly over the field of view.

    One walk starts in each cell of a regular division of the field of view (stratified), and the
    first optical paths follow a golden-ratio sequence with a random shift. One walk in
    ``column_stride`` takes part in the water column, in its stead and the others'.
    """
    state = np.empty(2, np.uint64)
    start_stream(state, address.seed, FORWARD, address.frame, batch, -1)
    shift, column_shift = uniform(state), uniform(state)
    walks = along * across
    for i in range(walks):
        start_stream(state, address.seed, FORWARD, address.frame, batch, i)
        forward = ((i // across + uniform(state)) / along * 2.0 - 1.0) * optics.half_forward
        right = ((i % across + uniform(state)) / across * 2.0 - 1.0) * optics.half_right
        dx, dy, dz, _ = direction_of(optics, forward, right)
        first_path = -math.log(1.0 - fraction(shift + i * GOLDEN))
        drawn = fraction(column_shift + i * PLASTIC_1) * column_stride < 1.0
        fly_down(
            scene, medium, records, state, pixel_at(optics, forward, right), batch,
            optics.position[0], optics.position[1], optics.position[2], dx, dy, dz,
            photons / walks, 1.0, first_path, float(column_stride) if drawn else 0.0, True,
        )  # fmt: skip


@kernel
def launch_backward(
    scene: Scene,
    medium: Medium,
    optics: Optics,
    records: Records,
    address: Address,
    purpose: int,
    batch: int,
    walks: int,
    in_column: float,
) -> None:
    """Launch so many walks from every pixel; their weights sum to the pixel's etendue [m2 sr].

    The etendue of a direction is aperture area x cos^4 (to boresight) x tangent-plane area.
    Directions within the pixel and first paths follow a three-dimensional low-discrepancy
    sequence, shifted at random for each pixel; places in the aperture are random. ``in_column``
    is 1 where crossings of the column's planes are noted, else 0.
    """
    state = np.empty(2, np.uint64)
    pixels = optics.rows * optics.columns
    area = math.pi * optics.aperture_radius**2
    solid = 4.0 * optics.half_forward * optics.half_right / pixels
    gain = 1.0 / (medium.refractive_index * medium.refractive_index)
    t = optics.turn
    for pixel in range(pixels):
        start_stream(state, address.seed, purpose, address.frame, batch, pixel)
        shift_1, shift_2, shift_3 = uniform(state), uniform(state), uniform(state)
        row, column = pixel // optics.columns, pixel % optics.columns
        for i in range(walks):
            number = pixels + pixel * walks + i
            start_stream(state, address.seed, purpose, address.frame, batch, number)
            in_rows = (row + fraction(shift_1 + i * PLASTIC_1)) / optics.rows * 2.0 - 1.0
            in_columns = (column + fraction(shift_2 + i * PLASTIC_2)) / optics.columns * 2.0 - 1.0
            if optics.columns_forward:
                forward, right = -in_columns * optics.half_forward, in_rows * optics.half_right
            else:
                forward, right = -in_rows * optics.half_forward, in_columns * optics.half_right
            dx, dy, dz, cosine = direction_of(optics, forward, right)
            radius = optics.aperture_radius * math.sqrt(uniform(state))
            angle = 2.0 * math.pi * uniform(state)
            ahead, aside = radius * math.cos(angle), radius * math.sin(angle)
            fly_down(
                scene, medium, records, state, pixel, batch,
                optics.position[0] + t[0, 0] * ahead + t[0, 1] * aside,
                optics.position[1] + t[1, 0] * ahead + t[1, 1] * aside,
                optics.position[2] + t[2, 0] * ahead + t[2, 1] * aside,
                dx, dy, dz, area * solid * cosine**4 / walks, gain,
                -math.log(1.0 - fraction(shift_3 + i * PLASTIC_3)), in_column, False,
            )  # fmt: skip

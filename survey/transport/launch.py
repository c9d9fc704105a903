"""Laser and camera as kernels take them: which way a pixel looks, which pixel sees a place."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import leaf_kernel


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
def tangents_at(optics: Optics, in_rows: float, in_columns: float) -> tuple[float, float]:
    """Tangents (forward, right) of a place in the field of view, from 0 to 1 each way."""
    row, column = 2.0 * in_rows - 1.0, 2.0 * in_columns - 1.0
    if optics.columns_forward:
        return -column * optics.half_forward, row * optics.half_right
    return -row * optics.half_forward, column * optics.half_right


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

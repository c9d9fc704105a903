"""New directions: after a scattering, from a Lambertian face."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from survey.transport.random import uniform
from survey.transport.table import value_at
from terrain.kernels import leaf_kernel


@leaf_kernel
def turned(
    dx: float, dy: float, dz: float, one_minus_cos: float, azimuth: float
) -> tuple[float, float, float]:
    """Turn a unit direction by a polar angle, given as 1 - cos, and an azimuth [rad]."""
    cos_polar = 1.0 - one_minus_cos
    sin_polar = math.sqrt(max(0.0, one_minus_cos * (2.0 - one_minus_cos)))
    across, along = sin_polar * math.cos(azimuth), sin_polar * math.sin(azimuth)
    sign = 1.0 if dz >= 0.0 else -1.0
    shear = -1.0 / (sign + dz)
    mixed = dx * dy * shear
    nx = cos_polar * dx + across * (1.0 + sign * dx * dx * shear) + along * mixed
    ny = cos_polar * dy + across * sign * mixed + along * (sign + dy * dy * shear)
    nz = cos_polar * dz - across * sign * dx - along * dy
    norm = 1.0 / math.sqrt(nx * nx + ny * ny + nz * nz)
    return nx * norm, ny * norm, nz * norm


@leaf_kernel
def drawn(sampler: NDArray[np.float64], share: float, state: NDArray[np.uint64]) -> float:
    """Draw 1 - cos of a scattering angle from the forward ``share`` of a phase function."""
    return value_at(sampler, uniform(state) * share)


@leaf_kernel
def lambert_direction(
    nx: float, ny: float, nz: float, state: NDArray[np.uint64]
) -> tuple[float, float, float]:
    """Draw a direction from a Lambertian face of unit normal n."""
    cosine = math.sqrt(1.0 - uniform(state))
    return turned(nx, ny, nz, 1.0 - cosine, 2.0 * math.pi * uniform(state))

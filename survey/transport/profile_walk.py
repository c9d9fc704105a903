"""The walk behind `survey.transport.profile`: one photon through an even layer, tallied at levels.

Free paths by scattering, absorption as a weight along the path. Beside the phase function, the
random numbers and Fresnel's formula it shares nothing with the engines.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from survey.optics.interface import fresnel_reflectance, refracted
from survey.transport.directions import drawn, lambert_direction, turned
from survey.transport.random import REFERENCE, exponential, start_stream, uniform
from terrain.kernels import kernel, leaf_kernel

FloatArray = NDArray[np.float64]

# Roulette begins where absorption has left this of the light at the deepest level.
LEAST_WEIGHT = 1e-4
# Light closer to the horizon than this cosine counts as its average over even radiance there.
GRAZING_COSINE = 0.05
DOWNWARD, UPWARD_SCALAR, UPWARD_RADIANCE = range(3)
ADDRESS_OF_PROFILES = 2


class Layer(NamedTuple):
    """An even layer, lengths in mean free paths: levels to tally at, optics, bounds.

    ``cone`` is the phase function averaged over the cone that looks down, by the angle from its
    axis.
    """

    levels: FloatArray
    albedo: float
    sampler: FloatArray
    cone: FloatArray
    refractive_index: float
    cos_incidence: float
    bottom: float
    bottom_reflectance: float


@leaf_kernel
def _cross(
    tally: FloatArray, layer: Layer, t: float, dz: float, step: float, weight: float
) -> None:
    """Count the levels that a straight piece of a path goes through.

    Each adds 1 / cos to the scalar irradiance, whose variance grazing light would make infinite:
    below a cosine e the average 2 / e of even radiance stands for it (Clark 1966).
    """
    for k in range(layer.levels.shape[0]):
        way = (t - layer.levels[k]) / dz
        if 0.0 <= way <= step:
            left = weight * math.exp((layer.albedo - 1.0) * way)
            if dz < 0.0:
                tally[DOWNWARD, k] += left
            elif dz > GRAZING_COSINE:
                tally[UPWARD_SCALAR, k] += left / dz
            else:
                tally[UPWARD_SCALAR, k] += 2.0 * left / GRAZING_COSINE


@leaf_kernel
def _send_up(tally: FloatArray, layer: Layer, t: float, light: float) -> None:
    """Add what goes straight up from depth t without another event, ``light`` per steradian."""
    for k in range(layer.levels.shape[0]):
        if layer.levels[k] <= t:
            tally[UPWARD_RADIANCE, k] += light * math.exp(layer.levels[k] - t)


@leaf_kernel
def _into_cone(cone: FloatArray, dz: float) -> float:
    place = math.acos(min(1.0, max(-1.0, dz))) / math.pi * (cone.shape[0] - 1)
    i = min(int(place), cone.shape[0] - 2)
    return float(cone[i] + (place - i) * (cone[i + 1] - cone[i]))


@leaf_kernel
def _walk(tally: FloatArray, layer: Layer, least: float, state: NDArray[np.uint64]) -> None:
    index, bottom = layer.refractive_index, layer.bottom
    weight = 1.0 - fresnel_reflectance(layer.cos_incidence, 1.0 / index)
    sine = math.sqrt(1.0 - layer.cos_incidence * layer.cos_incidence)
    dx, dy, dz = refracted(sine, 0.0, -layer.cos_incidence, 0.0, 0.0, 1.0, 1.0 / index)
    t = 0.0
    while weight > 0.0:
        free = exponential(state) / layer.albedo
        wall = t / dz if dz > 0.0 else (bottom - t) / -dz if dz < 0.0 else math.inf
        step = min(free, wall)
        _cross(tally, layer, t, dz, step, weight)
        weight *= math.exp((layer.albedo - 1.0) * step)
        if weight < least:
            weight = weight * 10.0 if uniform(state) < 0.1 else 0.0
        if free < wall:
            t -= dz * free
            _send_up(tally, layer, t, weight * _into_cone(layer.cone, dz))
            azimuth = 2.0 * math.pi * uniform(state)
            dx, dy, dz = turned(dx, dy, dz, drawn(layer.sampler, 1.0, state), azimuth)
        elif dz > 0.0:
            t = 0.0
            if uniform(state) >= fresnel_reflectance(dz, index):
                return
            dz = -dz
        else:
            t = bottom
            weight *= layer.bottom_reflectance
            _send_up(tally, layer, t, weight / math.pi)
            dx, dy, dz = lambert_direction(0.0, 0.0, 1.0, state)


@kernel
def walk_batch(tally: FloatArray, layer: Layer, seed: int, batch: int, walks: int) -> None:
    """Walk one batch of photons of unit weight into ``tally`` (3, levels)."""
    least = LEAST_WEIGHT * math.exp((layer.albedo - 1.0) * layer.levels.max())
    state = np.empty(2, np.uint64)
    for i in range(walks):
        start_stream(state, seed, REFERENCE, ADDRESS_OF_PROFILES, batch, i)
        _walk(tally, layer, least, state)

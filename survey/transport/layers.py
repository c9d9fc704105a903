"""Water in layers, as the engine's walks meet it: free paths, absorption, turns by depth."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.water import WaterColumn
from survey.transport.table import value_at
from terrain.kernels import inlined_fused_kernel, leaf_kernel

FloatArray = NDArray[np.float64]

LEVEL = 1e-6
"""Cosine to the vertical below which a leg counts as level [1]."""


class Layers(NamedTuple):
    """Layers of uniform water, by depth; the first reaches up and the last down without end.

    ``tops`` [m], ``absorption`` and ``scattering`` [1/m] of each, and what light has crossed of
    either from the surface down to its top: ``absorbed`` and ``scattered`` [1]. ``phase`` (layers,)
    numbers the phase functions, whose tables are the rows of ``samplers`` and ``densities``.
    """

    tops: FloatArray
    absorption: FloatArray
    scattering: FloatArray
    absorbed: FloatArray
    scattered: FloatArray
    phase: NDArray[np.int64]
    samplers: FloatArray
    densities: FloatArray
    speed: float
    refractive_index: float


def kernel_layers(column: WaterColumn) -> Layers:
    """Return a water column as kernels take it; each phase function is tabled once."""
    waters = [layer.water for layer in column.layers]
    tops = np.array([layer.top for layer in column.layers])
    phases = column.phase_functions
    numbers = {id(phase): number for number, phase in enumerate(phases)}
    return Layers(
        tops=tops,
        absorption=np.array([water.absorption for water in waters]),
        scattering=np.array([water.scattering for water in waters]),
        absorbed=column.absorbed(tops),
        scattered=column.scattered(tops),
        phase=np.array([numbers[id(water.phase_function)] for water in waters], np.int64),
        samplers=np.array([phase.sampler_table() for phase in phases]),
        densities=np.array([phase.cosine_table() for phase in phases]),
        speed=speed_of_light / column.group_index,
        refractive_index=column.refractive_index,
    )


@leaf_kernel
def last_at(sorted_values: FloatArray, value: float) -> int:
    """Index of the last of ascending values that is not above ``value``; 0 if all are."""
    low, high = 0, sorted_values.shape[0]
    while high - low > 1:
        middle = (low + high) // 2
        if sorted_values[middle] <= value:
            low = middle
        else:
            high = middle
    return low


@inlined_fused_kernel
def free_path(layers: Layers, depth: float, sinking: float, optical: float) -> float:
    """Way from a depth, sinking so much a metre, to the next scattering [m].

    ``optical`` is the way in scatterings.
    """
    if layers.tops.shape[0] == 1:
        return float(optical / layers.scattering[0])
    return free_path_in_layers(
        layers.tops, layers.scattering, layers.scattered, depth, sinking, optical
    )


@leaf_kernel
def free_path_in_layers(
    tops: FloatArray,
    scattering: FloatArray,
    scattered: FloatArray,
    depth: float,
    sinking: float,
    optical: float,
) -> float:
    """Way as `free_path` tells it, in more layers than one [m]."""
    i = last_at(tops, depth)
    if abs(sinking) < LEVEL:
        return float(optical / scattering[i])
    at = scattered[i] + scattering[i] * (depth - tops[i]) + optical * sinking
    j = last_at(scattered, at)
    if scattering[j] == 0.0:
        return math.inf
    reached = tops[j] + (at - scattered[j]) / scattering[j]
    return float(max(0.0, (reached - depth) / sinking))


@inlined_fused_kernel
def crossed(
    layers: Layers,
    coefficient: FloatArray,
    to_top: FloatArray,
    depth: float,
    sinking: float,
    length: float,
) -> float:
    """Integral of a coefficient along a way of some length [1].

    ``coefficient`` and ``to_top`` are those of absorption or of scattering.
    """
    if layers.tops.shape[0] == 1:
        return float(coefficient[0] * length)
    return crossed_layers(layers.tops, coefficient, to_top, depth, sinking, length)


@leaf_kernel
def crossed_layers(
    tops: FloatArray,
    coefficient: FloatArray,
    to_top: FloatArray,
    depth: float,
    sinking: float,
    length: float,
) -> float:
    """Integral as `crossed` tells it, in more layers than one [1]."""
    i = last_at(tops, depth)
    if abs(sinking) < LEVEL:
        return float(coefficient[i] * length)
    below = depth + sinking * length
    j = last_at(tops, below)
    start = to_top[i] + coefficient[i] * (depth - tops[i])
    end = to_top[j] + coefficient[j] * (below - tops[j])
    return float((end - start) / sinking)


@inlined_fused_kernel
def bend_at(layers: Layers, depth: float, chance: float) -> float:
    """Return 1 - cos of the angle below which a share ``chance`` of all scattering there goes."""
    table = layers.samplers[layers.phase[last_at(layers.tops, depth)]]
    return value_at(table, chance)


@inlined_fused_kernel
def wide_turn(layers: Layers, depth: float, cosine: float, split_cosine: float) -> float:
    """Return how unlikely a turn is: 1 / density if it is wider than the split [sr], else 0."""
    return 1.0 / density_at(layers, depth, cosine) if cosine < split_cosine else 0.0


@inlined_fused_kernel
def density_at(layers: Layers, depth: float, cosine: float) -> float:
    """Phase function of the water at a depth, at the cosine of a wide angle [1/sr]."""
    table = layers.densities[layers.phase[last_at(layers.tops, depth)]]
    return value_at(table, max(0.0, 0.5 * (cosine + 1.0)))

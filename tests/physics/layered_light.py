"""Light under a flat surface in layered water by plain walks, written apart from the engine.

Walks go straight up to the next scattering or the next edge of a layer, where they go on with the
rest of their optical length. Scattering is analogue, absorption a weight; the flat surface sends
back Fresnel's share of what comes from below, the level Lambertian bottom its reflectance.
Everything is even horizontally: a walk stands for light that entered anywhere, and only its depth
is followed.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from survey.optics.water import WaterColumn

FloatArray = NDArray[np.float64]

LEVEL_STEP = 0.04
"""Distance of the levels at which walks from both ends meet [m]."""
SMALLEST_SINE = 1e-12


class Flights(NamedTuple):
    """Straight ways of many walks, each within one layer from a ``depth``; ``direction`` (3, n)."""

    depth: FloatArray
    direction: FloatArray
    length: FloatArray
    weight: FloatArray
    path: FloatArray
    layer: NDArray[np.int64]
    touched: NDArray[np.bool_]
    at_bottom: NDArray[np.bool_]

    def select(self, chosen: NDArray[np.bool_]) -> Flights:
        """Return some of the flights."""
        return Flights(*(values[..., chosen] for values in self))


class Light(NamedTuple):
    """What light paths carry, their length in water [m] and the depth where they turn up [m]."""

    weight: FloatArray
    path: FloatArray
    depth: FloatArray


def turned(direction: FloatArray, bend: FloatArray, azimuth: FloatArray) -> FloatArray:
    """Return directions (3, n) turned by an angle whose 1 - cos is ``bend``."""
    sine = np.sqrt(bend * (2.0 - bend))
    x, y, _ = direction
    flat = np.hypot(x, y)
    upright = flat < SMALLEST_SINE
    safe = np.where(upright, 1.0, flat)
    zero = np.zeros_like(x)
    across = np.where(upright, [zero + 1.0, zero, zero], [-y / safe, x / safe, zero])
    other = np.cross(direction, across, axis=0)
    side = np.cos(azimuth) * across + np.sin(azimuth) * other
    new = (1.0 - bend) * direction + sine * side
    return np.asarray(new / np.linalg.norm(new, axis=0))


def sent_back(cosine: FloatArray, index: float) -> FloatArray:
    """Fresnel reflectance of unpolarised light that meets the surface from below [1]."""
    squared = 1.0 - index**2 * (1.0 - cosine**2)
    outside = np.sqrt(np.maximum(squared, 0.0))
    upright = ((index * cosine - outside) / (index * cosine + outside)) ** 2
    level = ((cosine - index * outside) / (cosine + index * outside)) ** 2
    return np.where(squared > 0.0, 0.5 * (upright + level), 1.0)


def flights(
    column: WaterColumn,
    *,
    bottom: float,
    reflectance: float,
    count: int,
    longest: float,
    largest_turn: float,
    rng: np.random.Generator,
) -> Iterator[Flights]:
    """Yield the flights of walks that start straight down under the surface.

    Parameters
    ----------
    bottom, reflectance : float
        Depth [m] and Lambertian reflectance [1].
    longest : float
        Length after which walks are given up [m].
    largest_turn : float
        Walks end where they scatter by more than this [rad].
    """
    layers = [layer for layer in column.layers if layer.top < bottom]
    edges = np.array([layer.top for layer in layers] + [bottom])
    absorption = np.array([layer.water.absorption for layer in layers])
    scattering = np.array([layer.water.scattering for layer in layers])
    bends = [layer.water.phase_function.sampler_table() for layer in layers]

    depth = np.zeros(count)
    direction = np.tile([[0.0], [0.0], [1.0]], count)
    weight, path = np.ones(count), np.zeros(count)
    layer = np.zeros(count, dtype=np.int64)
    touched = np.zeros(count, dtype=bool)
    left = rng.exponential(size=count)
    while weight.size:
        down = direction[2] > 0.0
        edge = edges[layer + down]
        sinking = np.where(np.abs(direction[2]) < SMALLEST_SINE, SMALLEST_SINE, direction[2])
        to_edge = np.abs((edge - depth) / sinking)
        to_scattering = left / scattering[layer]
        scatters = to_scattering < to_edge
        length = np.minimum(to_edge, to_scattering)
        at_bottom = ~scatters & down & (layer == len(layers) - 1)
        at_surface = ~scatters & ~down & (layer == 0)
        yield Flights(depth, direction, length, weight, path, layer, touched, at_bottom)

        depth = np.where(scatters, depth + length * direction[2], edge)
        path = path + length
        weight = weight * np.exp(-absorption[layer] * length)
        left = left - scattering[layer] * length
        direction, touched = direction.copy(), touched | at_bottom

        bend = np.zeros(weight.size)
        for number, table in enumerate(bends):
            here = scatters & (layer == number)
            rest, entry = np.modf(rng.random(np.count_nonzero(here)) * (table.size - 1))
            entry = entry.astype(np.int64)
            bend[here] = (1.0 - rest) * table[entry] + rest * table[entry + 1]
        spin = rng.uniform(0.0, 2.0 * np.pi, weight.size)
        direction[:, scatters] = turned(direction[:, scatters], bend[scatters], spin[scatters])
        left[scatters] = rng.exponential(size=np.count_nonzero(scatters))

        weight[at_bottom] *= reflectance
        up = np.sqrt(rng.random(weight.size))
        flat = np.sqrt(1.0 - up**2)
        lambert = np.array([flat * np.cos(spin), flat * np.sin(spin), -up])
        direction[:, at_bottom] = lambert[:, at_bottom]

        weight[at_surface] *= sent_back(-direction[2, at_surface], column.refractive_index)
        direction[2, at_surface] *= -1.0

        layer = layer + np.where(scatters | at_bottom | at_surface, 0, np.where(down, 1, -1))
        alive = (path < longest) & (weight > 0.0) & (bend <= 1.0 - np.cos(largest_turn))
        direction = direction[:, alive]
        depth, weight, path, layer, touched, left = (
            values[alive] for values in (depth, weight, path, layer, touched, left)
        )


def arrivals(column: WaterColumn, **walks: object) -> tuple[Light, Light]:
    """Return light at the bottom of walks of unit weight: all of it, and the first touches."""
    absorption = np.array([layer.water.absorption for layer in column.layers])
    found = []
    for flight in flights(column, **walks):
        hit = flight.select(flight.at_bottom)
        kept = hit.weight * np.exp(-absorption[hit.layer] * hit.length)
        end = hit.depth + hit.length * hit.direction[2]
        found.append((kept, hit.path + hit.length, end, hit.touched))
    *light, touched = (np.concatenate(values) for values in zip(*found, strict=True))
    return Light(*light), Light(*(values[~touched] for values in light))


class Crossings(NamedTuple):
    """Walks through levels, in the order of the levels, the first of each being ``first``."""

    direction: FloatArray
    weight: FloatArray
    path: FloatArray
    first: NDArray[np.int64]


def crossings(column: WaterColumn, *, bottom: float, count: int, **walks: object) -> Crossings:
    """Return where walks pass the middles of slices; weights are fluence per walk [1]."""
    absorption = np.array([layer.water.absorption for layer in column.layers])
    levels = round(bottom / LEVEL_STEP)
    found = []
    for flight in flights(column, bottom=bottom, count=count, **walks):
        ends = flight.depth + np.array([[0.0], [1.0]]) * flight.length * flight.direction[2]
        above = np.ceil(np.sort(ends, axis=0) / LEVEL_STEP - 0.5).astype(np.int64)
        above = np.clip(above, 0, levels)
        passed = above[1] - above[0]
        walk = np.repeat(np.arange(passed.size), passed)
        before = np.cumsum(passed) - passed
        level = np.arange(walk.size) - before[walk] + above[0, walk]
        sinking = flight.direction[2, walk]
        way = ((level + 0.5) * LEVEL_STEP - flight.depth[walk]) / sinking
        fluence = flight.weight[walk] * np.exp(-absorption[flight.layer[walk]] * way)
        found.append(
            (
                flight.direction[:, walk],
                fluence / np.abs(sinking) / count,
                flight.path[walk] + way,
                level,
            )
        )
    direction, weight, path, level = (
        np.concatenate(values, axis=-1) for values in zip(*found, strict=True)
    )
    order = np.argsort(level, kind="stable")
    first = np.searchsorted(level[order], np.arange(levels + 1))
    return Crossings(direction[:, order], weight[order], path[order], first)


def column_light(
    column: WaterColumn, *, count: int, turn: float, rng: np.random.Generator, **walks: object
) -> Light:
    """Return light paths from straight down to straight up that do not touch the bottom.

    A path is put together at its last scattering by more than ``turn``: a walk from the surface
    has come there, one from the receiver that scatters by less has come there too. Weights sum up
    to the radiance upwards over the irradiance that enters [1/sr].
    """
    absorption = np.array([layer.water.absorption for layer in column.layers])
    scattering = np.array([layer.water.scattering for layer in column.layers])
    shared = {"reflectance": 0.0, "rng": rng, **walks}
    way_up = crossings(column, count=max(count // 8, 1000), largest_turn=turn, **shared)
    found = []
    for flight in flights(column, count=count, largest_turn=np.pi, **shared):
        way = rng.random(flight.length.size) * flight.length
        depth = flight.depth + way * flight.direction[2]
        level = np.minimum(depth / LEVEL_STEP, way_up.first.size - 2).astype(np.int64)
        first = way_up.first[level]
        choice = way_up.first[level + 1] - first
        partner = first + (rng.random(way.size) * choice).astype(np.int64)
        partner = np.minimum(partner, way_up.weight.size - 1)
        cosine = -(flight.direction * way_up.direction[:, partner]).sum(axis=0)
        density = np.zeros(way.size)
        for number in np.unique(flight.layer):
            here = (flight.layer == number) & (cosine < np.cos(turn)) & (choice > 0)
            phase = column.layers[number].water.phase_function
            density[here] = phase.density(np.arccos(np.maximum(cosine[here], -1.0)))
        weight = flight.weight * np.exp(-absorption[flight.layer] * way)
        weight *= scattering[flight.layer] * flight.length * density
        weight *= choice * way_up.weight[partner] / count
        some = weight > 0.0
        path = flight.path + way + way_up.path[partner]
        found.append([values[some] for values in (weight, path, depth)])
    return Light(*(np.concatenate(values) for values in zip(*found, strict=True)))

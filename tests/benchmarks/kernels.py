"""How long the engine's kernels take, one by one: where the time of a flash goes.

    python tests/benchmarks/kernels.py [--json]

A figure is the least processor time of some repeats, on one core, after compilation. Whole flashes
at a measured error are told by `bathyflash bench`.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from survey.optics.interface import fresnel_reflectance
from survey.optics.water import WaterColumn, petzold_water
from survey.transport.directions import drawn, turned
from survey.transport.layers import kernel_layers
from survey.transport.random import start_stream, uniform
from survey.transport.tracks import draw_tracks
from survey.transport.waveforms import blurred, pulse_taps
from terrain.generators import Ground, plane
from terrain.kernels import kernel
from terrain.map_frame import MapFrame
from terrain.raycast import SeabedGrid, first_hit

CALLS, REPEATS = 200_000, 5
TRACKS, LEGS = 1024, 10
PIXELS, BINS = 2048, 300
TRIANGLE_SIDE = 1.79  # [m]: 100,000 triangles on 400 x 400 m

Array = NDArray[np.float64]
State = NDArray[np.uint64]


@kernel
def streams(calls: int, state: State) -> float:
    """Begin streams and draw a number from each."""
    total = 0.0
    for i in range(calls):
        start_stream(state, 1, 2, 3, 4, i)
        total += uniform(state)
    return total


@kernel
def numbers(calls: int, state: State) -> float:
    """Draw uniform numbers."""
    total = 0.0
    for _ in range(calls):
        total += uniform(state)
    return total


@kernel
def scatterings(calls: int, sampler: Array, state: State) -> float:
    """Turn a direction again and again by the phase function."""
    dx, dy, dz = 0.0, 0.0, 1.0
    for _ in range(calls):
        bend = drawn(sampler, 1.0, state)
        dx, dy, dz = turned(dx, dy, dz, bend, 6.283 * uniform(state))
    return dz


@kernel
def reflectances(calls: int, state: State) -> float:
    """Reflect from below by Fresnel's law."""
    total = 0.0
    for _ in range(calls):
        total += fresnel_reflectance(uniform(state), 1.34)
    return total


@kernel
def hits(calls: int, grid: SeabedGrid, state: State) -> float:
    """Send slanting rays of 12 m down on the mesh."""
    total = 0.0
    for _ in range(calls):
        x, y = 300.0 * (uniform(state) - 0.5), 300.0 * (uniform(state) - 0.5)
        length, _ = first_hit(grid, x, y, 0.0, 0.28, 0.0, -0.96, 12.0)
        total += length
    return total


def cases() -> Iterator[tuple[str, int, Callable[[], object]]]:
    """Yield what is timed, how often it happens in a call, and the call."""
    state = np.array([3, 5], np.uint64)
    water = petzold_water("coastal", refractive_index=1.34, group_index=1.36)
    layers = kernel_layers(WaterColumn.uniform(water))
    frame = MapFrame(easting=0.0, northing=0.0, epsg=25832, vertical_epsg=5714)
    ground = Ground(map_frame=frame, length=400.0, width=400.0, reflectance=0.1)
    grid = plane(ground=ground, depth=10.0, spacing=TRIANGLE_SIDE).grid
    waveforms, taps = np.zeros((PIXELS, BINS)), pulse_taps(sigma=4.25, width=1.0, pad=20)
    waveforms[:, 60:260] = 1.0
    yield "stream begun, a number", CALLS, lambda: streams(CALLS, state)
    yield "uniform number", CALLS, lambda: numbers(CALLS, state)
    yield "scattering", CALLS, lambda: scatterings(CALLS, layers.samplers[0], state)
    yield "Fresnel reflectance", CALLS, lambda: reflectances(CALLS, state)
    yield (
        "leg of a track",
        TRACKS * LEGS,
        lambda: draw_tracks(layers, 1, TRACKS, LEGS, 10.0, 1.0, 1, 2),
    )
    yield "ray to 100,000 triangles", CALLS, lambda: hits(CALLS, grid, state)
    yield "pulse on a surface echo", PIXELS, lambda: blurred(waveforms, taps)


def measured(*, repeats: int = REPEATS) -> dict[str, float]:
    """Return nanoseconds by name."""
    found = {}
    for name, count, work in cases():
        work()
        spent = []
        for _ in range(repeats):
            start = time.thread_time()
            work()
            spent.append(time.thread_time() - start)
        found[name] = 1e9 * min(spent) / count
    return found


def main() -> None:
    """Print the figures."""
    found = measured()
    if "--json" in sys.argv[1:]:
        print(json.dumps({"nanoseconds": found}, indent=1))
        return
    for name, nanoseconds in found.items():
        print(f"{name:26}{nanoseconds:12.1f} ns")


if __name__ == "__main__":
    main()

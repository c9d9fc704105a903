"""The engine on one uniform water column, defined so that others can compute the same.

The surface is still and index-matched: nothing is reflected there, and light that goes up through
it is gone. No 1/n^2, no receiver factors, no pulse. The source shines straight down, evenly over a
square of 2 x 2 m (`isolated`) or over the whole plane (`flood`); the receiver takes the vertical
radiance, evenly over the same square.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.water import Water
from survey.transport.random import BACKWARD, FORWARD, chance, start_stream
from survey.transport.response_walks import Planes, Tracks, pair_tracks, walk_down
from survey.transport.scene import Medium, forward_medium, restricted_medium
from terrain.kernels import kernel

FloatArray = NDArray[np.float64]
Illumination = Literal["flood", "isolated"]

SIDE = 2.0
BIN = 0.5
GATE = 10e-9
OPTICAL_DEPTH = 8.0
SPLIT_ANGLE = math.radians(30.0)
BATCHES = 64
WALKS_AT_ONCE = 16
BLOCKS_PER_BATCH = 160
ARRIVALS_PER_BATCH = 6000
PAIRINGS = 8
NOWHERE = Planes(first=0.0, spacing=1.0, number=0, longest_path=math.inf)


class ResponseError(ValueError):
    """A water column that cannot answer; a line for each fault."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A number with its standard error."""

    value: float
    sem: float


@dataclass(frozen=True, kw_only=True)
class Response:
    """What a water column sends back.

    Parameters
    ----------
    bin_edges : array (bins + 1,)
        Of half the path length [m].
    column, column_sem : array (bins,)
        Attenuated backscatter of bottomless water, averaged over a bin, and its standard error
        [1/(m sr)]; single scattering alone is b p(180 deg) exp(-2 c z).
    bottom_depth : float
        Depth of the bottom [m].
    two_way : Estimate
        Two-way transmission of light that touched the bottom once: rho / pi times it is the echo.
    two_way_10ns : Estimate
        The part of it within 10 ns of the direct echo.
    mean_excess_path : float
        Mean two-way path beyond 2 z, weighted by light [m].
    blur_radius : float
        Radius around the square's centre that holds half of its two-way light [m].
    """

    bin_edges: FloatArray
    column: FloatArray
    column_sem: FloatArray
    bottom_depth: float
    two_way: Estimate
    two_way_10ns: Estimate
    mean_excess_path: float
    blur_radius: float


def response(
    *, water: Water, illumination: Illumination, bottom_depth: float, seed: int = 1
) -> Response:
    """Return column and bottom of one water, each by 64 independent batches.

    Parameters
    ----------
    water : Water
        Absorbs and scatters; its group index times the 10 ns.
    illumination : {"flood", "isolated"}
    bottom_depth : float
        Above 0 [m].
    seed : int

    Raises
    ------
    ResponseError
        When the water does not scatter or the depth is not positive.
    """
    faults = []
    if not water.scattering > 0.0:
        faults.append("response: scattering must be above 0: without it nothing comes back")
    if not (math.isfinite(bottom_depth) and bottom_depth > 0.0):
        faults.append(f"response: bottom depth {bottom_depth:g} m must be above 0")
    if faults:
        raise ResponseError("\n".join(faults))
    which = ("flood", "isolated").index(illumination)
    column = column_batches(water=water, seed=seed)[:, which]
    bottom = _bottom_batches(water, bottom_depth, which, seed)
    mean, sem = column.mean(axis=0), column.std(axis=0, ddof=1) / BATCHES**0.5
    return Response(
        bin_edges=np.arange(column.shape[1] + 1) * BIN,
        column=mean,
        column_sem=sem,
        bottom_depth=bottom_depth,
        two_way=_estimate(bottom.two_way),
        two_way_10ns=_estimate(bottom.within_gate),
        mean_excess_path=bottom.excess.sum() / bottom.two_way.sum(),
        blur_radius=bottom.blur_radius,
    )


def column_batches(*, water: Water, seed: int) -> FloatArray:
    """Return attenuated backscatter (batches, flood and isolated, bins) [1/(m sr)]."""
    bins = math.ceil(OPTICAL_DEPTH / water.attenuation / BIN)
    deepest = bins * BIN
    spacing = min(0.25 * BIN, 0.25 / water.attenuation)
    planes = math.ceil(deepest / spacing)
    room = WALKS_AT_ONCE * planes * 8
    result = np.zeros((BATCHES, 2, bins))
    forward = forward_medium(water)
    backward = restricted_medium(water, split_angle=SPLIT_ANGLE)
    table = water.phase_function.cosine_table()
    for batch in range(BATCHES):
        crossings = _column_batch(
            result[batch], forward, backward, table, math.cos(SPLIT_ANGLE), water.scattering,
            spacing, planes, 2.0 * deepest, room, seed, batch,
        )  # fmt: skip
        if crossings > room:
            raise RuntimeError(f"response: {crossings} crossings do not fit into {room}")
    return result


@kernel
def _column_batch(
    column: FloatArray,
    forward: Medium,
    backward: Medium,
    table: FloatArray,
    split_cosine: float,
    scattering: float,
    spacing: float,
    number: int,
    longest_path: float,
    room: int,
    seed: int,
    batch: int,
) -> int:
    """Fill ``column`` by blocks of walks, all pairs in each, planes shifted from block to block."""
    state, arrival = np.empty(2, np.uint64), np.empty(4)
    there = Tracks(
        np.empty(number, np.int64), np.empty(room, np.int64), np.empty((room, 7)),
        np.zeros(1, np.int64),
    )  # fmt: skip
    back = Tracks(
        np.empty(number, np.int64), np.empty(room, np.int64), np.empty((room, 7)),
        np.zeros(1, np.int64),
    )  # fmt: skip
    pairs = BLOCKS_PER_BATCH * WALKS_AT_ONCE * WALKS_AT_ONCE
    most = 0
    for block in range(BLOCKS_PER_BATCH):
        planes = Planes((block + 0.5) / BLOCKS_PER_BATCH * spacing, spacing, number, longest_path)
        there.head[:], there.filled[0] = -1, 0
        back.head[:], back.filled[0] = -1, 0
        for i in range(WALKS_AT_ONCE):
            start_stream(state, seed, FORWARD, block, batch, i)
            walk_down(forward, planes, there, arrival, math.inf, state)
            start_stream(state, seed, BACKWARD, block, batch, i)
            walk_down(backward, planes, back, arrival, math.inf, state)
        most = max(most, there.filled[0], back.filled[0])
        factor = scattering * spacing / BIN / pairs
        pair_tracks(column, planes, there, back, table, split_cosine, factor, SIDE, BIN)
    return most


@dataclass(frozen=True, kw_only=True)
class _Bottom:
    two_way: FloatArray
    within_gate: FloatArray
    excess: FloatArray
    blur_radius: float


def _bottom_batches(water: Water, depth: float, which: int, seed: int) -> _Bottom:
    """Pair full walks down and full walks up: one touch of the bottom splits the path."""
    medium = forward_medium(water)
    two_way, within, excess = np.zeros((3, BATCHES))
    radii, lights = [], []
    for batch in range(BATCHES):
        there, back = (
            _arrivals(medium, depth, seed, purpose, batch) for purpose in (FORWARD, BACKWARD)
        )
        draws = chance(seed=seed, purpose=FORWARD, frame=batch)
        for shift in range(1, PAIRINGS + 1):
            met = np.roll(there, shift, axis=0)
            apart = met[:, :2] - back[:, :2]
            overlap = np.prod(np.clip(1.0 - np.abs(apart) / SIDE, 0.0, None), axis=1)
            light = met[:, 3] * back[:, 3] * (overlap if which else 1.0) / PAIRINGS
            late = met[:, 2] + back[:, 2] - 2.0 * depth
            two_way[batch] += light.mean()
            within[batch] += light[late * water.group_index <= GATE * speed_of_light].sum() / len(
                light
            )
            excess[batch] += (light * late).mean()
            start = _starts(apart if which else np.zeros_like(apart), draws)
            radii.append(np.hypot(*(start + back[:, :2]).T))
            lights.append(light)
    return _Bottom(
        two_way=two_way,
        within_gate=within,
        excess=excess,
        blur_radius=_weighted_median(np.concatenate(radii), np.concatenate(lights)),
    )


def _starts(apart: FloatArray, draws: np.random.Generator) -> FloatArray:
    """Draw where in the square a walk back begins, its forward partner beginning there too."""
    low = np.clip(-0.5 * SIDE + apart, -0.5 * SIDE, 0.5 * SIDE)
    high = np.clip(0.5 * SIDE + apart, -0.5 * SIDE, 0.5 * SIDE)
    return np.asarray(low + (high - low) * draws.random(apart.shape))


def _weighted_median(values: FloatArray, weights: FloatArray) -> float:
    order = np.argsort(values)
    reached = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(reached, 0.5 * reached[-1])])


@kernel
def _arrivals(medium: Medium, depth: float, seed: int, purpose: int, batch: int) -> FloatArray:
    """Return x, y, path and weight of walks at the bottom; weight 0 for those that never arrive."""
    state, arrival = np.empty(2, np.uint64), np.zeros((ARRIVALS_PER_BATCH, 4))
    nothing = Tracks(
        np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 7)), np.zeros(1, np.int64)
    )
    for i in range(ARRIVALS_PER_BATCH):
        start_stream(state, seed, purpose, 1 << 20, batch, i)
        walk_down(medium, NOWHERE, nothing, arrival[i], depth, state)
    return arrival


def _estimate(batches: FloatArray) -> Estimate:
    return Estimate(value=float(batches.mean()), sem=float(batches.std(ddof=1) / BATCHES**0.5))

"""What bottomless water sends back to a pixel, by half the path length."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from survey.optics.water import Water
from survey.transport.random import BACKWARD, FORWARD, start_stream
from survey.transport.response_walks import (
    BATCHES,
    Footprint,
    Planes,
    Tracks,
    pair_tracks,
    walk_down,
)
from survey.transport.scene import Medium, forward_medium, restricted_medium
from terrain.kernels import kernel

FloatArray = NDArray[np.float64]

SPLIT_ANGLE = math.radians(30.0)
PLANES_APART = 0.125
OPTICAL_PLANES_APART = 0.25
WALKS_AT_ONCE = 16
BLOCKS_PER_BATCH = 160
CROSSINGS_PER_PLANE = 8


def column_batches(
    *,
    water: Water,
    footprint: Footprint,
    bins: int,
    bin_width: float,
    seed: int,
    split_angle: float = SPLIT_ANGLE,
    blocks: int = BLOCKS_PER_BATCH,
    batches: int = BATCHES,
    threads: int = 1,
) -> FloatArray:
    """Return attenuated backscatter of a flooded and of an isolated pixel, batch by batch.

    It is upward radiance over downward irradiance, both along the vertical, for each metre of half
    the path, averaged over a bin: single scattering alone is b p(180 deg) exp(-2 c z).

    Parameters
    ----------
    water : Water
    footprint : Footprint
        What the isolated pixel lights and sees.
    bins : int
    bin_width : float
        Of half the path length [m].
    seed : int
    split_angle : float
        The last scattering by more than this parts the walks; the result does not depend on it,
        its error does: in turbid water 45 degrees need a sixth of the walks of 30 [rad].
    blocks : int
        Blocks of 16 walks each way in a batch.
    batches : int
        Independent batches, for the standard error.
    threads : int
        Batches at once; they do not change the result.

    Returns
    -------
    array (batches, 2, bins)
        Flood and isolated [1/(m sr)].

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> column_batches(
    ...     water=petzold_water("clear", refractive_index=1.33, group_index=1.33),
    ...     footprint=Footprint(side=2.0, growth=0.0), bins=3, bin_width=0.5, seed=1, blocks=2,
    ...     batches=2).shape
    (2, 2, 3)
    """
    result = np.zeros((batches, 2, bins))
    spacing = min(PLANES_APART, OPTICAL_PLANES_APART / water.attenuation)
    number = math.ceil(bins * bin_width / spacing)
    planes = Planes(first=0.0, spacing=spacing, number=number, longest_path=2.0 * bins * bin_width)
    room = WALKS_AT_ONCE * number * CROSSINGS_PER_PLANE
    forward = forward_medium(water)
    backward = restricted_medium(water, split_angle=split_angle)
    table = water.phase_function.cosine_table()

    def fill(batch: int) -> None:
        crossings = _column_batch(
            result[batch], forward, backward, table, math.cos(split_angle), water.scattering,
            footprint, planes, blocks, bin_width, room, seed, batch,
        )  # fmt: skip
        if crossings > room:
            raise RuntimeError(f"response: {crossings} crossings do not fit into {room}")

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(fill, range(batches)))
    return result


@kernel
def _column_batch(
    column: FloatArray,
    forward: Medium,
    backward: Medium,
    table: FloatArray,
    split_cosine: float,
    scattering: float,
    footprint: Footprint,
    planes: Planes,
    blocks: int,
    bin_width: float,
    room: int,
    seed: int,
    batch: int,
) -> int:
    """Fill ``column`` by blocks of walks, all pairs in each, planes shifted from block to block."""
    state, nowhere, arrivals = np.empty(2, np.uint64), np.empty(0), np.empty((0, 4))
    there = Tracks(
        np.empty(planes.number, np.int64), np.empty(room, np.int64), np.empty((room, 7)),
        np.zeros(1, np.int64),
    )  # fmt: skip
    back = Tracks(
        np.empty(planes.number, np.int64), np.empty(room, np.int64), np.empty((room, 7)),
        np.zeros(1, np.int64),
    )  # fmt: skip
    pairs = blocks * WALKS_AT_ONCE * WALKS_AT_ONCE
    most = 0
    for block in range(blocks):
        first = (block + 0.5) / blocks * planes.spacing
        shifted = Planes(first, planes.spacing, planes.number, planes.longest_path)
        there.head[:], there.filled[0] = -1, 0
        back.head[:], back.filled[0] = -1, 0
        for i in range(WALKS_AT_ONCE):
            start_stream(state, seed, FORWARD, block, batch, i)
            walk_down(forward, shifted, there, arrivals, nowhere, state)
            start_stream(state, seed, BACKWARD, block, batch, i)
            walk_down(backward, shifted, back, arrivals, nowhere, state)
        most = max(most, there.filled[0], back.filled[0])
        factor = scattering * planes.spacing / bin_width / pairs
        pair_tracks(column, shifted, there, back, table, split_cosine, factor, footprint, bin_width)
    return most

"""The echo of a bottom at several depths at once, by how late its light comes."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from survey.optics.water import Water
from survey.transport.random import BACKWARD, FORWARD, start_stream
from survey.transport.response_walks import (
    BATCHES,
    FLOOD,
    ISOLATED,
    Footprint,
    Planes,
    Tracks,
    triangle,
    walk_down,
)
from survey.transport.scene import Medium, forward_medium
from terrain.kernels import kernel

FloatArray = NDArray[np.float64]

NOWHERE = Planes(first=0.0, spacing=1.0, number=0, longest_path=math.inf)
WALKS_PER_BATCH = 4000
PAIRINGS = 12


def echo_batches(
    *,
    water: Water,
    footprint: Footprint,
    depths: FloatArray,
    bins: int,
    bin_width: float,
    seed: int,
    walks: int = WALKS_PER_BATCH,
    batches: int = BATCHES,
    threads: int = 1,
) -> FloatArray:
    """Return the two-way transmission to a bottom at each depth, split by its lateness.

    Light touches the bottom once. Walks that go deeper than a depth are a bottom's at that depth
    where they first reach it, so that one set of walks serves all depths.

    Parameters
    ----------
    water : Water
    footprint : Footprint
        What the isolated pixel lights and sees.
    depths : array (depths,)
        Of the bottom, growing [m].
    bins : int
    bin_width : float
        Of half the path beyond the depth [m]; light that comes after the last bin is left out.
    seed : int
    walks : int
        Walks each way in a batch.
    batches : int
        Independent batches, for the standard error.
    threads : int
        Batches at once; they do not change the result.

    Returns
    -------
    array (batches, 2, depths, bins)
        Flood and isolated; rho / pi times it is radiance over irradiance [1].

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> still = petzold_water("clear", refractive_index=1.33, group_index=1.33, absorption=0.1,
    ...                       scattering=1e-9)
    >>> found = echo_batches(water=still, footprint=Footprint(side=2.0, growth=0.0),
    ...                      depths=np.array([1.0, 5.0]), bins=4, bin_width=0.5, seed=1, walks=50,
    ...                      batches=2)
    >>> found.mean(axis=0)[:, :, 0].round(4).tolist()
    [[0.8187, 0.3679], [0.8187, 0.3679]]
    """
    result = np.zeros((batches, 2, len(depths), bins))
    medium = forward_medium(water)

    def fill(batch: int) -> None:
        there, back = np.zeros((2, walks, len(depths), 4))
        first_arrivals(there, medium, depths, seed, FORWARD, batch)
        first_arrivals(back, medium, depths, seed, BACKWARD, batch)
        _pair(result[batch], there, back, depths, footprint, bin_width)

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(fill, range(batches)))
    return result


@kernel
def first_arrivals(
    arrivals: FloatArray, medium: Medium, depths: FloatArray, seed: int, purpose: int, batch: int
) -> None:
    """Fill ``arrivals`` (walks, depths, 4): x, y, path and weight where walks first reach depths.

    Walks that never arrive leave it as it was.
    """
    state = np.empty(2, np.uint64)
    nothing = Tracks(
        np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 7)), np.zeros(1, np.int64)
    )
    for i in range(arrivals.shape[0]):
        start_stream(state, seed, purpose, 1 << 20, batch, i)
        walk_down(medium, NOWHERE, nothing, arrivals[i], depths, state)


@kernel
def _pair(
    echo: FloatArray,
    there: FloatArray,
    back: FloatArray,
    depths: FloatArray,
    footprint: Footprint,
    bin_width: float,
) -> None:
    """Add to ``echo`` (2, depths, bins) every walk down with some of the walks up."""
    walks = there.shape[0]
    pairings = min(PAIRINGS, walks)
    for k in range(depths.shape[0]):
        side = footprint.side + footprint.growth * depths[k]
        for i in range(walks):
            for shift in range(pairings):
                f, b = there[(i + shift) % walks, k], back[i, k]
                light = f[3] * b[3] / (walks * pairings)
                at = int((0.5 * (f[2] + b[2]) - depths[k]) / bin_width)
                if light > 0.0 and at < echo.shape[2]:
                    echo[FLOOD, k, at] += light
                    overlap = triangle(f[0] - b[0], side) * triangle(f[1] - b[1], side)
                    echo[ISOLATED, k, at] += light * overlap

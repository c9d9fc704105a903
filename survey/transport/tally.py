"""What the light paths of one pixel add up to, and how sure that is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import fused_kernel, inlined_fused_kernel, leaf_kernel

COLUMN, BOTTOM = 0, 1
LEG = (
    "east",
    "north",
    "depth",
    "direction east",
    "direction north",
    "direction up",
    "length",
    "path before",
    "absorbed before",
    "scattered before",
    "weight",
    "sum of 1 / density of its wide turns",
    "path per metre up",
    "deepest before",
)
"""What is noted of a leg; places of a track are relative to where it entered."""

FloatRow = NDArray[np.float32]


class TimeBins(NamedTuple):
    """Evenly spaced bins, named by the first one's early edge."""

    start: float
    width: float
    number: int


class Tally(NamedTuple):
    """Notes of the pixel at work; they are used again for the next.

    ``fine`` (2, bins) are photons of column and bottom, all replicates together; ``coarse``
    (replicates, 2, bins) each replicate's own in bins of ``width`` fine ones. ``down`` (legs, 14)
    are the legs of the track of light, ``back`` those of the walk from the pixel before it touches
    the bottom, `LEG` by column. ``noted[0]`` counts the latter, ``noted[1]`` all scatterings.
    ``taps`` and ``coarse_taps`` are the pulse in both kinds of bins, ``rows`` (3, coarse bins and
    as many as the pulse reaches) room to work.
    """

    bins: TimeBins
    width: int
    fine: NDArray[np.float32]
    coarse: NDArray[np.float32]
    down: NDArray[np.float64]
    back: NDArray[np.float64]
    noted: NDArray[np.int64]
    ledger: NDArray[np.float64]
    taps: NDArray[np.float32]
    coarse_taps: NDArray[np.float32]
    rows: NDArray[np.float32]


@leaf_kernel
def deposit(tally: Tally, origin: int, batch: int, time: float, photons: float) -> None:
    """Share photons between the two bins whose centres enclose a time, which keeps the centroid."""
    bins = tally.bins
    place = (time - bins.start) / bins.width - 0.5
    low = int(np.floor(place))
    if not 0 <= low < bins.number - 1:
        return
    late = photons * (place - low)
    tally.fine[origin, low] += photons - late
    tally.fine[origin, low + 1] += late
    tally.coarse[batch, origin, int(place + 0.5) // tally.width] += photons


@inlined_fused_kernel
def note_leg(
    leg: NDArray[np.float64],
    x: float,
    y: float,
    depth: float,
    dx: float,
    dy: float,
    dz: float,
    length: float,
    path: float,
    absorbed: float,
    scattered: float,
    weight: float,
    turns: float,
    deepest: float,
) -> None:
    """Note a leg in the columns of `LEG`."""
    leg[0], leg[1], leg[2], leg[3], leg[4], leg[5], leg[6] = x, y, depth, dx, dy, dz, length
    leg[7], leg[8], leg[9], leg[10], leg[11] = path, absorbed, scattered, weight, turns
    leg[12], leg[13] = 1.0 / dz, deepest


@leaf_kernel
def clear(tally: Tally) -> None:
    """Make room for another pixel."""
    tally.fine[:] = 0.0
    tally.coarse[:] = 0.0


@leaf_kernel
def lit_bins(tally: Tally, origin: int) -> tuple[int, int]:
    """First bin with photons and the bin after the last; 0, 0 if all is dark."""
    first, last = 0, tally.fine.shape[1]
    while last > 0 and tally.fine[origin, last - 1] == 0.0:
        last -= 1
    while first < last and tally.fine[origin, first] == 0.0:
        first += 1
    return first, last


@fused_kernel
def smear(source: FloatRow, taps: FloatRow, first: int, last: int, target: FloatRow) -> None:
    """Add the lit bins ``first`` to ``last`` of a row to ``target``, each spread over the taps.

    A slice is taken of what a loop runs over: counted from 0, it is done eight bins at a time.
    """
    lit = source[first:last]
    for tap in range(taps.shape[0]):
        share, shifted = taps[tap], target[first + tap :]
        for i in range(last - first):
            shifted[i] += share * lit[i]


@fused_kernel
def add_up(tally: Tally, origin: int, mean: FloatRow) -> None:
    """Write the photons of an origin to its pixel's row, the pulse's width included.

    Four taps at a time, so that the row is read and written less often.
    """
    fine, taps, bins = tally.fine[origin], tally.taps, mean.shape[0]
    first, last = lit_bins(tally, origin)
    mean[:] = 0.0
    fours = taps.shape[0] // 4 * 4
    for tap in range(0, fours, 4):
        t0, t1, t2, t3 = taps[tap], taps[tap + 1], taps[tap + 2], taps[tap + 3]
        low, high = max(first - tap - 3, 0), min(last - tap, bins)
        part, lit = mean[low:], fine[low + tap :]
        f1, f2, f3 = lit[1:], lit[2:], lit[3:]
        for i in range(high - low):
            part[i] += t0 * lit[i] + t1 * f1[i] + t2 * f2[i] + t3 * f3[i]
    for tap in range(fours, taps.shape[0]):
        low, high = max(first - tap, 0), min(last - tap, bins)
        share, part, lit = taps[tap], mean[low:], fine[low + tap :]
        for i in range(high - low):
            part[i] += share * lit[i]
    scale = np.float32(1.0 / tally.coarse.shape[0])
    for i in range(bins):
        mean[i] *= scale


@fused_kernel
def tell_variance(tally: Tally, origin: int, mean: FloatRow, variance: FloatRow) -> None:
    """Write the squared standard error of a pixel's row of ``mean``, the mean of the replicates.

    The relative error is told in coarse bins, within which the pulse makes all fine ones rise and
    fall together, and goes over evenly from the middle of one to the next.
    """
    coarse, taps, width = tally.coarse, tally.coarse_taps, tally.width
    total, squares, one = tally.rows[0], tally.rows[1], tally.rows[2]
    replicates, pad, reach = coarse.shape[0], tally.taps.shape[0] // 2, taps.shape[0]
    first, last = lit_bins(tally, origin)
    first, last = first // width, (last - 1) // width + 1
    tally.rows[:] = 0.0
    for batch in range(replicates):
        one[first : last + reach] = 0.0
        smear(coarse[batch, origin], taps, first, last, one)
        for i in range(first, last + reach):
            total[i] += one[i]
            squares[i] += one[i] * one[i]
    relative, share = one, np.float32(1.0 / replicates)
    relative[:] = 0.0
    scale = np.float32(replicates / (replicates - 1.0))
    for i in range(first, last + reach):
        squared = total[i] * total[i]
        if squared > 0.0:
            relative[i] = max(np.float32(0.0), squares[i] / squared - share) * scale
    variance[:] = 0.0
    per_bin, before = 1.0 / width, (pad + 0.5) / width - 0.5 + reach // 2
    low = max(0, int((first - 1 - before) * width))
    high = min(variance.shape[0], int((last + reach - before) * width) + 1)
    for i in range(low, high):
        place = i * per_bin + before
        at = int(place)
        between = relative[at] + np.float32(place - at) * (relative[at + 1] - relative[at])
        variance[i] = mean[i] * mean[i] * between


@leaf_kernel
def deposit_in(
    histogram: NDArray[np.floating], pixel: int, bins: TimeBins, time: float, photons: float
) -> None:
    """Share photons between two bins of a pixel's row of a histogram, as `deposit` does."""
    place = (time - bins.start) / bins.width - 0.5
    low = int(np.floor(place))
    part = place - low
    if 0 <= low < bins.number:
        histogram[pixel, low] += photons * (1.0 - part)
    if 0 <= low + 1 < bins.number:
        histogram[pixel, low + 1] += photons * part

"""What the light paths of one pixel add up to, and how sure that is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import fused_kernel, inlined_kernel, leaf_kernel

COLUMN, BOTTOM = 0, 1

FloatRow = NDArray[np.float32]


class TimeBins(NamedTuple):
    """Evenly spaced bins, named by the first one's early edge."""

    start: float
    width: float
    number: int


class Tally(NamedTuple):
    """Notes of the pixel at work; they are used again for the next.

    ``fine`` (2, bins) are photons of column and bottom, all replicates together; ``coarse``
    (replicates, 2, bins) each replicate's own in bins of ``width`` fine ones. ``down`` (legs, 7)
    are the legs of the track of light: place relative to where it entered, with the depth,
    direction, length; ``back`` (legs, 10) those of the walk from the pixel before its first turn:
    place, direction, length, path before, path per metre up, absorbed before. ``noted[0]`` counts
    the latter, ``noted[1]`` all scatterings. ``taps`` and ``coarse_taps`` are the pulse in both
    kinds of bins, ``rows`` (3, coarse bins and as many as the pulse reaches) room to work.
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


@inlined_kernel
def note_leg(
    tally: Tally,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
    length: float,
    path: float,
    absorbed: float,
) -> None:
    """Note a leg of the walk from the pixel, while there is room."""
    i = tally.noted[0]
    if i < tally.back.shape[0]:
        leg = tally.back[i]
        leg[0], leg[1], leg[2], leg[3], leg[4], leg[5] = x, y, z, dx, dy, dz
        leg[6], leg[7], leg[8], leg[9] = length, path, 1.0 / dz, absorbed
        tally.noted[0] = i + 1


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
    """Add the lit bins ``first`` to ``last`` of a row to ``target``, each spread over the taps."""
    for tap in range(taps.shape[0]):
        share, shifted = taps[tap], target[tap:]
        for i in range(first, last):
            shifted[i] += share * source[i]


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
        f0, f1, f2, f3 = fine[tap:], fine[tap + 1 :], fine[tap + 2 :], fine[tap + 3 :]
        for i in range(max(first - tap - 3, 0), min(last - tap, bins)):
            mean[i] += t0 * f0[i] + t1 * f1[i] + t2 * f2[i] + t3 * f3[i]
    for tap in range(fours, taps.shape[0]):
        share, shifted = taps[tap], fine[tap:]
        for i in range(max(first - tap, 0), min(last - tap, bins)):
            mean[i] += share * shifted[i]
    scale = np.float32(1.0 / tally.coarse.shape[0])
    for i in range(bins):
        mean[i] *= scale


@leaf_kernel
def tell_variance(tally: Tally, origin: int, mean: FloatRow, variance: FloatRow) -> None:
    """Write the squared standard error of a pixel's row of ``mean``, the mean of the replicates.

    The relative error is told in coarse bins, within which the pulse makes all fine ones rise and
    fall together, and goes over evenly from the middle of one to the next.
    """
    coarse, taps = tally.coarse, tally.coarse_taps
    total, squares, one = tally.rows[0], tally.rows[1], tally.rows[2]
    replicates, pad, reach = coarse.shape[0], tally.taps.shape[0] // 2, taps.shape[0]
    first, last = lit_bins(tally, origin)
    first, last = first // tally.width, (last - 1) // tally.width + 1
    tally.rows[:] = 0.0
    for batch in range(replicates):
        for i in range(first, last + reach):
            one[i] = 0.0
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
    per_bin = 1.0 / tally.width
    for i in range(variance.shape[0]):
        place = (i + pad + 0.5) * per_bin - 0.5 + reach // 2
        low = int(place)
        between = relative[low] + (place - low) * (relative[low + 1] - relative[low])
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

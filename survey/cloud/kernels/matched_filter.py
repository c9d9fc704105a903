"""Loops of the matched filter over pixels and bins; arrays (rows, columns, bins)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import kernel, leaf_kernel

Singles = NDArray[np.float32]
Whole = NDArray[np.int64]
Truths = NDArray[np.bool_]

NONE = -1
ONE = np.float32(1.0)
VALLEY_DEVIATIONS = 5.0  # of the counts above it, which valleys are deep


@leaf_kernel
def _add(total: Singles, part: Singles, weight: np.float32) -> None:
    for i in range(total.shape[0]):
        total[i] += weight * part[i]


@kernel
def filtered(values: Singles, taps: Singles, result: Singles) -> None:
    """Write the sums of ``values`` (pixels, bins), weighted by taps about every bin."""
    bins, half = values.shape[1], taps.shape[0] // 2
    for pixel in range(values.shape[0]):
        total, row = result[pixel], values[pixel]
        total[:] = 0.0
        for tap in range(taps.shape[0]):
            ahead = tap - half
            first, last = max(0, -ahead), min(bins, bins - ahead)
            _add(total[first:last], row[first + ahead : last + ahead], taps[tap])


@kernel
def pooled(
    values: Singles, late: Whole, asked: Truths, step: int, reach: int, result: Singles
) -> None:
    """Add up the pixels around each that is ``asked`` for, at equal time after the surface.

    ``late`` (rows, columns) is the surface's bin, `NONE` where a pixel is left out; ``values`` are
    those of every ``step``-th bin. What lies beyond the ends of the gate is missing from the sum.
    """
    rows, columns, places = values.shape
    for row in range(rows):
        for column in range(columns):
            total = result[row, column]
            total[:] = 0.0
            if late[row, column] == NONE or not asked[row, column]:
                continue
            for r in range(max(0, row - reach), min(rows, row + reach + 1)):
                for c in range(max(0, column - reach), min(columns, column + reach + 1)):
                    if late[r, c] == NONE:
                        continue
                    ahead = int(np.floor((late[r, c] - late[row, column]) / step + 0.5))
                    first, last = max(0, -ahead), min(places, places - ahead)
                    beside = values[r, c]
                    _add(total[first:last], beside[first + ahead : last + ahead], ONE)


@kernel
def scales(
    seen: Singles, expected: Singles, variance: Singles, begin: Whole, step: int,
    lag: int, share: float, doubt: float, scale: Singles, error: Singles,
) -> None:  # fmt: skip
    """Fit, causally, by what the column's light is off, and the variance of that.

    All arrays are of every ``step``-th bin. A place takes part in the fit of the places that lie
    at least ``lag`` later; ``share`` is what it tells that its neighbours do not. Before any has,
    the scale is 1 and off by ``doubt``.
    """
    rows, columns, places = seen.shape
    for row in range(rows):
        for column in range(columns):
            told = 1.0 / doubt**2
            weight, sum_ = told, 0.0
            start = begin[row, column]
            for place in range(places):
                before = place - lag
                if before >= 0 and before * step >= start:
                    mean = expected[row, column, before]
                    off = (seen[row, column, before] - mean) / mean
                    off = min(max(off, -3.0 * doubt), 3.0 * doubt)
                    more = share * mean * mean / variance[row, column, before]
                    weight += more
                    sum_ += more * off
                scale[row, column, place] = 1.0 + sum_ / weight
                error[row, column, place] = 1.0 / weight


@kernel
def excesses(
    seen: Singles, expected: Singles, scale: Singles, threshold: Singles, step: int,
    result: Singles, clipped: Singles,
) -> None:  # fmt: skip
    """Write what is above the fitted column, and the same no higher than the threshold."""
    rows, columns, bins = seen.shape
    for row in range(rows):
        for column in range(columns):
            for bin_ in range(bins):
                place = bin_ // step
                above = seen[row, column, bin_] - (
                    scale[row, column, place] * expected[row, column, bin_]
                )
                result[row, column, bin_] = above
                clipped[row, column, bin_] = min(above, threshold[row, column, place])


@leaf_kernel
def _is_valley(above: np.float32, height: np.float32) -> bool:
    """Tell whether a sum of counts lies far under an earlier one, of that ``height``."""
    return bool(height - above > max(0.5 * height, VALLEY_DEVIATIONS * np.sqrt(height)))


@kernel
def last_peaks(
    excess: Singles, threshold: Singles, own: Singles, least: Singles, begin: Whole,
    asked: Truths, step: int, tail_share: float, tail_bins: int, peak: Whole,
) -> None:  # fmt: skip
    """Write the bin of the last peak (rows, columns) over the thresholds; `NONE` without one.

    A bin fires where ``excess`` reaches ``threshold`` and ``own`` reaches ``least``; a run of bins
    that fire ends where ``excess`` falls under half its threshold, or as far under half its highest
    that chance does not do it: so a valley parts a bottom from a surface brighter than the model's.
    The highest bin of the last run is the peak, unless it is weaker than ``tail_share`` of some up
    to ``tail_bins`` before it: then the highest of those is. A bin on the first bin searched, or on
    a flank of something before it, is no peak: ``excess`` has fallen there since a step earlier,
    within which the scale is one.
    """
    rows, columns, bins = excess.shape
    for row in range(rows):
        for column in range(columns):
            start = begin[row, column]
            best, height = NONE, np.float32(0.0)
            if start == NONE or not asked[row, column]:
                peak[row, column] = NONE
                continue
            place = (bins - 1) // step
            for bin_ in range(bins - 1, start - 1, -1):
                if bin_ < place * step:
                    place -= 1
                above, wanted = excess[row, column, bin_], threshold[row, column, place]
                if best != NONE and (above < 0.5 * wanted or _is_valley(above, height)):
                    break
                strong = above >= wanted and above > height
                if strong and own[row, column, bin_] >= least[row, column, place]:
                    best, height = bin_, above
            if best != NONE:
                least_before = height / tail_share
                for bin_ in range(best - 1, max(start, best - tail_bins), -1):
                    above = excess[row, column, bin_]
                    if above > max(height, least_before) and (
                        above >= excess[row, column, max(start, bin_ - step - 1)]
                    ):
                        best, height = bin_, above
            crest = best > start and (
                excess[row, column, best] >= excess[row, column, max(start, best - step - 1)]
            )
            peak[row, column] = best if crest else NONE


@kernel
def interpolated(
    variance: Singles, first: float, width: float, deviations: NDArray[np.float64], result: Singles
) -> None:
    """Write the threshold of every variance (n,), straight between a table's even logarithms."""
    last = deviations.shape[0] - 2
    for i in range(variance.shape[0]):
        wide = max(float(variance[i]), np.exp(first))
        place = (np.log(wide) - first) / width
        low = min(int(place), last)
        part = place - low
        times = (1.0 - part) * deviations[low] + part * deviations[low + 1]
        result[i] = times * np.sqrt(wide)

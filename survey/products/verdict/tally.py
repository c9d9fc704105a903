"""Errors of bottom points by depth, counted cloud by cloud."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import BOTTOM_CLASSES, PointCloud
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.products.standards import Order

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

BIN = 1.0  # [m] of depth
BINS = 200
ERROR_STEP = 0.005  # [m]
ERROR_STEPS = 1000
ENOUGH = 59
"""Fewest points that can show 95 % with 95 % confidence: 0.95^59 < 0.05 (none outside)."""


def _by_depth() -> IntArray:
    return np.zeros(BINS, dtype=np.int64)


@dataclass(kw_only=True)
class OrderTally:
    """How far bottom points lie from the truth, by true depth, and how many are within each order.

    Vertical errors are measured less true elevation at the measured place, horizontal ones the
    distance from where the pixel truly looks. Points off the known seabed are left out.

    Parameters
    ----------
    orders : sequence of Order
        Whose limits are applied, each at the point's own depth.
    """

    orders: Sequence[Order]
    points: IntArray = field(default_factory=_by_depth)
    false_bottoms: IntArray = field(default_factory=_by_depth)
    error: FloatArray = field(default_factory=lambda: np.zeros(BINS))
    error_squared: FloatArray = field(default_factory=lambda: np.zeros(BINS))
    vertical: IntArray = field(
        default_factory=lambda: np.zeros((BINS, ERROR_STEPS + 1), dtype=np.int64)
    )
    within_tvu: dict[str, IntArray] = field(default_factory=dict)
    within_thu: dict[str, IntArray] = field(default_factory=dict)

    def add(self, cloud: PointCloud, *, water_level: float) -> None:
        """Count the bottom points of a cloud; its water level stands in the vertical datum [m]."""
        known = np.isin(cloud.classification, BOTTOM_CLASSES) & np.isfinite(cloud.true_elevation)
        cloud = cloud.select(known)
        error, aside = errors_of(cloud)
        depth = np.maximum(water_level - cloud.true_elevation, 0.0)
        number = np.minimum((depth / BIN).astype(np.intp), BINS - 1)

        def counted(which: NDArray[np.bool_]) -> IntArray:
            return np.bincount(number[which], minlength=BINS)

        self.points += np.bincount(number, minlength=BINS)
        self.false_bottoms += counted(np.abs(error) > FALSE_BOTTOM_ERROR)
        self.error += np.bincount(number, error, minlength=BINS)
        self.error_squared += np.bincount(number, error**2, minlength=BINS)
        step = np.minimum(np.abs(error) / ERROR_STEP, ERROR_STEPS).astype(np.intp)
        np.add.at(self.vertical, (number, step), 1)
        for order in self.orders:
            tvu = self.within_tvu.setdefault(order.key, _by_depth())
            thu = self.within_thu.setdefault(order.key, _by_depth())
            tvu += counted(np.abs(error) <= order.tvu(depth))
            thu += counted(aside <= order.thu(depth))

    def ranges(self) -> list[tuple[int, int]]:
        """Return the ranges of depth that are judged, see `joined`."""
        return joined(self.points)


def errors_of(cloud: PointCloud) -> tuple[FloatArray, FloatArray]:
    """Return vertical and horizontal errors of points (n,) [m]; nan where the truth is unknown."""
    aside = np.linalg.norm((cloud.position - cloud.truth)[:, :2], axis=1)
    return cloud.position[:, 2] - cloud.true_elevation, aside


def joined(points: IntArray) -> list[tuple[int, int]]:
    """Return ranges of bins (first, one after the last) with enough points each.

    A bin with fewer than `ENOUGH` points is joined to the next deeper ones; what is left at the
    end is joined to the last range.

    Examples
    --------
    >>> joined(np.array([0, 100, 30, 40, 5]))
    [(1, 2), (2, 5)]
    """
    ranges: list[tuple[int, int]] = []
    first, held = 0, 0
    filled = np.flatnonzero(points)
    for number in filled.tolist():
        first = number if held == 0 else first
        held += int(points[number])
        if held >= ENOUGH:
            ranges.append((first, number + 1))
            held = 0
    if held > 0 and ranges:
        ranges[-1] = (ranges[-1][0], int(filled[-1]) + 1)
    elif held > 0:
        ranges.append((first, int(filled[-1]) + 1))
    return ranges


def percentile(histogram: IntArray, share: float) -> float | None:
    """Return the upper edge of the step that a share of the errors does not exceed [m].

    None where that is beyond the histogram's last step.

    Examples
    --------
    >>> percentile(np.bincount([1] * 95 + [7] * 5, minlength=ERROR_STEPS + 1), 0.95)
    0.01
    """
    reached = np.cumsum(histogram) >= share * histogram.sum() - 1e-9
    step = int(np.argmax(reached))
    return None if step >= ERROR_STEPS else round((step + 1) * ERROR_STEP, 6)


def interval(within: int, points: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a share, Clopper and Pearson (1934) [1].

    As if points erred independently; those of one frame do not quite.

    Examples
    --------
    >>> [round(end, 3) for end in interval(59, 59)]
    [0.939, 1.0]
    """
    from scipy.stats import beta

    low = 0.0 if within == 0 else float(beta.ppf(0.025, within, points - within + 1))
    high = 1.0 if within == points else float(beta.ppf(0.975, within + 1, points - within))
    return low, high

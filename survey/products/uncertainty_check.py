"""Whether points lie as near to the truth as their uncertainties say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import BOTTOM_CLASSES, PointCloud
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.flight.pose import Frame

FloatArray = NDArray[np.float64]

DEPTH_BIN = 2.0
MILLIMETRES = 20_001
POINTS_AT_ONCE = 2048
"""Their footprints fit into a processor's cache."""
PLACES = 5
"""Places of a footprint along each side, one anywhere in each of as many strips."""
SPREAD = (0.7548776662, 0.5698402910)
"""Steps of points that fill a square evenly: 1 / p and 1 / p^2 with p^3 = p + 1 (Roberts 2018)."""


class UncertaintyTally:
    """How many true bottom points lie within their uncertainties, part by part.

    Bottom points are classes 40 and 43 that are no false bottoms.

    Parameters
    ----------
    frames : sequence of Frame
        That the points name.
    pixel_tangent : float
        Side of a pixel in the tangent plane [1].
    refractive_index : float
        Of the water [1].
    """

    def __init__(
        self, *, frames: Sequence[Frame], pixel_tangent: float, refractive_index: float
    ) -> None:
        self._frames = {frame.index: frame for frame in frames}
        self._pixel_tangent = pixel_tangent
        self._refractive_index = refractive_index
        self._bins: dict[int, _Held] = {}

    def add(self, bottom: PointCloud) -> None:
        """Take points into account."""
        error = bottom.position[:, 2] - bottom.true_elevation
        right = np.isin(bottom.classification, BOTTOM_CLASSES)
        right &= (np.abs(error) <= FALSE_BOTTOM_ERROR) & np.isfinite(bottom.truth).all(axis=1)
        cloud = bottom.select(right)
        vertical = np.abs(error[right]) <= cloud.tvu
        starts = range(0, len(cloud), POINTS_AT_ONCE)
        parts = (np.arange(start, min(start + POINTS_AT_ONCE, len(cloud))) for start in starts)
        shares = [self._share_within_thu(cloud.select(part)) for part in parts]
        horizontal = np.concatenate([np.zeros(0), *shares])
        bins = np.floor(cloud.depth / DEPTH_BIN).astype(np.int64)
        for one in np.unique(bins).tolist():
            here = bins == one
            self._bins[one] = self._bins.get(one, _Held()) + _Held(
                points=int(here.sum()),
                vertical=float(vertical[here].sum()),
                horizontal=float(horizontal[here].sum()),
                tvu=_histogram(cloud.tvu[here]),
                thu=_histogram(cloud.thu[here]),
            )

    def _share_within_thu(self, cloud: PointCloud) -> FloatArray:
        """Return which share of each point's footprint lies within its uncertainty (n,) [1]."""
        places = footprint_places(
            cloud,
            frames=[self._frames[index] for index in np.unique(cloud.frame).tolist()],
            pixel_tangent=self._pixel_tangent,
            refractive_index=self._refractive_index,
        )
        away = np.hypot(*np.moveaxis(cloud.position[:, None, :2] - places, -1, 0))
        return np.asarray(np.mean(away <= cloud.thu[:, None], axis=1))

    def metrics(self) -> dict[str, Any]:
        """Return plain values; None where there are no points.

        ==========================  ==============================================================
        tvu_median_m, thu_median_m  medians of the uncertainties, to a millimetre
        tvu_coverage                share whose measured less true elevation at the measured place
                                    is within TVU
        thu_coverage                share of all true places, 25 of each point's footprint as it is
                                    seen without scattering, within THU of the measured place
        uncertainty_by_depth        the same by 2 m of measured depth
        ==========================  ==============================================================
        """
        by_depth: list[dict[str, Any]] = [
            {"from_m": DEPTH_BIN * one, "to_m": DEPTH_BIN * (one + 1), "points": held.points}
            | held.metrics()
            for one, held in sorted(self._bins.items())
        ]
        whole = sum(self._bins.values(), start=_Held())
        return whole.metrics() | {"uncertainty_by_depth": by_depth}


def footprint_places(
    cloud: PointCloud, *, frames: Sequence[Frame], pixel_tangent: float, refractive_index: float
) -> FloatArray:
    """Return places (n, 25, 2) evenly over the footprints about the points' true places [m].

    They are 5 x 5 with steps of a fifth of the side, pushed within a step by another part of it for
    each pixel and frame. Not pushed, none would lie in the corners, which are what a radius of
    95 % leaves out of a square.
    """
    number = {frame.index: at for at, frame in enumerate(frames)}
    of_point = np.array([number[index] for index in cloud.frame.tolist()], dtype=np.intp)
    height = np.array([frame.pose.position[2] for frame in frames])[of_point]
    heading = np.array([frame.pose.heading for frame in frames])[of_point]
    in_air = height - cloud.truth[:, 2] - cloud.depth * (1.0 - 1.0 / refractive_index)
    forward = np.column_stack([np.sin(heading), np.cos(heading)])
    right = np.column_stack([np.cos(heading), -np.sin(heading)])
    address = (cloud.frame * 8191.0 + cloud.row * 127.0) + cloud.column
    push = np.outer(address, SPREAD) % 1.0
    strip = np.stack(np.divmod(np.arange(PLACES**2), PLACES), axis=-1)
    along, across = np.moveaxis((strip + push[:, None]) / PLACES - 0.5, -1, 0)[..., None]
    offsets = along * forward[:, None] + across * right[:, None]
    return np.asarray(cloud.truth[:, None, :2] + (pixel_tangent * in_air)[:, None, None] * offsets)


@dataclass(frozen=True, kw_only=True)
class _Held:
    points: int = 0
    vertical: float = 0.0
    horizontal: float = 0.0
    tvu: NDArray[np.int64] = field(default_factory=lambda: np.zeros(MILLIMETRES, np.int64))
    thu: NDArray[np.int64] = field(default_factory=lambda: np.zeros(MILLIMETRES, np.int64))

    def __add__(self, other: _Held) -> _Held:
        return _Held(
            **{one.name: getattr(self, one.name) + getattr(other, one.name) for one in fields(self)}
        )

    def metrics(self) -> dict[str, Any]:
        if self.points == 0:
            return dict.fromkeys(("tvu_median_m", "tvu_coverage", "thu_median_m", "thu_coverage"))
        return {
            "tvu_median_m": _median(self.tvu),
            "tvu_coverage": round(self.vertical / self.points, 4),
            "thu_median_m": _median(self.thu),
            "thu_coverage": round(self.horizontal / self.points, 4),
        }


def _histogram(metres: NDArray[np.float32]) -> NDArray[np.int64]:
    """Return how many values fall into each millimetre; the last holds all above."""
    at = np.clip(np.nan_to_num(metres) * 1000.0, 0, MILLIMETRES - 1).astype(np.int64)
    return np.bincount(at, minlength=MILLIMETRES)


def _median(histogram: NDArray[np.int64]) -> float:
    below = np.cumsum(histogram)
    return int(np.searchsorted(below, 0.5 * below[-1])) / 1000.0

"""Whether points lie as near to the truth as their uncertainties say."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.flight.pose import Frame

FloatArray = NDArray[np.float64]

DEPTH_BIN = 2.0
PLACES = 5
"""Places of a footprint along each side."""


def uncertainty_metrics(
    bottom: PointCloud, *, frames: Sequence[Frame], pixel_tangent: float, refractive_index: float
) -> dict[str, Any]:
    """Return how many true bottom points lie within their uncertainties; None where there are none.

    Bottom points are classes 40 and 43 that are no false bottoms.

    ==========================  ==================================================================
    tvu_median_m, thu_median_m  medians of the uncertainties
    tvu_coverage                share whose measured less true elevation at the measured place is
                                within TVU
    thu_coverage                share of all true places, 5 x 5 of each point's footprint as it is
                                seen without scattering, that lie within THU of the measured place
    uncertainty_by_depth        the same by 2 m of measured depth
    ==========================  ==================================================================

    Parameters
    ----------
    bottom : PointCloud
    frames : sequence of Frame
        That the points name.
    pixel_tangent : float
        Side of a pixel in the tangent plane [1].
    refractive_index : float
        Of the water [1].
    """
    error = bottom.position[:, 2] - bottom.true_elevation
    right = np.isin(bottom.classification, (PointClass.BATHYMETRIC, PointClass.SUBMERGED_OBJECT))
    right &= (np.abs(error) <= FALSE_BOTTOM_ERROR) & np.isfinite(bottom.truth).all(axis=1)
    cloud = bottom.select(right)
    places = footprint_places(
        cloud, frames=frames, pixel_tangent=pixel_tangent, refractive_index=refractive_index
    )
    away = np.hypot(*np.moveaxis(cloud.position[:, None, :2] - places, -1, 0))
    vertical = np.abs(error[right]) <= cloud.tvu
    horizontal = np.mean(away <= cloud.thu[:, None], axis=1)
    bins = np.floor(cloud.depth / DEPTH_BIN)
    by_depth = [
        {"from_m": float(DEPTH_BIN * one), "to_m": float(DEPTH_BIN * (one + 1.0))}
        | {"points": int((bins == one).sum())}
        | _held(cloud, vertical, horizontal, bins == one)
        for one in np.unique(bins)
    ]
    everywhere = np.ones(len(cloud), np.bool_)
    return _held(cloud, vertical, horizontal, everywhere) | {"uncertainty_by_depth": by_depth}


def footprint_places(
    cloud: PointCloud, *, frames: Sequence[Frame], pixel_tangent: float, refractive_index: float
) -> FloatArray:
    """Return places (n, 25, 2) evenly over the footprints about the points' true places [m]."""
    number = {frame.index: at for at, frame in enumerate(frames)}
    of_point = np.array([number[index] for index in cloud.frame.tolist()], dtype=np.intp)
    height = np.array([frame.pose.position[2] for frame in frames])[of_point]
    heading = np.array([frame.pose.heading for frame in frames])[of_point]
    in_air = height - cloud.truth[:, 2] - cloud.depth * (1.0 - 1.0 / refractive_index)
    forward = np.column_stack([np.sin(heading), np.cos(heading)])
    right = np.column_stack([np.cos(heading), -np.sin(heading)])
    steps = (np.arange(PLACES) + 0.5) / PLACES - 0.5
    along, across = (each.ravel()[None, :, None] for each in np.meshgrid(steps, steps))
    offsets = along * forward[:, None] + across * right[:, None]
    return np.asarray(cloud.truth[:, None, :2] + (pixel_tangent * in_air)[:, None, None] * offsets)


def _held(
    cloud: PointCloud, vertical: NDArray[np.bool_], horizontal: FloatArray, which: NDArray[np.bool_]
) -> dict[str, Any]:
    if not which.any():
        return dict.fromkeys(("tvu_median_m", "tvu_coverage", "thu_median_m", "thu_coverage"))
    return {
        "tvu_median_m": round(float(np.median(cloud.tvu[which])), 4),
        "tvu_coverage": round(float(vertical[which].mean()), 4),
        "thu_median_m": round(float(np.median(cloud.thu[which])), 4),
        "thu_coverage": round(float(horizontal[which].mean()), 4),
    }

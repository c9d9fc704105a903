"""The water surface through which the rays of the bottom points were bent: class 42."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from survey.cloud.points import BOTTOM_CLASSES, PointClass, PointCloud
from survey.flight.pose import Frame, measured_positions
from terrain.substrate import UNLABELLED

KEPT = (
    *("true_surface", "true_normal", "surface_elevation", "cause"),
    *("time", "frame", "line", "row", "column"),
)
"""What a derived point has from its bottom point."""


def derived_surface(bottom: PointCloud, frames: Sequence[Frame]) -> PointCloud:
    """Return for every bottom point (40, 43) where its ray was taken to enter the water.

    That is the point of the straight ray from the measured pose at ``surface_elevation``. Truth is
    the true crossing; the point has no echo of its own, hence no counts,
    and no uncertainty.

    Parameters
    ----------
    bottom : PointCloud
    frames : sequence of Frame
        Those that the points name.
    """
    below = np.flatnonzero(np.isin(bottom.classification, BOTTOM_CLASSES))
    kept = {name: getattr(bottom, name).take(below, axis=0) for name in KEPT}
    uncorrected = bottom.uncorrected.take(below, axis=0)
    sensor = measured_positions(frames).take(kept["frame"], axis=0)
    ray = uncorrected - sensor
    fall = sensor[:, 2] - kept["surface_elevation"]
    entry = sensor + ray * (fall / -ray[:, 2])[:, None]
    nothing = np.zeros(len(below), np.float32)
    unknown = np.full(len(below), np.nan, np.float32)
    return PointCloud(
        **kept,
        position=entry,
        uncorrected=entry,
        truth=kept["true_surface"],
        classification=np.full(len(below), PointClass.DERIVED_SURFACE, np.uint8),
        true_classification=np.full(len(below), PointClass.WATER_SURFACE, np.uint8),
        substrate=np.full(len(below), UNLABELLED, np.uint8),
        true_elevation=kept["true_surface"][:, 2],
        water_path=nothing,
        depth=np.zeros(len(below)),
        counts=nothing,
        snr=nothing,
        tvu=unknown,
        thu=unknown,
        reflectance=unknown,
        true_reflectance=unknown,
    )

"""The water surface through which the rays of the bottom points were bent: class 42."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from survey.cloud.points import PointClass, PointCloud
from survey.flight.pose import Frame
from terrain.substrate import UNLABELLED


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
    below = np.isin(bottom.classification, (PointClass.BATHYMETRIC, PointClass.SUBMERGED_OBJECT))
    cloud = bottom.select(below)
    index = {frame.index: number for number, frame in enumerate(frames)}
    sensors = np.array([frame.measured.position for frame in frames]).reshape(-1, 3)
    of_point = np.array([index[number] for number in cloud.frame.tolist()], dtype=np.intp)
    sensor = sensors[of_point]
    ray = cloud.uncorrected - sensor
    fall = sensor[:, 2] - cloud.surface_elevation
    entry = sensor + ray * (fall / -ray[:, 2])[:, None]
    nothing = np.zeros(len(cloud), np.float32)
    unknown = np.full(len(cloud), np.nan, np.float32)
    return replace(
        cloud,
        position=entry,
        uncorrected=entry,
        truth=cloud.true_surface,
        classification=np.full(len(cloud), PointClass.DERIVED_SURFACE, np.uint8),
        true_classification=np.full(len(cloud), PointClass.WATER_SURFACE, np.uint8),
        substrate=np.full(len(cloud), UNLABELLED, np.uint8),
        true_elevation=cloud.true_surface[:, 2],
        water_path=nothing,
        depth=np.zeros(len(cloud)),
        counts=nothing,
        snr=nothing,
        tvu=unknown,
        thu=unknown,
        reflectance=unknown,
        true_reflectance=unknown,
    )

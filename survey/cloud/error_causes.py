"""Which effect truly moved a point most: told with the truth, for those who look for causes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from survey.cloud.georeference import place_in_water
from survey.cloud.points import Cause, PointClass, PointCloud
from survey.cloud.truth import FALSE_BOTTOM_ERROR, TrueTargets
from survey.cloud.uncertainty import Budget, Surroundings
from survey.flight.pose import Pose

FloatArray = NDArray[np.float64]

WITHIN_NOISE = 2.0
"""Standard deviations of counting noise up to which it is the cause of an error along the ray."""


def with_causes(
    cloud: PointCloud,
    *,
    budget: Budget,
    around: Surroundings,
    true_pose: Pose,
    true_level: float,
    targets: TrueTargets,
) -> PointCloud:
    """Return the points of a frame with their true causes of error.

    The error, measured less true place, falls into three parts: what the pose's error moves; what
    the surface's error moves at the true time; and what is left, along the ray. Of the surface's
    part what its level explains is the level's. Along the ray it is counting noise up to two of its
    standard deviations, and beyond that light that was scattered or came from elsewhere.

    Parameters
    ----------
    cloud : PointCloud
    budget : Budget
        Of the survey.
    around : Surroundings
        What the frame measured.
    true_pose : Pose
    true_level : float
        Mean elevation of the water [m].
    targets : TrueTargets
    """
    if len(cloud) == 0:
        return cloud
    pixel, moves = (cloud.row, cloud.column), budget.displacements(cloud, around)
    path = around.line.path.at(pixel)
    straight = place_in_water(path=path, time=targets.time[pixel], group_index=budget.group_index)
    wet = moves.wet[:, None]
    by_pose = -moves.of_other_pose(true_pose)
    by_surface = np.where(wet, straight - targets.position[pixel] - by_pose, 0.0)
    by_level = moves.of_level() * (around.line.level - true_level)
    along = _length(cloud.position - cloud.truth - by_pose - by_surface)
    noise = budget.late(cloud, around) * _length(moves.of_time())
    parts = [_length(by_pose), _length(by_level), _length(by_surface - by_level), along]
    largest = np.nan_to_num(np.stack(parts), nan=0.0).argmax(axis=0)
    on_ray = np.where(along <= WITHIN_NOISE * noise, Cause.RANGE_NOISE, Cause.SCATTERING)
    cause = np.choose(largest, [Cause.NAVIGATION, Cause.WATER_LEVEL, Cause.WAVES, on_ray])
    cause[~(np.abs(cloud.position[:, 2] - cloud.true_elevation) <= FALSE_BOTTOM_ERROR)] = (
        Cause.FALSE_ECHO
    )
    cause[cloud.classification == PointClass.NO_BOTTOM_FOUND] = Cause.NONE
    return replace(cloud, cause=cause.astype(np.uint8))


def _length(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(vectors, axis=-1))

"""Where an error of one quantity moves points that a frame saw: by differences, not by formulas."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from survey.cloud.georeference import (
    bend_at_slopes,
    bend_at_surface,
    pixel_rays,
    place_in_air,
    place_in_water,
)
from survey.flight.navigation import PoseUncertainty
from survey.flight.pose import Frame, Pose
from survey.sensor.camera import Camera

FloatArray = NDArray[np.float64]

STEP = 1e-4  # [m], [rad] or [1]


@dataclass(frozen=True, kw_only=True)
class Displacements:
    """Points of one frame, and the level water over those that are wet.

    Parameters
    ----------
    camera : Camera
    frame : Frame
    row, column : array (n,)
        Pixels of the points.
    time : array (n,)
        Two-way times [s].
    wet : array (n,)
        Which points lie in water.
    level : float
        Elevation of the water [m].
    refractive_index, group_index : float
        Of the water [1].
    """

    camera: Camera
    frame: Frame
    row: NDArray[np.uint16]
    column: NDArray[np.uint16]
    time: FloatArray
    wet: NDArray[np.bool_]
    level: float
    refractive_index: float
    group_index: float

    @cached_property
    def rays(self) -> FloatArray:
        """Unit directions to the points in air (n, 3)."""
        return self._rays(self.frame.measured)

    def of_time(self) -> FloatArray:
        """Return by how much the points (n, 3) move with their two-way time [m/s]."""
        late = self._placed(self.frame.measured, self.level, self.time + STEP * 1e-9)
        return (late - self._here) / (STEP * 1e-9)

    def of_level(self) -> FloatArray:
        """Return by how much they move with the level of the water [1]."""
        return (self._placed(self.frame.measured, self.level + STEP, self.time) - self._here) / STEP

    def of_slopes(self) -> FloatArray:
        """Return by how much they move (2, n, 3) with its slopes towards east and north [m]."""
        position, rays = self.frame.measured.position, self.rays
        length = (self.level - position[2]) / rays[:, 2]

        def bent(slope: FloatArray) -> FloatArray:
            path = bend_at_slopes(
                position=position,
                rays=rays,
                length=length,
                slopes=np.broadcast_to(slope, (len(rays), 2)),
                refractive_index=self.refractive_index,
            )
            return place_in_water(path=path, time=self.time, group_index=self.group_index)

        moved = np.stack([bent(slope) - bent(np.zeros(2)) for slope in STEP * np.eye(2)])
        return np.where(self.wet[:, None], moved / STEP, 0.0)

    def of_pose(self, pose: PoseUncertainty) -> FloatArray:
        """Return where standard errors of the pose move them (9, n, 3) [m]."""
        measured = self.frame.measured
        moved = [
            self.of_other_pose(replace(measured, position=measured.position + error))
            for error in np.concatenate([pose.position_errors, pose.lever_errors(measured)]) * STEP
        ]
        moved += [
            self.of_other_pose(replace(measured, **{name: getattr(measured, name) + STEP * error}))
            for name, error in pose.attitude_errors.items()
        ]
        return np.stack(moved) / STEP

    def of_other_pose(self, pose: Pose) -> FloatArray:
        """Return where the points (n, 3) move when the pose is another one [m].

        The level of the water is told by the first echoes: it goes with their mean.
        """
        rise = pose.position[2] - self.frame.measured.position[2]
        reach = (self.level - self.frame.measured.position[2]) / self.rays[:, 2]
        rise += float(np.mean((self._rays(pose) - self.rays)[:, 2] * reach))
        return self._placed(pose, self.level + rise, self.time) - self._here

    @cached_property
    def _here(self) -> FloatArray:
        return self._placed(self.frame.measured, self.level, self.time)

    def _rays(self, pose: Pose) -> FloatArray:
        return pixel_rays(camera=self.camera, pose=pose)[self.row, self.column]

    def _placed(self, pose: Pose, level: float, time: FloatArray) -> FloatArray:
        rays = self._rays(pose)
        path = bend_at_surface(
            position=pose.position, rays=rays, level=level, refractive_index=self.refractive_index
        )
        return np.where(
            self.wet[:, None],
            place_in_water(path=path, time=time, group_index=self.group_index),
            place_in_air(position=pose.position, rays=rays, time=time),
        )

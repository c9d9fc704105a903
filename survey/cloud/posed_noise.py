"""The noise model for a sensor that is not level: what it expects moves with the attitude."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.georeference import pixel_rays
from survey.cloud.noise import NoiseModel
from survey.flight.pose import Pose
from survey.sensor.camera import Camera

FloatArray = NDArray[np.float64]

UNMOVED_BINS = 0.02


@dataclass(frozen=True, kw_only=True)
class PosedNoise:
    """A noise model of level flight, and what it becomes at other poses.

    A tilted pixel meets the water later or sooner, and looks at it from another angle. Its column
    is that of the same pixel, moved in time; its surface echo is that of the level pixel that
    looks nearest to the same way, moved in time, and at the rim that of the rim, which is
    stronger where it matters. Both go with the inverse square of the height. Left out are the
    angle's small effect on the column and the heading's on the surface.

    Parameters
    ----------
    level : NoiseModel
        At the level pose.
    pose : Pose
        The level pose.
    camera : Camera
        Whose pixels they are.
    water_level : float
        Expected elevation of the water [m].
    surface, column : array (rows, columns, bins)
        Expected photo-electrons of the surface echo and of the water under it, level.
    variance : array (rows, columns, bins)
        Squared Monte Carlo error of a flash.
    build : callable
        From light, without sun and darkness, and variance to a noise model.
    """

    level: NoiseModel
    pose: Pose
    camera: Camera
    water_level: float
    surface: FloatArray
    column: FloatArray
    variance: FloatArray
    build: Callable[[FloatArray, FloatArray], NoiseModel]

    def at(self, pose: Pose) -> NoiseModel:
        """Return the noise model at a pose; the level one where no echo moves by 1/50 of a bin."""
        late = self.surface_time(pose) - self.surface_time(self.pose)
        if np.abs(late).max() < UNMOVED_BINS * self.level.bin_width:
            return self.level
        row, column = self._alike(pose)
        delay = (self.surface_time(pose) - self.surface_time(self.pose)[row, column], late)
        width = self.level.bin_width
        nearer = (self._height(self.pose) / self._height(pose)) ** 2
        light = nearer * (
            delayed(self.surface[row, column], delay[0] / width)
            + delayed(self.column, delay[1] / width)
        )
        variance = nearer**2 * delayed(self.variance, late / width)
        walk = np.broadcast_to(self.level.surface_walk, self.camera.shape)[row, column]
        noise = self.build(light, variance)
        return replace(noise, surface_walk=walk)

    def _height(self, pose: Pose) -> float:
        return float(pose.position[2] - self.water_level)

    def surface_time(self, pose: Pose) -> FloatArray:
        """Return the two-way times to the level water (rows, columns) [s]."""
        rays = pixel_rays(camera=self.camera, pose=pose)
        return np.asarray(2.0 * self._height(pose) / -rays[..., 2] / speed_of_light)

    def _alike(self, pose: Pose) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return row and column of the level pixels that look nearest to the same way."""
        straight = replace(self.pose, heading=pose.heading).body_to_map()
        body = pixel_rays(camera=self.camera, pose=pose) @ straight
        return self.camera.nearest_pixel(body[..., 0] / body[..., 2], body[..., 1] / body[..., 2])


def delayed(light: FloatArray, bins: FloatArray) -> FloatArray:
    """Return light (rows, columns, bins) that comes so many bins (rows, columns) later.

    Straight between bins; before the first bin and after the last the light stays as it is there.

    Examples
    --------
    >>> delayed(np.array([[[0.0, 4.0, 8.0, 8.0]]]), np.array([[0.5]])).tolist()
    [[[0.0, 2.0, 6.0, 8.0]]]
    """
    last = light.shape[-1] - 1
    whole = np.floor(bins)
    part = (bins - whole)[..., None]
    place = np.arange(last + 1) - whole.astype(np.int64)[..., None]
    here = np.take_along_axis(light, np.clip(place, 0, last), -1)
    before = np.take_along_axis(light, np.clip(place - 1, 0, last), -1)
    return np.asarray((1.0 - part) * here + part * before)

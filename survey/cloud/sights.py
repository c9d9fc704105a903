"""How points came to be: from where, which way and how far, so that they can be placed anew."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.georeference import bend_at_surface, place_in_water
from survey.cloud.points import PointClass, PointCloud
from survey.flight.navigation import Mounting
from survey.flight.pose import Frame, turned

FloatArray = NDArray[np.float64]
IN_WATER = (PointClass.BATHYMETRIC, PointClass.SUBMERGED_OBJECT)


@dataclass(frozen=True, kw_only=True)
class Sights:
    """Looks of n points by the measured pose.

    Parameters
    ----------
    sensor : array (n, 3)
        Where the sensor was [m].
    to_map : array (n, 3, 3)
        From (forward, right, down) to (east, north, up).
    ray : array (n, 3)
        Unit direction of the pixel: forward, right, down.
    length : array (n,)
        Way of the echo at the speed of light in air, one way [m].
    level : array (n,)
        Elevation of the water that the ray goes through [m]; nan where it goes through none.
    """

    sensor: FloatArray
    to_map: FloatArray
    ray: FloatArray
    length: FloatArray
    level: FloatArray

    def select(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> Sights:
        """Return the looks that a mask or an index array names."""
        return Sights(**{name: column[which] for name, column in vars(self).items()})


def sights_of(cloud: PointCloud, frames: Mapping[int, Frame]) -> Sights:
    """Return how the points of a cloud came to be, by the measured poses of their frames."""
    numbers, of_point = np.unique(cloud.frame, return_inverse=True)
    poses = [frames[int(number)].measured for number in numbers]
    sensor = np.array([pose.position for pose in poses]).reshape(-1, 3)[of_point]
    to_map = np.array([pose.body_to_map() for pose in poses]).reshape(-1, 3, 3)[of_point]
    way = cloud.uncorrected - sensor
    length = np.linalg.norm(way, axis=1)
    wet = np.isin(cloud.classification, IN_WATER)
    return Sights(
        sensor=sensor,
        to_map=to_map,
        ray=np.einsum("nij,ni->nj", to_map, way / length[:, None]),
        length=length,
        level=np.where(wet, cloud.position[:, 2] + cloud.depth, np.nan),
    )


@dataclass(frozen=True, kw_only=True)
class Places:
    """Where looks lead to.

    Parameters
    ----------
    position, straight : array (n, 3)
        Through the water, and along the straight ray in air [m].
    level : array (n,)
        Elevation of the water [m]; nan where the ray goes through none.
    """

    position: FloatArray
    straight: FloatArray
    level: FloatArray


def placed(
    sights: Sights, *, mounting: Mounting, refractive_index: float, group_index: float
) -> Places:
    """Return where looks lead to when the sensor sits otherwise in its measured pose.

    The level of the water was measured from the sensor, so that it rises with a lever arm; a turn
    leaves it, since it is the median over a frame.

    Parameters
    ----------
    sights : Sights
    mounting : Mounting
        How the sensor truly sits against the pose that was measured.
    refractive_index, group_index : float
        Of the water [1].

    Examples
    --------
    A roll of 0.1 degrees moves the point under a sensor 200 m up by 0.35 m to the left.

    >>> down = Sights(sensor=np.array([[0.0, 0.0, 200.0]]), ray=np.array([[0.0, 0.0, 1.0]]),
    ...     to_map=np.array([[[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]]),
    ...     length=np.array([200.0]), level=np.array([np.nan]))
    >>> found = placed(down, mounting=Mounting(roll=np.radians(0.1)), refractive_index=1.34,
    ...     group_index=1.36)
    >>> found.position.round(3).tolist()
    [[-0.349, 0.0, 0.0]]
    """
    boresight = turned(roll=mounting.roll, pitch=mounting.pitch, yaw=mounting.heading)
    lever = sights.to_map @ np.array(mounting.lever_arm)
    sensor = sights.sensor + lever
    rays = np.einsum("nij,jk,nk->ni", sights.to_map, boresight, sights.ray)
    level = sights.level + lever[:, 2]
    path = bend_at_surface(
        position=sensor, rays=rays, level=level, refractive_index=refractive_index
    )
    time = 2.0 * sights.length / speed_of_light
    wet = place_in_water(path=path, time=time, group_index=group_index)
    straight = sensor + rays * sights.length[:, None]
    position = np.where(np.isfinite(level)[:, None], wet, straight)
    return Places(position=position, straight=straight, level=level)


def moved(
    cloud: PointCloud,
    frames: Mapping[int, Frame],
    *,
    mounting: Mounting,
    shift: FloatArray,
    refractive_index: float,
    group_index: float,
) -> PointCloud:
    """Return a cloud whose sensor sits otherwise and whose points are then shifted (n, 3) [m].

    What the cloud knows beyond a level surface and a straight ray (waves, corrected biases) stays:
    only the difference of both placings is added. `true_elevation` is that of the old place.
    """
    if len(cloud) == 0:
        return cloud
    sights = sights_of(cloud, frames)
    old, new = (
        placed(sights, mounting=how, refractive_index=refractive_index, group_index=group_index)
        for how in (Mounting(), mounting)
    )
    position = cloud.position + (new.position - old.position) + shift
    level = new.level + shift[:, 2]
    depth = np.where(np.isfinite(level), level - position[:, 2], cloud.depth)
    return replace(
        cloud,
        position=position,
        uncorrected=cloud.uncorrected + (new.straight - old.straight) + shift,
        depth=depth,
    )

"""From a pixel and a time to a place: straight through air, bent and slowed in water."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.flight.pose import Pose
from survey.sensor.camera import Camera

if TYPE_CHECKING:
    from terrain.waves import WaveLattice

FloatArray = NDArray[np.float64]


def pixel_rays(*, camera: Camera, pose: Pose) -> FloatArray:
    """Return the unit directions of the pixel centres on the map (rows, columns, 3)."""
    forward, right = camera.pixel_centres()
    body = np.stack([forward, right, np.ones_like(forward)], axis=-1)
    body /= np.linalg.norm(body, axis=-1, keepdims=True)
    return np.asarray(body @ pose.body_to_map().T)


@dataclass(frozen=True, kw_only=True)
class WaterPath:
    """Where rays enter the water and how they go on.

    Parameters
    ----------
    entry : array (..., 3)
        Where each ray meets the surface [m].
    normal : array (..., 3)
        Unit normal of the surface there, upwards.
    air_time : array (...)
        Two-way time to it [s].
    direction : array (..., 3)
        Unit direction in the water.
    """

    entry: FloatArray
    normal: FloatArray
    air_time: FloatArray
    direction: FloatArray

    def at(self, which: Any) -> WaterPath:
        """Return the paths of some rays, by any index of arrays."""
        return WaterPath(**{one.name: getattr(self, one.name)[which] for one in fields(self)})


def bend_at_surface(
    *, position: FloatArray, rays: FloatArray, level: float | FloatArray, refractive_index: float
) -> WaterPath:
    """Refract downward rays at a level surface by Snell's law.

    Parameters
    ----------
    position : array (3,) or (..., 3)
        Where the rays start [m].
    rays : array (..., 3)
        Unit directions.
    level : float or array (...)
        Elevation of the surface [m].
    refractive_index : float
        Phase index of the water [1].

    Examples
    --------
    >>> path = bend_at_surface(position=np.array([0.0, 0.0, 200.0]),
    ...     rays=np.array([0.6, 0.0, -0.8]), level=0.0, refractive_index=1.2)
    >>> path.entry.tolist(), [round(value, 3) for value in path.direction.tolist()]
    ([150.0, 0.0, 0.0], [0.5, 0.0, -0.866])
    """
    length = (level - position[..., 2]) / rays[..., 2]
    entry = position + rays * length[..., None]
    direction = rays / refractive_index
    direction[..., 2] = -np.sqrt(1.0 - np.sum(direction[..., :2] ** 2, axis=-1))
    return WaterPath(
        entry=entry,
        normal=np.broadcast_to([0.0, 0.0, 1.0], entry.shape),
        air_time=2.0 * length / speed_of_light,
        direction=direction,
    )


def bend_at_waves(
    *, position: FloatArray, rays: FloatArray, waves: WaveLattice, refractive_index: float
) -> WaterPath:
    """Refract downward rays (..., 3) from a position (3,) [m] where they meet resolved waves.

    By Snell's law at the slope of the waves there, without the roughness on them.
    """
    from terrain.waves.lattice import meetings

    length, slopes = meetings(waves, position, rays.reshape(-1, 3))
    return bend_at_slopes(
        position=position,
        rays=rays,
        length=length.reshape(rays.shape[:-1]),
        slopes=slopes.reshape(*rays.shape[:-1], 2),
        refractive_index=refractive_index,
    )


def bend_at_slopes(
    *,
    position: FloatArray,
    rays: FloatArray,
    length: FloatArray,
    slopes: FloatArray,
    refractive_index: float,
) -> WaterPath:
    """Refract rays (..., 3) from a position [m] by Snell's law at a known length and slope.

    Parameters
    ----------
    position : array (3,) or (..., 3)
    rays : array (..., 3)
        Unit directions.
    length : array (...)
        From the position to the water [m].
    slopes : array (..., 2)
        Of the water there towards east and north [1].
    refractive_index : float
        Phase index of the water [1].
    """
    normal = np.concatenate([-slopes, np.ones_like(slopes[..., :1])], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    cosine = -np.sum(rays * normal, axis=-1)
    below = np.sqrt(1.0 - (1.0 - cosine**2) / refractive_index**2)
    return WaterPath(
        entry=position + rays * length[..., None],
        normal=normal,
        air_time=2.0 * length / speed_of_light,
        direction=rays / refractive_index + (cosine / refractive_index - below)[..., None] * normal,
    )


def place_in_air(*, position: FloatArray, rays: FloatArray, time: FloatArray) -> FloatArray:
    """Return places (..., 3) of two-way times [s] along straight rays at the speed in air."""
    return position + rays * (0.5 * speed_of_light * time)[..., None]


def place_in_water(*, path: WaterPath, time: FloatArray, group_index: float) -> FloatArray:
    """Return places (..., 3) of two-way times [s] along refracted rays at the group speed."""
    length = 0.5 * speed_of_light / group_index * (time - path.air_time)
    return path.entry + path.direction * length[..., None]


def depth_of(*, time: float, group_index: float) -> float:
    """Return the depth under the surface of a two-way time after it, straight down [m].

    Examples
    --------
    >>> round(depth_of(time=10e-9, group_index=1.36), 3)
    1.102
    """
    return 0.5 * speed_of_light / group_index * time

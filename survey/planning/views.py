"""What every frame sees of the water surface and of the seabed: outlines on the map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from survey.cloud.georeference import bend_at_surface
from survey.flight.pose import Frame
from survey.flight.trajectory import FieldOfView
from terrain.raycast import SeabedGrid, cast_rays

FloatArray = NDArray[np.float64]

SAMPLES_ON_EDGE = 8
FRAMES_AT_ONCE = 2000


class Ground(Protocol):
    """A surface that rays from the sensor meet."""

    def meets(self, origins: FloatArray, rays: FloatArray) -> FloatArray:
        """Return where unit rays (n, 3) from places (n, 3) meet it (n, 3); nan where nowhere."""


@dataclass(frozen=True, kw_only=True)
class WaterSurface:
    """The level sea at an elevation [m]."""

    level: float

    def meets(self, origins: FloatArray, rays: FloatArray) -> FloatArray:
        """Return where the rays come down on it."""
        length = (self.level - origins[:, 2]) / rays[:, 2]
        return np.asarray(origins + rays * length[:, None])


@dataclass(frozen=True, kw_only=True)
class UnderWater:
    """The seabed under a level sea, and land where it stands out of it.

    Parameters
    ----------
    grid : SeabedGrid
    level : float
        Elevation of the sea [m].
    refractive_index : float
        Of the water; 1 stands for the straight rays of [Lisenko2017] [1].
    """

    grid: SeabedGrid
    level: float
    refractive_index: float

    def meets(self, origins: FloatArray, rays: FloatArray) -> FloatArray:
        """Return where the rays come down, bent by Snell's law at the surface."""
        path = bend_at_surface(
            position=origins, rays=rays, level=self.level, refractive_index=self.refractive_index
        )
        to_water = np.linalg.norm(path.entry - origins, axis=1)
        on_land, _ = cast_rays(self.grid, origins, rays, to_water)
        in_water, _ = cast_rays(self.grid, path.entry, path.direction)
        dry = np.isfinite(on_land)
        in_water[np.isinf(in_water)] = np.nan
        on_bed = path.entry + path.direction * in_water[:, None]
        above = origins + rays * np.where(dry, on_land, 0.0)[:, None]
        return np.where(dry[:, None], above, on_bed)


@dataclass(frozen=True, kw_only=True)
class Views:
    """What frames see.

    Parameters
    ----------
    outline : array (frames, corners, 3)
        Around the view, in the local frame [m]; nan where there is no ground.
    centre : array (frames, 3)
        Where the boresight meets the ground [m].
    """

    outline: FloatArray
    centre: FloatArray

    def polygons(self) -> list[FloatArray]:
        """Return the outlines (corners, 2) that have an inside [m]."""
        rings = (ring[np.isfinite(ring).all(axis=1), :2] for ring in self.outline)
        return [ring for ring in rings if len(ring) >= 3]

    def areas(self) -> FloatArray:
        """Return the area of each view (frames,) [m2]; nan where it is not whole."""
        x, y = self.outline[..., 0], self.outline[..., 1]
        return np.asarray(
            0.5 * np.abs(np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1))
        )


def views(camera: FieldOfView, frames: Sequence[Frame], ground: Ground) -> Views:
    """Return what frames see of a ground.

    Examples
    --------
    >>> from survey.flight.pose import Pose
    >>> from survey.sensor.camera import Camera
    >>> camera = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
    >>> above = Pose(position=np.array([0.0, 0.0, 200.0]), roll=0.0, pitch=0.0, heading=0.0)
    >>> seen = views(camera, [Frame(index=0, line=0, time=0.0, pose=above)],
    ...              WaterSurface(level=0.0))
    >>> round(float(seen.areas()[0]), 3)  # 102.4 x 51.2 m
    5242.88
    """
    body = _rays_in_body(camera)
    parts = [
        _seen(body, frames[first : first + FRAMES_AT_ONCE], ground)
        for first in range(0, len(frames), FRAMES_AT_ONCE)
    ]
    places = np.concatenate(parts)
    return Views(outline=places[:, 1:], centre=places[:, 0])


def _seen(body: FloatArray, frames: Sequence[Frame], ground: Ground) -> FloatArray:
    turns = np.stack([frame.pose.body_to_map() for frame in frames])
    rays = np.einsum("fij,rj->fri", turns, body)
    positions = np.stack([frame.pose.position for frame in frames])
    origins = np.broadcast_to(positions[:, None], rays.shape)
    places = ground.meets(np.array(origins.reshape(-1, 3)), rays.reshape(-1, 3))
    return places.reshape(rays.shape)


def _rays_in_body(camera: FieldOfView) -> FloatArray:
    """Return the boresight and rays around the view from its forward left corner (n, 3)."""
    forward, right = camera.half_tangents
    corners = np.array([[forward, -right], [forward, right], [-forward, right], [-forward, -right]])
    step = np.arange(SAMPLES_ON_EDGE)[:, None] / SAMPLES_ON_EDGE
    edges = [
        here + step * (there - here)
        for here, there in zip(corners, np.roll(corners, -1, axis=0), strict=True)
    ]
    tangents = np.concatenate([np.zeros((1, 2)), *edges])
    rays = np.column_stack([tangents, np.ones(len(tangents))])
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))

"""How far a point may be off: total vertical and horizontal uncertainty, 95 %.

Each effect is one or more vectors (n, 3): where its error of one standard deviation moves the
points [m]. Effects are independent, so their covariances, products of these vectors, add up. TVU
bounds the measured less the true elevation at the measured place: what moves a point sideways by h
over a bed of slope g counts there with -g h. THU bounds the horizontal distance from the measured
place to any place of the pixel's footprint as it is seen without scattering: how far a point was
moved to where scattered light was reflected counts there as an error.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.displacements import Displacements
from survey.cloud.echo import Echo
from survey.cloud.frame_points import WaterLine
from survey.cloud.local_surface import fitted_planes
from survey.cloud.points import Cause, PointClass, PointCloud
from survey.cloud.radius import radius_95
from survey.cloud.scattering import Scattering, off_nadir
from survey.cloud.wave_statistics import Unknown
from survey.flight.navigation import PoseUncertainty
from survey.flight.pose import Frame
from survey.sensor.camera import Camera

FloatArray = NDArray[np.float64]
Effects = Mapping[Cause, FloatArray]

WITHIN_95 = 1.95996
MEDIAN_OVER_MEAN = 1.2533
"""Standard error of a median over that of a mean, Gaussian errors: sqrt(pi / 2)."""
WATER_KNOWN = 0.1
"""Assumed: a survey knows its water's scattering to 10 %, and so what it corrects by it."""
BRIGHTNESS_KNOWN = 0.25
"""Assumed relative error of the reflectance that counts tell."""
OF_A_PIXEL = (Cause.RANGE_NOISE, Cause.SCATTERING, Cause.FALSE_ECHO, Cause.WAVES)
FULL_WIDTH = 2.3548
"""Gate over the pulse's standard deviation: the width at half of the maximum."""
MERGING_GATES = 1.5
NEIGHBOURHOOD = 1.5
"""Width of the planes that tell slope and relief of the bed, as in `fitted_planes` [pixels]."""


@dataclass(frozen=True, kw_only=True)
class Surroundings:
    """What a frame says beside its points.

    Parameters
    ----------
    frame : Frame
    rays : array (rows, columns, 3)
        Unit directions by the measured pose.
    line : WaterLine
        The water's level.
    unknown : Unknown
        What is not known of the water where a ray meets it.
    scattering : Scattering
        What has been corrected.
    first, bottom : Echo
        Of each pixel.
    """

    frame: Frame
    rays: FloatArray
    line: WaterLine
    unknown: Unknown
    scattering: Scattering
    first: Echo
    bottom: Echo


@dataclass(frozen=True, kw_only=True)
class Budget:
    """What a survey knows of the errors of its points.

    Parameters
    ----------
    camera : Camera
    pulse_sigma : float
        Standard deviation of the pulse as the detector sees it [s].
    refractive_index, group_index : float
        Of the water [1].
    pose : PoseUncertainty
        Of navigation, boresight and lever arm.
    level_error : float
        Standard deviation of the water level where no echoes tell it [m].
    """

    camera: Camera
    pulse_sigma: float
    refractive_index: float
    group_index: float
    pose: PoseUncertainty
    level_error: float

    def applied(
        self, cloud: PointCloud, around: Surroundings, *, bed: PointCloud | None = None
    ) -> PointCloud:
        """Return the points of a frame with their uncertainties.

        ``bed`` are the points of the frame that show slope and relief: those of the cloud itself
        unless told.
        """
        if len(cloud) == 0:
            return cloud
        effects = self.effects(cloud, around)
        shown, pixel = cloud if bed is None else bed, (cloud.row, cloud.column)
        slope, roughness = (part[pixel] for part in _bed(shown, around.rays.shape[:2]))
        effects[Cause.RELIEF] = _hidden_relief(roughness, effects)
        vectors = np.concatenate(list(effects.values()))
        vertical = vectors[..., 2] - np.sum(vectors[..., :2] * slope, axis=-1)
        sideways = np.concatenate([vectors, _moved(cloud, around)])[..., :2]
        covariance = np.einsum("kni,knj->nij", sideways, sideways)
        placed = cloud.classification != PointClass.NO_BOTTOM_FOUND
        tvu = WITHIN_95 * np.sqrt(np.sum(vertical**2, axis=0))
        thu = radius_95(covariance=covariance, half_side=self._half_pixel(cloud, around))
        return replace(
            cloud,
            tvu=np.where(placed, tvu, np.nan).astype(np.float32),
            thu=np.where(placed, thu, np.nan).astype(np.float32),
        )

    def effects(self, cloud: PointCloud, around: Surroundings) -> dict[Cause, FloatArray]:
        """Return the vectors (k, n, 3) of each effect but relief."""
        wet, moves = cloud.depth > 0.0, self.displacements(cloud, around)
        late = self.late(cloud, around)
        height, tilt = moves.of_level(), moves.of_slopes()
        return {
            Cause.RANGE_NOISE: (moves.of_time() * late[:, None])[None],
            Cause.SCATTERING: self._scattering(cloud, around, moves.rays) * wet[:, None],
            Cause.FALSE_ECHO: self._merged(cloud),
            Cause.WAVES: np.concatenate(
                [tilt * around.unknown.slope, height[None] * around.unknown.height]
            ),
            Cause.NAVIGATION: moves.of_pose(self.pose),
            Cause.WATER_LEVEL: height[None] * self._level_error(around.line),
        }

    def displacements(self, cloud: PointCloud, around: Surroundings) -> Displacements:
        """Return where errors move the points of a frame."""
        return Displacements(
            camera=self.camera,
            frame=around.frame,
            row=cloud.row,
            column=cloud.column,
            time=cloud.time - around.frame.time,
            wet=cloud.depth > 0.0,
            level=around.line.level,
            refractive_index=self.refractive_index,
            group_index=self.group_index,
        )

    def late(self, cloud: PointCloud, around: Surroundings) -> FloatArray:
        """Return the standard deviation of the points' times by the chance of counts (n,) [s]."""
        pixel, wet = (cloud.row, cloud.column), cloud.depth > 0.0
        return np.where(wet, around.bottom.time_error[pixel], around.first.time_error[pixel])

    def _merged(self, cloud: PointCloud) -> FloatArray:
        """Return the vectors (1, n, 3) of bottoms whose echoes may be merged with the surface's.

        The search begins a gate after the surface, and its gate reaches half of one back. A bottom
        that is told nearer than that may lie anywhere up to the surface: a uniform error.
        """
        gate = FULL_WIDTH * self.pulse_sigma * 0.5 * speed_of_light / self.group_index
        near = (cloud.depth > 0.0) & (cloud.depth < MERGING_GATES * gate)
        vectors = np.zeros((1, len(cloud), 3))
        vectors[0, :, 2] = np.where(near, cloud.depth, 0.0) / np.sqrt(12.0)
        return vectors

    def _scattering(self, cloud: PointCloud, around: Surroundings, rays: FloatArray) -> FloatArray:
        """Return what scattering's errors leave.

        A residual, a part of what was corrected, and what an error of the brightness does.
        """
        table, depth = around.scattering, cloud.depth
        height = around.frame.measured.position[2] - around.line.level
        edge = self.camera.edge_distances(height=height)[cloud.row, cloud.column]
        corrected = table.elevation_error(depth=depth, tangent=off_nadir(rays), edge=edge)
        by_brightness = [
            table.error_by_brightness(depth=depth, reflectance=each * cloud.reflectance)
            for each in (1.0, 1.0 + BRIGHTNESS_KNOWN)
        ]
        vectors = np.zeros((4, len(cloud), 3))
        vectors[0, :, 2] = table.at("residual", depth)
        vectors[1, :, 2] = WATER_KNOWN * (corrected + by_brightness[0])
        vectors[2, :, 2] = by_brightness[1] - by_brightness[0]
        vectors[3] = WATER_KNOWN * _moved(cloud, around)[0]
        return vectors

    def _level_error(self, line: WaterLine) -> float:
        """Return the standard error of the level that the median of first echoes tells [m]."""
        if not line.measured:
            return self.level_error
        elevation = line.first[..., 2][line.on_water]
        return MEDIAN_OVER_MEAN * float(elevation.std()) / float(np.sqrt(elevation.size))

    def _half_pixel(self, cloud: PointCloud, around: Surroundings) -> FloatArray:
        """Return half the side of the pixels' footprints; in water they widen by 1 / n less."""
        height = around.frame.measured.position[2] - cloud.position[:, 2]
        reach = height - cloud.depth * (1.0 - 1.0 / self.refractive_index)
        return np.asarray(0.5 * self.camera.pixel_tangent * reach)


def _bed(cloud: PointCloud, shape: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
    """Return slope (rows, columns, 2) [1] and roughness [m] that points of a frame show."""
    pixel = cloud.row, cloud.column
    places, used = np.full((*shape, 3), np.nan), np.zeros(shape, np.bool_)
    places[pixel] = cloud.position
    used[pixel] = cloud.classification != PointClass.NO_BOTTOM_FOUND
    planes = fitted_planes(places=places, used=used, width=NEIGHBOURHOOD)
    return np.nan_to_num(planes.slope), planes.roughness


def _moved(cloud: PointCloud, around: Surroundings) -> FloatArray:
    """Return how far points were moved to where their light was reflected (1, n, 3) [m]."""
    rays = around.rays[cloud.row, cloud.column]
    shift = np.where(cloud.depth > 0.0, around.scattering.at("shift", cloud.depth), 0.0)
    vectors = np.zeros((1, len(cloud), 3))
    vectors[0, :, :2] = shift[:, None] * rays[:, :2] / -rays[:, 2:]
    return vectors


def _hidden_relief(roughness: FloatArray, effects: Effects) -> FloatArray:
    """Return the vectors (1, n, 3) of the relief that a footprint may hide.

    Assumed as large as what points show about the plane through their neighbours beyond the errors
    that each pixel has of its own: counting noise, waves and the Monte Carlo's.
    """
    own = np.concatenate([effects[one] for one in OF_A_PIXEL])[..., 2]
    vectors = np.zeros((1, len(roughness), 3))
    vectors[0, :, 2] = np.sqrt(np.maximum(roughness**2 - np.sum(own**2, axis=0), 0.0))
    return vectors

"""One frame's echoes as points on the map."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter

from survey.cloud.echo import Echo
from survey.cloud.georeference import (
    WaterPath,
    bend_at_slopes,
    bend_at_surface,
    place_in_air,
    place_in_water,
)
from survey.cloud.local_surface import fitted_planes
from survey.cloud.lone_echoes import stands_alone, stands_high
from survey.cloud.points import Cause, PointClass, PointCloud
from survey.cloud.reflectance import Calibration
from survey.cloud.scattering import Scattering
from survey.cloud.truth import TrueTargets
from survey.flight.pose import Frame
from terrain.substrate import UNLABELLED

if TYPE_CHECKING:
    from survey.sensor.camera import Camera
    from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

LAND_ABOVE_WATER = 0.75  # [m]
CREST_PER_WAVE_HEIGHT = (
    1.25  # five deviations: Gaussian waves rise above it at 3 places in ten million
)
ENOUGH_SURFACE_ECHOES = 20
OBJECT_ABOVE_BOTTOM = 1.0
OBJECT_NEIGHBOURHOOD = 15


@dataclass(frozen=True, kw_only=True)
class WaterLine:
    """What the first echoes say: where water is, and at which level.

    Parameters
    ----------
    level : float
        Estimated elevation of the water [m].
    measured : bool
        Whether first echoes told it, or it is the expected one.
    reach : float
        How far above and below it there may be water [m].
    land, water : array (rows, columns)
        Pixels whose first echo lies on land, and pixels over water.
    first : array (rows, columns, 3)
        Places of the first echoes [m].
    path : WaterPath
        The pixel rays' way into the water at that level.
    """

    level: float
    measured: bool
    reach: float
    land: BoolArray
    water: BoolArray
    first: FloatArray
    path: WaterPath

    @property
    def on_water(self) -> BoolArray:
        """Tell which first echoes lie on the water (rows, columns)."""
        return self.water & (np.abs(self.first[..., 2] - self.level) <= self.reach)

    def on_local_waves(
        self, *, frame: Frame, rays: FloatArray, refractive_index: float, width: float
    ) -> WaterLine:
        """Return the line with paths bent at planes through the neighbourhoods' first echoes.

        Where too few echoes lie near, the level stays the mean one.

        Parameters
        ----------
        frame : Frame
        rays : array (rows, columns, 3)
            Unit directions by the measured pose.
        refractive_index : float
            Of the water [1].
        width : float
            Standard deviation of the neighbourhoods' weights [pixels].
        """
        planes = fitted_planes(places=self.first, used=self.on_water, width=width)
        known = np.isfinite(planes.elevation)
        position = frame.measured.position
        elevation = np.where(known, planes.elevation, self.level)
        path = bend_at_slopes(
            position=position,
            rays=rays,
            length=(elevation - position[2]) / rays[..., 2],
            slopes=np.where(known[..., None], planes.slope, 0.0),
            refractive_index=refractive_index,
        )
        return replace(self, path=path)

    @property
    def surface_time(self) -> FloatArray:
        """Two-way time to the water of each pixel [s], nan on land."""
        return np.where(self.water, self.path.air_time, np.nan)


def find_water(
    *,
    first: Echo,
    frame: Frame,
    rays: FloatArray,
    expected_level: float,
    refractive_index: float,
    wave_height: float = 0.0,
) -> WaterLine:
    """Tell land from water by the first echoes and estimate the water level.

    Water reaches 0.75 m above and below its level, or as far as the waves do where that is more:
    1.25 of their significant height. The level is the median elevation of the first echoes that
    near to the expected level, or that level itself where there are fewer than 20. What lies higher
    is land unless it stands alone; hence a beach that waves could top is taken for water.

    Parameters
    ----------
    first : Echo
    frame : Frame
    rays : array (rows, columns, 3)
        Unit directions by the measured pose.
    expected_level : float
        Of the water, as its gauge tells [m].
    refractive_index : float
        Of the water [1].
    wave_height : float
        Significant height of the waves, as the survey's log tells [m].
    """
    position = frame.measured.position
    places = place_in_air(position=position, rays=rays, time=first.time)
    elevation = places[..., 2]
    reach = max(LAND_ABOVE_WATER, CREST_PER_WAVE_HEIGHT * wave_height)
    near = np.abs(elevation - expected_level) <= reach
    enough = bool(near.sum() >= ENOUGH_SURFACE_ECHOES)
    level = float(np.median(elevation[near])) if enough else expected_level
    land = elevation > level + reach
    land &= ~stands_alone(elevation, land)
    return WaterLine(
        level=level,
        measured=enough,
        reach=reach,
        land=land,
        water=~land,
        first=places,
        path=bend_at_surface(
            position=position, rays=rays, level=level, refractive_index=refractive_index
        ),
    )


def surface_points(
    *, line: WaterLine, first: Echo, frame: Frame, targets: TrueTargets
) -> PointCloud:
    """Return the first echoes on the water, class 41, and those alone in the air, class 18."""
    on_water = line.on_water
    in_air = first.found & line.water & (line.first[..., 2] > line.level + line.reach)
    wet = targets.classification != PointClass.GROUND
    return _cloud(
        which=on_water | in_air,
        line=line,
        frame=frame,
        position=line.first,
        uncorrected=line.first,
        truth=targets.surface,
        classification=np.where(in_air, PointClass.HIGH_NOISE, PointClass.WATER_SURFACE),
        true_classification=np.where(wet, PointClass.WATER_SURFACE, PointClass.GROUND),
        substrate=np.where(wet, UNLABELLED, targets.substrate),
        true_elevation=targets.surface[..., 2],
        targets=targets,
        reflectance=np.where(wet, np.nan, targets.reflectance),
        water_path=np.zeros(on_water.shape),
        depth=np.zeros(on_water.shape),
        echo=first,
    )


def bottom_points(
    *,
    line: WaterLine,
    first: Echo,
    bottom: Echo,
    frame: Frame,
    rays: FloatArray,
    camera: Camera,
    targets: TrueTargets,
    seabed: Seabed,
    group_index: float,
    scattering: Scattering,
    calibration: Calibration,
) -> PointCloud:
    """Return one point a pixel: bottom (40), object (43), land (2), or none found (45).

    Bottom points are freed of what scattering is expected to do to them. One that stands alone is
    noise, high (18) or low (7), and keeps its place.
    """
    found = bottom.found
    refracted = place_in_water(path=line.path, time=bottom.time, group_index=group_index)
    height = frame.measured.position[2] - line.level
    corrected = scattering.corrected(
        refracted,
        rays=rays,
        edge=camera.edge_distances(height=height),
        level=line.level,
        reflectance=partial(
            calibration.reflectance, bottom.counts, slant=-1.0 / rays[..., 2], height=height
        ),
    )
    straight = place_in_air(position=frame.measured.position, rays=rays, time=bottom.time)
    on_land, in_water = line.land[..., None], found[..., None]
    position = np.where(on_land, line.first, np.where(in_water, corrected, line.path.entry))
    elevation = corrected[..., 2]
    alone = stands_alone(elevation, found)
    rules = (
        (line.land, PointClass.GROUND),
        (alone & stands_high(elevation, found), PointClass.HIGH_NOISE),
        (alone, PointClass.LOW_NOISE),
        (_stands_out(elevation, found & ~alone), PointClass.SUBMERGED_OBJECT),
        (found, PointClass.BATHYMETRIC),
    )
    classification = np.select(
        [rule for rule, _ in rules], [kind for _, kind in rules], PointClass.NO_BOTTOM_FOUND
    )
    return _cloud(
        which=np.ones(found.shape, np.bool_),
        line=line,
        frame=frame,
        position=position,
        uncorrected=np.where(on_land, line.first, np.where(in_water, straight, position)),
        truth=targets.position,
        classification=classification,
        true_classification=targets.classification,
        substrate=targets.substrate,
        true_elevation=seabed.elevation_at(
            position[..., 0].ravel(), position[..., 1].ravel()
        ).reshape(found.shape),
        targets=targets,
        reflectance=targets.reflectance,
        water_path=targets.water_path,
        depth=np.where(found, line.level - position[..., 2], 0.0),
        echo=Echo(
            time=np.where(line.land, first.time, bottom.time),
            counts=np.where(line.land, first.counts, bottom.counts),
            snr=np.where(line.land, first.snr, bottom.snr),
            time_error=np.where(line.land, first.time_error, bottom.time_error),
        ),
    )


def _stands_out(elevation: FloatArray, found: BoolArray) -> BoolArray:
    """Tell which bottom points stand more than 1 m above the median of those in 15 x 15 pixels.

    The median is taken where a point stands as high above the lowest of them: elsewhere it cannot.
    """
    side = OBJECT_NEIGHBOURHOOD
    lowest = minimum_filter(
        np.where(found, elevation, np.inf), size=side, mode="constant", cval=np.inf
    )
    high = found & (elevation > lowest + OBJECT_ABOVE_BOTTOM)
    if not high.any():
        return high
    padded = np.pad(np.where(found, elevation, np.nan), side // 2, constant_values=np.nan)
    neighbours = np.lib.stride_tricks.sliding_window_view(padded, (side, side))[high]
    median = np.nanmedian(neighbours.reshape(-1, side * side), axis=-1)
    result = np.zeros(found.shape, np.bool_)
    result[high] = elevation[high] - median > OBJECT_ABOVE_BOTTOM
    return result


def _cloud(
    *,
    which: BoolArray,
    line: WaterLine,
    frame: Frame,
    position: FloatArray,
    uncorrected: FloatArray,
    truth: FloatArray,
    classification: NDArray[np.int64],
    true_classification: NDArray[np.int64] | NDArray[np.uint8],
    substrate: NDArray[np.int64] | NDArray[np.uint8],
    true_elevation: FloatArray,
    targets: TrueTargets,
    reflectance: FloatArray,
    water_path: FloatArray,
    depth: FloatArray,
    echo: Echo,
) -> PointCloud:
    """Return the chosen pixels of one frame as points, in the order of rows and columns.

    Without uncertainties, causes and measured reflectance: see `survey.cloud.uncertainty`,
    `survey.cloud.error_causes` and `survey.cloud.reflectance`.
    """
    row, column = np.nonzero(which)
    count = len(row)
    return PointCloud(
        position=position[which],
        uncorrected=uncorrected[which],
        truth=truth[which],
        classification=classification[which].astype(np.uint8),
        true_classification=true_classification[which].astype(np.uint8),
        substrate=substrate[which].astype(np.uint8),
        true_elevation=true_elevation[which],
        true_surface=targets.surface[which],
        true_normal=targets.normal[which].astype(np.float32),
        water_path=water_path[which].astype(np.float32),
        tvu=np.full(count, np.nan, np.float32),
        thu=np.full(count, np.nan, np.float32),
        cause=np.full(count, Cause.NONE, np.uint8),
        surface_elevation=np.where(line.land, np.nan, line.path.entry[..., 2])[which],
        reflectance=np.full(count, np.nan, np.float32),
        true_reflectance=reflectance[which].astype(np.float32),
        time=frame.time + np.nan_to_num(echo.time[which]),
        depth=depth[which],
        counts=np.nan_to_num(echo.counts[which]).astype(np.float32),
        snr=np.nan_to_num(echo.snr[which]).astype(np.float32),
        frame=np.full(count, frame.index, np.uint32),
        line=np.full(count, frame.line, np.uint16),
        row=row.astype(np.uint16),
        column=column.astype(np.uint16),
    )

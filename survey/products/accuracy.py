"""The measured clouds against the truth beside them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import NOISE_CLASSES, PixelRecord, PointClass, PointCloud
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.optics.water import WaterColumn
from survey.products.cells import CellGrid, inside_ring
from survey.products.pixels import DETECTABLE, HALF, deepest, pixel_metrics
from survey.products.reach import optical_depths

FloatArray = NDArray[np.float64]
ElevationAt = Callable[[FloatArray, FloatArray], FloatArray]
BOTTOM_CLASSES = (PointClass.BATHYMETRIC, PointClass.SUBMERGED_OBJECT)
DECIMALS = 6


def metrics(
    *,
    bottom: PointCloud,
    surface: PointCloud,
    records: Sequence[PixelRecord],
    elevation_at: ElevationAt,
    water_level: float,
    survey_area: FloatArray,
    cell_size: float,
    water: WaterColumn,
) -> dict[str, Any]:
    """Return what a mission achieved, as plain values for JSON; None where nothing was measured.

    An error is measured less true elevation at the measured place [m]; points off the known
    seabed have none and are left out of the errors. "Bottom" is classes 40 and 43.

    ==================================  ========================================================
    frames                              records given
    points_bottom, _surface, _ground    points of classes 40 and 43; 41; 2
    points_no_bottom_found              points of class 45
    points_noise                        of classes 7 and 18, in both clouds; in no other figure
    bias_m, rmse_m, p95_abs_error_m     mean, root mean square, 95th percentile of the absolute
                                        errors of bottom points, false bottoms included
    bias_standard_error_m               from the scatter of the frames' mean errors, weighted by
                                        points; frames are taken as independent
    surface_*, ground_*                 the same for surface points and for dry ground
    false_bottoms                       bottom points with an absolute error above 1 m
    coverage_fraction                   cells that hold a bottom point, over the cells whose
                                        centre lies in the survey area and truly under water
    density_per_m2                      bottom points over the area of these wet cells
    ==================================  ========================================================

    followed by what `pixel_metrics` counts, by `stitched_depths`, and by what `optical_depths`
    makes of all depths.

    Parameters
    ----------
    bottom, surface : PointCloud
        Stitched clouds in the scene's local frame.
    records : sequence of PixelRecord
        One a frame.
    elevation_at : callable
        True elevation of seabed or land at local x, y, nan outside: ``Seabed.elevation_at``.
    water_level : float
        True mean water level in the vertical datum [m].
    survey_area : array (n, 2)
        Ring around the area that should be covered [m, local].
    cell_size : float
        Side of the cells of coverage [m]: that of the thinning, and not below the pixels'
        spacing on the bottom, or full coverage is out of reach.
    water : WaterColumn
        Makes optical depths of depths.

    Raises
    ------
    ProductError
        If the survey area is empty or too large for such cells.
    """
    solid = bottom.select(np.isin(bottom.classification, BOTTOM_CLASSES))
    first_echoes = surface.select(surface.classification == PointClass.WATER_SURFACE)
    noise = (np.isin(each.classification, NOISE_CLASSES) for each in (bottom, surface))
    ground = bottom.select(bottom.classification == PointClass.GROUND)
    pixels = pixel_metrics(records) | stitched_depths(bottom, water_level=water_level)
    values = {
        "frames": len(records),
        "points_bottom": len(solid),
        "points_surface": len(first_echoes),
        "points_ground": len(ground),
        "points_no_bottom_found": int((bottom.classification == PointClass.NO_BOTTOM_FOUND).sum()),
        "points_noise": sum(int(which.sum()) for which in noise),
        **_error_metrics("", solid),
        **_error_metrics("surface_", first_echoes),
        **_error_metrics("ground_", ground),
        "false_bottoms": int((np.abs(elevation_errors(solid)) > FALSE_BOTTOM_ERROR).sum()),
        **_coverage(solid, elevation_at, water_level, survey_area, cell_size),
        **pixels,
        **optical_depths(pixels, water),
    }
    return {name: _rounded(value) for name, value in values.items()}


def stitched_depths(bottom: PointCloud, *, water_level: float) -> dict[str, float | None]:
    """Return how deep a stitched cloud holds the true bottom.

    ``stitched_depth_m`` is the deep edge of the deepest 0.5 m bin of true depth, or the deepest
    place, where nine points in ten are bottom points within 1 m of the true seabed;
    ``half_stitched_depth_m`` where half of them are. None where that is nowhere so.

    Parameters
    ----------
    bottom : PointCloud
        With its points where no bottom was found.
    water_level : float
        [m].
    """
    depth = water_level - bottom.truth[:, 2]
    right = np.isin(bottom.classification, BOTTOM_CLASSES)
    right &= np.abs(bottom.position[:, 2] - bottom.true_elevation) <= FALSE_BOTTOM_ERROR
    right, depth = right[depth > 0.0], depth[depth > 0.0]
    return {
        "stitched_depth_m": deepest(depth, lambda here: right[here].mean() >= DETECTABLE),
        "half_stitched_depth_m": deepest(depth, lambda here: right[here].mean() >= HALF),
    }


def elevation_errors(cloud: PointCloud) -> FloatArray:
    """Return measured less true elevation of the points that have a true one (m,) [m]."""
    errors = cloud.position[:, 2] - cloud.true_elevation
    return np.asarray(errors[np.isfinite(errors)])


def _error_metrics(prefix: str, cloud: PointCloud) -> dict[str, float | None]:
    known = cloud.select(np.isfinite(cloud.true_elevation))
    errors = elevation_errors(known)
    names = [f"{prefix}{name}" for name in ("bias_m", "rmse_m", "p95_abs_error_m")]
    if errors.size == 0:
        return dict.fromkeys([*names, f"{prefix}bias_standard_error_m"])
    values = [
        float(errors.mean()),
        float(np.sqrt(np.mean(errors**2))),
        float(np.percentile(np.abs(errors), 95.0)),
    ]
    error = _standard_error(errors, known.frame)
    return dict(zip(names, values, strict=True)) | {f"{prefix}bias_standard_error_m": error}


def _standard_error(errors: FloatArray, frame: NDArray[np.uint32]) -> float | None:
    """Return the standard error of the mean, with frames as the independent units."""
    _, group, count = np.unique(frame, return_inverse=True, return_counts=True)
    if count.size < 2:
        return None
    departures = np.bincount(group, errors - errors.mean())
    share = count.size / (count.size - 1)
    return float(np.sqrt(share * np.sum(departures**2)) / errors.size)


def _coverage(
    solid: PointCloud,
    elevation_at: ElevationAt,
    water_level: float,
    survey_area: FloatArray,
    cell_size: float,
) -> dict[str, float | None]:
    cells = CellGrid.covering(survey_area, cell_size=cell_size)
    centres = cells.centres().reshape(-1, 2)
    inside = inside_ring(cells, survey_area).ravel()
    wet = np.zeros(inside.shape, dtype=np.bool_)
    wet[inside] = elevation_at(centres[inside, 0], centres[inside, 1]) < water_level
    if not wet.any():
        return {"coverage_fraction": None, "density_per_m2": None}
    held = np.zeros(wet.shape, dtype=np.bool_)
    held[cells.index_of(solid.position[cells.contains(solid.position)])] = True
    area = float(wet.sum()) * cell_size**2
    return {
        "coverage_fraction": float((held & wet).sum() / wet.sum()),
        "density_per_m2": len(solid) / area,
    }


def _rounded(value: Any) -> Any:
    return round(value, DECIMALS) if isinstance(value, float) else value

"""All finished products of a mission, from its frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Outcome, PointClass, PointCloud
from survey.cloud.stitch import stitched
from survey.flight.pose import Frame
from survey.optics.water import WaterColumn
from survey.products.accuracy import BOTTOM_CLASSES, elevation_errors, metrics
from survey.products.coverage import coverage_map, surveyed_hull, write_coverage_geojson
from survey.products.frame_file import FrameResult
from survey.products.grids import grid_elevation, write_bathymetry_tif
from survey.products.json_file import write_json
from survey.products.las_file import write_laz
from survey.products.mesh_files import has_triangles, write_bathymetry_glb
from survey.products.pixels import explain_empty
from survey.products.ply_file import write_ply
from survey.products.report import write_report
from survey.products.substrates import substrate_metrics
from survey.products.track_files import TrackFormat, write_trajectory_files
from survey.products.trajectory_file import write_trajectory_csv
from survey.products.uncertainty_check import uncertainty_metrics
from survey.products.writing import ProductError
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class ProductSettings:
    """What the products need to know beside the frames.

    Parameters
    ----------
    title, description : str
        Of the mission.
    start_utc : datetime
        Start of the mission.
    water_level : float
        In the vertical datum [m].
    thinning, grid : float
        Sides of the cells in which overlaps are thinned and elevations gridded [m].
    pixel_spacing : float
        Distance of neighbouring pixels on the bottom [m].
    pixel_tangent : float
        Side of a pixel in the tangent plane [1].
    survey_area : array (n, 2) or None
        Ring around the area that was ordered [m, local]; without one it is the hull of what all
        pixels look at.
    trajectory_files : sequence of str
        Formats beside CSV in which the measured trajectory is written.
    deviations : tuple of float
        Standard deviations of the measured pose, see `Navigation.deviations`.
    water : WaterColumn
        Makes optical depths of depths.
    """

    title: str
    description: str
    start_utc: datetime
    water_level: float
    thinning: float
    grid: float
    pixel_spacing: float
    pixel_tangent: float
    survey_area: FloatArray | None
    trajectory_files: Sequence[TrackFormat]
    deviations: tuple[float, ...]
    water: WaterColumn


def write_products(
    folder: Path,
    *,
    results: Sequence[FrameResult],
    frames: Sequence[Frame],
    seabed: Seabed,
    settings: ProductSettings,
) -> dict[str, Any]:
    """Stitch the frames, write every product into the run folder, and return the metrics.

    A cloud without points (the water surface of a flight over land) has no file, nor has a mesh
    without triangles (of a few false bottoms far apart).

    Raises
    ------
    ProductError
        When no bottom and no land was found; the text says why.
    """
    records = [result.record for result in results]
    bottom = stitched([result.bottom for result in results], cell_size=settings.thinning)
    surface = stitched([result.surface for result in results], cell_size=settings.thinning)
    _require_bottom(bottom, results)
    _write_clouds(folder, bottom, surface, frames, seabed, settings)
    grid = grid_elevation(bottom, seabed.map_frame, cell_size=settings.grid)
    write_bathymetry_tif(folder / "bathymetry.tif", grid, seabed.map_frame)
    if has_triangles(grid):
        write_bathymetry_glb(
            folder / "bathymetry.glb", grid, seabed.map_frame, water_level=settings.water_level
        )
    area = surveyed_hull(records) if settings.survey_area is None else settings.survey_area
    cell = max(settings.grid, settings.pixel_spacing)
    coverage = coverage_map(
        records,
        seabed.map_frame,
        survey_area=area,
        cell_size=settings.grid,
        reach=settings.pixel_spacing * 2**0.5,
    )
    write_coverage_geojson(folder / "coverage.geojson", coverage, seabed.map_frame)
    found = metrics(
        bottom=bottom,
        surface=surface,
        records=records,
        elevation_at=seabed.elevation_at,
        water_level=settings.water_level,
        survey_area=area,
        cell_size=cell,
        water=settings.water,
    )
    found |= uncertainty_metrics(
        bottom,
        frames=frames,
        pixel_tangent=settings.pixel_tangent,
        refractive_index=settings.water.refractive_index,
    )
    found["substrates"] = substrate_metrics(bottom, results, seabed.substrate_names)
    write_json(folder / "metrics.json", found)
    write_report(
        folder / "report.html",
        title=settings.title,
        description=settings.description,
        metrics=found,
        grid=grid,
        coverage=coverage,
        errors=elevation_errors(bottom.select(np.isin(bottom.classification, BOTTOM_CLASSES))),
        water_level=settings.water_level,
    )
    return found


def _require_bottom(bottom: PointCloud, results: Sequence[FrameResult]) -> None:
    """Raise unless some bottom or land was truly found: a false echo alone is no seabed."""
    records = [result.record for result in results]
    outcome = np.concatenate([record.outcome.ravel() for record in records])
    dry = (outcome == Outcome.DRY).any() and (bottom.classification == PointClass.GROUND).any()
    if not dry and not (outcome == Outcome.FOUND).any():
        raise ProductError(explain_empty(records))


def _write_clouds(
    folder: Path,
    bottom: PointCloud,
    surface: PointCloud,
    frames: Sequence[Frame],
    seabed: Seabed,
    settings: ProductSettings,
) -> None:
    for name, cloud in (("bottom", bottom), ("water_surface", surface)):
        if len(cloud) == 0:
            continue
        write_ply(folder / f"{name}.ply", cloud, seabed.map_frame)
        write_laz(
            folder / f"{name}.laz",
            cloud,
            seabed.map_frame,
            start_utc=settings.start_utc,
            frames=frames,
        )
    write_trajectory_csv(
        folder / "trajectory.csv", frames, [frame.measured for frame in frames], seabed.map_frame
    )
    write_trajectory_files(
        folder,
        frames,
        seabed.map_frame,
        formats=settings.trajectory_files,
        start_utc=settings.start_utc,
        deviations=settings.deviations,
    )

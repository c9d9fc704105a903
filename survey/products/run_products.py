"""All finished products of a mission, from its frames."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.coincidence import Coincidence
from survey.cloud.derived_surface import derived_surface
from survey.cloud.overlaps import OverlapTally
from survey.cloud.points import PointCloud
from survey.cloud.shared_views import SharedViews
from survey.flight.pose import Frame
from survey.optics.water import WaterColumn
from survey.products.accuracy import Accuracy
from survey.products.coverage import CoverageTally, write_coverage_geojson
from survey.products.depth_profile import DepthProfile
from survey.products.first_look import FirstLook
from survey.products.grids import Overview, error_places, gridded, solid_places, solid_tvu
from survey.products.helped_frames import HelpedFrames
from survey.products.json_file import write_json
from survey.products.las_file import laz_file
from survey.products.lines_file import write_lines_geojson
from survey.products.mesh_files import has_triangles, write_bathymetry_glb
from survey.products.ply_file import ply_file
from survey.products.report.page import Figure
from survey.products.report.report import Findings, write_report
from survey.products.shadows import with_shadows
from survey.products.stitching import ReadFrame, first_look, stitched_tiles
from survey.products.strip_differences import (
    DIFFERENCES,
    overlap_metrics,
    strip_differences_tif,
)
from survey.products.tif_file import bathymetry_tif
from survey.products.tile_points import TilePoints
from survey.products.track_files import TrackFormat, write_trajectory_files
from survey.products.trajectory_file import write_trajectory_csv
from survey.products.uncertainty_check import UncertaintyTally
from survey.products.verdict.features import Cube
from survey.products.verdict.mission import VerdictTally
from survey.products.verdict.report import failure_figure, verdict_section
from survey.progress import Unwatched, Watcher
from survey.sensor.camera import Camera
from terrain.map_frame import MapFrame
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
    survey_area : array (n, 2) or None
        Ring around the area that was ordered [m, local]; without one it is the hull of what all
        pixels look at.
    trajectory_files : sequence of str
        Formats beside CSV in which the measured trajectory is written.
    deviations : tuple of float
        Standard deviations of the measured pose, see `Navigation.deviations`.
    water : WaterColumn
        Makes optical depths of depths.
    order : str or None
        Key of the order of S-44 that was asked for.
    cubes : sequence of Cube
        On the bottom, for the feature tests.
    strip_adjustment : str
        How the lines were brought together: "none", "boresight" or "offsets".
    camera : Camera
        Tells what was in view and hidden.
    second_look : Coincidence, optional
        How frames believe each other's weak echoes; without it each stands for itself.
    """

    title: str
    description: str
    start_utc: datetime
    water_level: float
    thinning: float
    grid: float
    pixel_spacing: float
    survey_area: FloatArray | None
    trajectory_files: Sequence[TrackFormat]
    deviations: tuple[float, ...]
    water: WaterColumn
    camera: Camera
    order: str | None
    cubes: Sequence[Cube]
    strip_adjustment: str = "none"
    second_look: Coincidence | None = None

    def views(self, frames: Sequence[Frame], *, deepest: float) -> SharedViews:
        """Return what frames see under water down to a depth [m]."""
        return SharedViews.of(
            frames,
            self.camera,
            level=self.water_level,
            refractive_index=self.water.refractive_index,
            deepest=deepest,
        )

    def helped(self, read: ReadFrame, frames: Sequence[Frame]) -> ReadFrame:
        """Return how frames are read whose weak echoes other frames have judged."""
        if self.second_look is None:
            return read
        return HelpedFrames(
            read,
            frames,
            views=self.views(frames, deepest=self.second_look.depth_searched),
            rule=self.second_look,
            pixel_tangent=self.camera.pixel_tangent,
            level=self.water_level,
        )

    @property
    def reach(self) -> float:
        """How far a pixel answers for the bottom around it: to its neighbour at the corner [m]."""
        return self.pixel_spacing * 2**0.5


def write_products(
    folder: Path,
    *,
    read: ReadFrame,
    frames: Sequence[Frame],
    seabed: Seabed,
    settings: ProductSettings,
    sample: Figure | None = None,
    manifest: Mapping[str, Any] | None = None,
    set_aside: Mapping[int, str] | None = None,
    watch: Watcher | None = None,
) -> dict[str, Any]:
    """Stitch the frames, write every product into the run folder, and return the metrics.

    The frames are read twice: first to learn where they lie and what their pixels saw, then tile by
    tile of the map, and a tile goes into every product before the next is begun. So memory holds a
    tile and not the mission. Points are ordered by tile, see `map_tiles`, and in it by frame, row
    and column.

    A cloud without points (the water surface of a flight over land) has no file, nor has a mesh
    without triangles (of a few false bottoms far apart).

    Parameters
    ----------
    folder : Path
        Run folder.
    read : callable
        Returns a frame by its number; called from other threads.
    frames : sequence of Frame
        Those to take.
    seabed : Seabed
        The true one.
    settings : ProductSettings
    sample : Figure, optional
        The waveform of one pixel, for the report.
    manifest : mapping, optional
        What made the run, for the report.
    set_aside : mapping, optional
        Why frames are missing that could not be flown, by their number.
    watch : Watcher, optional
        Is told of the progress.

    Raises
    ------
    ProductError
        When no bottom and no land was found; the text says why.
    """
    map_frame, watch = seabed.map_frame, watch or Unwatched()
    read = settings.helped(read, frames)
    look = first_look(read, frames, map_frame, watch)
    look.require_bottom()
    area = look.hull.ring() if settings.survey_area is None else settings.survey_area
    raster = look.raster(cell_size=settings.grid)
    overview, error_overview, depths = Overview(raster), Overview(raster), DepthProfile()
    substrates, overlaps = look.substrates, OverlapTally()
    coverage = CoverageTally(
        survey_area=area + map_frame.origin[:2], cell_size=settings.grid, reach=settings.reach
    )
    accuracy = Accuracy(
        water_level=settings.water_level,
        survey_area=area,
        cell_size=max(settings.grid, settings.pixel_spacing),
    )
    verdict = VerdictTally(
        cells=coverage.cells,
        seabed=seabed,
        water_level=settings.water_level,
        reach=settings.reach,
        cubes=settings.cubes,
    )
    uncertainty = UncertaintyTally(
        frames=frames,
        pixel_tangent=settings.camera.pixel_tangent,
        refractive_index=settings.water.refractive_index,
    )
    with (
        _point_files(folder, look, frames, map_frame, settings) as add_points,
        bathymetry_tif(folder / "bathymetry.tif", raster, map_frame) as add_cells,
        strip_differences_tif(folder / DIFFERENCES, raster, map_frame) as add_lines,
    ):
        tiles = stitched_tiles(
            look,
            read,
            frames,
            map_frame,
            grid=settings.grid,
            thinning=settings.thinning,
            reach=settings.reach,
            watch=watch,
        )
        for part in tiles:
            grid = gridded(
                solid_places(part.bottom, map_frame), part.tile.cells, solid_tvu(part.bottom)
            )
            add_points(part)
            add_cells(grid)
            add_lines(part.tile.cells, part.lines)
            overlaps.add(part.lines)
            overview.add(grid)
            error_overview.add(gridded(*error_places(part.bottom, map_frame, part.tile.cells)))
            depths.add(part.bottom)
            coverage.add(part.looked_at, part.outcomes, part.tile.cells)
            accuracy.add(part.bottom, part.surface)
            uncertainty.add(part.bottom)
            substrates.add_points(part.bottom)
            verdict.add(part)
    found = accuracy.metrics(
        pixels=look.pixels, elevation_at=seabed.elevation_at, water=settings.water
    )
    found["found_with_other_frames"] = look.helped
    found["strip_adjustment"] = settings.strip_adjustment
    found["frames_set_aside"] = [
        {"frame": index, "reason": reason} for index, reason in sorted((set_aside or {}).items())
    ]
    found["overlaps"] = overlap_metrics(overlaps.overlaps())
    found |= uncertainty.metrics()
    found["error_by_depth"] = depths.metrics()
    found["detection_by_counts"] = look.strengths.metrics()
    found["substrates"] = substrates.metrics(seabed.substrate_names)
    covered = with_shadows(
        coverage.map(),
        frames=frames,
        camera=settings.camera,
        seabed=seabed,
        level=settings.water_level,
        refractive_index=settings.water.refractive_index,
    )
    judged = verdict.judged(covered, asked=settings.order)
    found |= judged.metrics
    judged.failures.write(folder / "failures.geojson", map_frame)
    write_json(folder / "metrics.json", found)
    _write_tracks(folder, frames, map_frame, settings)
    seen = overview.map()
    if has_triangles(seen):
        write_bathymetry_glb(
            folder / "bathymetry.glb", seen, map_frame, water_level=settings.water_level
        )
    write_coverage_geojson(folder / "coverage.geojson", covered, map_frame)
    write_report(
        folder,
        Findings(
            title=settings.title,
            description=settings.description,
            metrics=found,
            grid=seen,
            error_grid=error_overview.map(),
            coverage=covered,
            errors=accuracy.bottom.errors,
            water_level=settings.water_level,
            verdict=tuple(verdict_section(judged)),
            failures=failure_figure(judged),
            sample=sample,
            manifest=manifest,
        ),
    )
    return found


@contextmanager
def _point_files(
    folder: Path,
    look: FirstLook,
    frames: Sequence[Frame],
    map_frame: MapFrame,
    settings: ProductSettings,
) -> Iterator[Callable[[TilePoints], None]]:
    """Give a function that adds a tile to the point files."""

    def cloud_files(name: str) -> list[Callable[[PointCloud], None]]:
        ply = ply_file(folder / f"{name}.ply", map_frame)
        laz = laz_file(
            folder / f"{name}.laz",
            map_frame,
            start_utc=settings.start_utc,
            frames=frames,
            strip_adjustment=settings.strip_adjustment,
        )
        return [files.enter_context(ply), files.enter_context(laz)]

    with ExitStack() as files:
        bottom = cloud_files("bottom")
        surface = cloud_files("water_surface") if look.surface_points else []

        def add(part: TilePoints) -> None:
            for add_cloud in bottom:
                add_cloud(part.bottom)
            for add_cloud in surface:
                add_cloud(part.surface)
                add_cloud(derived_surface(part.bottom, frames))

        yield add


def _write_tracks(
    folder: Path, frames: Sequence[Frame], map_frame: MapFrame, settings: ProductSettings
) -> None:
    measured = [frame.measured for frame in frames]
    write_lines_geojson(folder / "lines.geojson", frames, map_frame)
    write_trajectory_csv(folder / "trajectory.csv", frames, measured, map_frame)
    write_trajectory_files(
        folder,
        frames,
        map_frame,
        formats=settings.trajectory_files,
        start_utc=settings.start_utc,
        deviations=settings.deviations,
    )

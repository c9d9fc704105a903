"""How fast a flown mission becomes products, and how much memory that takes.

    python tests/benchmarks/products.py [--frames 1600] [--thinning 0] [--keep FOLDER] [--json]

Lines of 200 frames of 64 x 32 pixels, 1.6 m apart, flown to and fro 41 m apart, and cross lines
over them, over a seabed known by a formula. The frames are made first, in files as a run has them;
16000 are the mission of 33 million pixels. Points are those that come in, a bottom and a surface
point for every pixel. "stitching" is tiling, thinning, gridding and LAZ (with the surface's derived
points, three points written for two that come in), "everything" all products of a run.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, cast

import numpy as np
import trimesh
from numpy.typing import NDArray

from survey.cloud.derived_surface import derived_surface
from survey.cloud.points import Outcome, PixelRecord, PointClass, PointCloud
from survey.flight.pose import Frame, Pose
from survey.optics.water import WaterColumn, petzold_water
from survey.products.frame_file import FrameResult, frame_bytes, read_frame
from survey.products.grids import gridded, solid_places, solid_tvu
from survey.products.las_file import laz_file
from survey.products.run_products import ProductSettings, write_products
from survey.products.stitching import ReadFrame, first_look, stitched_tiles
from survey.products.tif_file import bathymetry_tif
from survey.progress import Unwatched
from survey.sensor.camera import Camera
from terrain.map_frame import MapFrame
from terrain.raycast import SeabedGrid, build_grid
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]
ROWS, COLUMNS, SPACING = 32, 64, 1.6
FRAMES_PER_LINE, LINES_PER_CROSS = 200, 9
ADVANCE, LINES_APART, HEIGHT = 82.0, 41.0, 200.0


@dataclass(frozen=True)
class FormulaSeabed:
    """What products ask of a seabed, without a mesh of its own: nothing hides a part of it."""

    map_frame: MapFrame
    grid: SeabedGrid
    substrate_names: dict[int, str] = field(default_factory=lambda: {1: "sand", 2: "rock"})

    @staticmethod
    def elevation_at(x: FloatArray, y: FloatArray) -> FloatArray:
        """Return waves of 2 m on a slope from 3 to 20 m [m]."""
        return np.asarray(-11.0 + 6.0 * np.sin(x / 900.0) + 2.0 * np.sin(y / 70.0))


FAR_BELOW = trimesh.creation.box(bounds=[[-1.0, -1.0, -30.0], [1.0, 1.0, -29.0]])
SEABED = FormulaSeabed(
    grid=build_grid(FAR_BELOW),
    map_frame=MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714),
)


def flight(count: int) -> Iterator[Frame]:
    """Yield frames: lines to and fro along x, and every tenth line across all before it."""
    for index in range(count):
        line, step = divmod(index, FRAMES_PER_LINE)
        block, number = divmod(line, LINES_PER_CROSS + 1)
        along = ADVANCE * (step if number % 2 == 0 else FRAMES_PER_LINE - 1 - step)
        across = LINES_APART * (LINES_PER_CROSS * block + number)
        place, heading = (along, across), np.pi / 2.0 if number % 2 == 0 else -np.pi / 2.0
        if number == LINES_PER_CROSS:
            place, heading = (2000.0 + LINES_APART * block, along), 0.0
        pose = Pose(
            position=np.array([*place, HEIGHT]), roll=0.0, pitch=0.0, heading=float(heading)
        )
        yield Frame(index=index, line=line, time=float(index), pose=pose)


def made(frame: Frame) -> FrameResult:
    """Return a frame whose errors are drawn, one pixel in twenty without a bottom."""
    random = np.random.default_rng(frame.index)
    row, column = (index.ravel() for index in np.mgrid[0:ROWS, 0:COLUMNS])
    n, heading = row.size, frame.pose.heading
    ahead = np.array([np.sin(heading), np.cos(heading)])
    right = np.array([np.cos(heading), -np.sin(heading)])
    offset = ((COLUMNS - 1) / 2.0 - column)[:, None] * ahead
    offset = SPACING * (offset + (row - (ROWS - 1) / 2.0)[:, None] * right)
    place = frame.pose.position[:2] + offset
    truth = np.column_stack([place, SEABED.elevation_at(*place.T)])
    lost = random.random(n) < 0.05
    measured = truth + random.normal(0.0, 0.1, truth.shape)
    measured[lost, 2] = 0.0
    classes = np.where(lost, PointClass.NO_BOTTOM_FOUND, PointClass.BATHYMETRIC).astype(np.uint8)
    level = np.column_stack([place, np.zeros(n)])
    bottom = PointCloud(
        position=measured,
        uncorrected=measured + np.array([0.1, 0.1, -1.0]),
        truth=truth,
        classification=classes,
        true_classification=np.full(n, PointClass.BATHYMETRIC, np.uint8),
        substrate=(1 + row % 2).astype(np.uint8),
        true_elevation=SEABED.elevation_at(*measured[:, :2].T),
        true_surface=level,
        true_normal=random.normal([0.0, 0.0, 1.0], 0.1, (n, 3)).astype(np.float32),
        water_path=-truth[:, 2].astype(np.float32),
        tvu=random.normal(0.2, 0.01, n).astype(np.float32),
        thu=random.normal(1.0, 0.1, n).astype(np.float32),
        cause=np.zeros(n, np.uint8),
        surface_elevation=np.zeros(n),
        reflectance=np.full(n, 0.1, np.float32),
        true_reflectance=np.full(n, 0.1, np.float32),
        time=np.full(n, frame.time),
        depth=-measured[:, 2],
        counts=random.gamma(4.0, 50.0, n).astype(np.float32),
        snr=random.gamma(4.0, 4.0, n).astype(np.float32),
        frame=np.full(n, frame.index, np.uint32),
        line=np.full(n, frame.line, np.uint16),
        row=row.astype(np.uint16),
        column=column.astype(np.uint16),
    )
    sea = level + random.normal(0.0, 0.05, level.shape)
    water = np.full(n, PointClass.WATER_SURFACE, np.uint8)
    surface = replace(
        bottom,
        position=sea,
        uncorrected=sea,
        truth=level,
        classification=water,
        true_classification=water,
        true_elevation=np.zeros(n),
        depth=np.zeros(n),
    )
    shape = (ROWS, COLUMNS)
    record = PixelRecord(
        true_position=truth.reshape(*shape, 3),
        true_depth=-truth[:, 2].reshape(shape),
        detection_probability=random.random(shape),
        outcome=np.where(lost, Outcome.TOO_DEEP, Outcome.FOUND).astype(np.uint8).reshape(shape),
        bottom_counts=random.gamma(4.0, 50.0, shape),
        monte_carlo_relative_error=random.normal(0.07, 0.01, shape),
    )
    return FrameResult(bottom=bottom, surface=surface, record=record)


def settings(thinning: float) -> ProductSettings:
    """Return the settings of the mission."""
    water = petzold_water("coastal", refractive_index=1.34, group_index=1.36)
    return ProductSettings(
        title="Benchmark",
        description="Made frames.",
        start_utc=datetime(2026, 6, 21, 10, 0, tzinfo=UTC),
        water_level=0.0,
        thinning=thinning,
        grid=2.0,
        pixel_spacing=SPACING,
        survey_area=None,
        trajectory_files=(),
        deviations=(0.0,) * 6,
        water=WaterColumn.uniform(water),
        camera=Camera(rows=8, columns=16, pixel_tangent=0.032, long_side="along"),
        order=None,
        cubes=(),
    )


@contextmanager
def frame_files(folder: Path | None, frames: list[Frame]) -> Iterator[Path]:
    """Give a folder that holds the frames, made where they are missing."""
    with tempfile.TemporaryDirectory() as own:
        place = folder or Path(own)
        place.mkdir(parents=True, exist_ok=True)
        for frame in frames:
            path = place / f"{frame.index:06d}.npz"
            if not path.exists():
                path.write_bytes(frame_bytes(made(frame)))
        yield place


@contextmanager
def timed(spent: dict[str, float]) -> Iterator[None]:
    """Add seconds by the clock and of the processors to what was spent."""
    wall, processor = time.perf_counter(), time.process_time()
    yield
    spent["seconds"] = time.perf_counter() - wall
    spent["processor_seconds"] = time.process_time() - processor


def stitch(run: Path, read: ReadFrame, frames: list[Frame], chosen: ProductSettings) -> int:
    """Tile, thin, grid and write LAZ and GeoTIFF alone; return how many points were written."""
    map_frame, watch, written = SEABED.map_frame, Unwatched(), 0
    look = first_look(read, frames, map_frame, watch)
    tiles = stitched_tiles(
        look,
        read,
        frames,
        map_frame,
        grid=chosen.grid,
        thinning=chosen.thinning,
        reach=chosen.reach,
        watch=watch,
    )
    raster = look.raster(cell_size=chosen.grid)
    with (
        laz_file(
            run / "bottom.laz", map_frame, start_utc=chosen.start_utc, frames=frames
        ) as add_bottom,
        laz_file(
            run / "water_surface.laz", map_frame, start_utc=chosen.start_utc, frames=frames
        ) as add_surface,
        bathymetry_tif(run / "bathymetry.tif", raster, map_frame) as add_cells,
    ):
        for part in tiles:
            derived = derived_surface(part.bottom, frames)
            add_bottom(part.bottom)
            add_surface(part.surface)
            add_surface(derived)
            places = solid_places(part.bottom, map_frame)
            add_cells(gridded(places, part.tile.cells, solid_tvu(part.bottom)))
            written += len(part.bottom) + len(part.surface) + len(derived)
    return written


def measured(frames: list[Frame], place: Path, thinning: float) -> dict[str, Any]:
    """Return how the frames were stitched, and how all their products were written."""

    def read(index: int) -> FrameResult:
        return read_frame(place / f"{index:06d}.npz")

    chosen, points = settings(thinning), 2 * len(frames) * ROWS * COLUMNS
    stitching: dict[str, float] = {}
    everything: dict[str, float] = {}
    with tempfile.TemporaryDirectory(dir=place) as run, timed(stitching):
        in_laz = stitch(Path(run), read, frames, chosen)
    with tempfile.TemporaryDirectory(dir=place) as run:
        with timed(everything):
            found = write_products(
                Path(run),
                read=read,
                frames=frames,
                seabed=cast(Seabed, SEABED),
                settings=chosen,
            )
        written = sum(path.stat().st_size for path in Path(run).iterdir())
    kept = sum(found[f"points_{name}"] for name in ("bottom", "no_bottom_found", "surface"))
    return {
        "frames": len(frames),
        "points_in": points,
        "points_written": kept,
        "points_in_laz": in_laz,
        **_speeds("stitching", stitching, points),
        **_speeds("everything", everything, points),
        "frames_gb": round(sum(p.stat().st_size for p in place.glob("*.npz")) / 1e9, 2),
        "products_gb": round(written / 1e9, 2),
        "peak_memory_gb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9, 2),
    }


def _speeds(name: str, spent: dict[str, float], points: int) -> dict[str, float]:
    return {
        **{f"{name}_{key}": round(value, 1) for key, value in spent.items()},
        f"{name}_points_per_second": round(points / spent["seconds"]),
        f"{name}_points_per_processor_second": round(points / spent["processor_seconds"]),
    }


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description="Speed and memory of products.")
    parser.add_argument("--frames", type=int, default=1600)
    parser.add_argument("--thinning", type=float, default=0.0)
    parser.add_argument("--keep", type=Path, help="folder of frames that are made once")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    frames = list(flight(options.frames))
    with frame_files(options.keep, frames) as place:
        found = measured(frames, place, options.thinning)
    if options.json:
        print(json.dumps(found, indent=1))
        return
    for name, value in found.items():
        print(f"{name:40}{value:>16,}")


if __name__ == "__main__":
    sys.exit(main())

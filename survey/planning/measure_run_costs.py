"""Make `data/run_costs.json` anew: ``python -m survey.planning.measure_run_costs``.

Times are processor time of one worker on the machine at hand, which the file names. The column's
error is that of one flash in a pixel, smoothed as thresholds smooth it, the median of all pixels.
"""

from __future__ import annotations

import os
import platform
import tempfile
import time
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light
from scipy.ndimage import uniform_filter

from survey.cloud.noise import NEIGHBOURS
from survey.mission import fly, fly_frame
from survey.planning.make_response_tables import as_text
from survey.preparation import Mission, prepare
from survey.products.frame_file import frame_bytes
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario

FloatArray = NDArray[np.float64]

BASE = "too-deep"
TIMED_DEPTHS = {"clear": (3.0, 12.0, 25.0), "coastal": (3.0, 8.0, 16.0), "harbor": (2.0, 5.0, 10.0)}
ERROR_DEPTHS = {"clear": 2.5, "coastal": 1.5, "harbor": 0.5}  # times 1 to 16 [m]
BOTTOMLESS = 1000.0  # [m]
ERROR_FLASHES = 6
FAINTEST = 1e-30
BINS = {"clear": 500, "coastal": 400, "harbor": 300}
SIZED_FRAMES, SIZED_DEPTH = (2, 12), 6.0
CLOUDS = ("bottom.laz", "bottom.ply", "water_surface.laz", "water_surface.ply")
RASTERS = ("bathymetry.tif", "bathymetry.glb")
DIGITS = 3


def costs() -> dict[str, Any]:
    """Fly some frames and return what they cost as plain values."""
    settings = _scenario("clear", 3.0).transport
    return {
        "made_by": "python -m survey.planning.measure_run_costs",
        "machine": f"{os.cpu_count()} cores, {platform.machine()}",
        "walks_per_pixel": settings.walks_per_pixel,
        "frames": [_timed(name, depth) for name in TIMED_DEPTHS for depth in TIMED_DEPTHS[name]],
        **_products(),
        "column_error": {
            name: {
                "depth_m": _rounded(_error_depths(name)),
                **{lit: _column_error(name, lit) for lit in ("flood", "isolated")},
            }
            for name in ERROR_DEPTHS
        },
    }


def _scenario(name: str, depth: float, **changes: Any) -> Scenario:
    return load_scenario(BASE).replace(
        **{
            "water.type": name,
            "receiver.bins": BINS[name],
            "flight.frames_per_line": 1,
            "seabed.depth_m": depth,
            **changes,
        }
    )


def _timed(name: str, depth: float) -> dict[str, Any]:
    """Return the time of one frame, the better of two after a first."""
    mission = prepare(_scenario(name, depth))
    seconds = []
    for _ in range(3):
        start = time.thread_time()
        fly_frame(mission, mission.frames[0])
        seconds.append(time.thread_time() - start)
    return {
        "water": name,
        "depth_m": depth,
        "scattering_depth": _number(float(mission.engine.water.scattered(depth))),
        "pixels": mission.camera.rows * mission.camera.columns,
        "seconds": _number(min(seconds[1:])),
    }


def _products() -> dict[str, Any]:
    """Return what finished products cost a run and each pixel, and the bytes of a run's files."""
    few, many = SIZED_FRAMES
    with tempfile.TemporaryDirectory() as folder:
        seconds = [_written(frames, Path(folder) / str(frames)) for frames in SIZED_FRAMES]
        run = Path(folder) / str(many)
        sizes = {path.relative_to(run).as_posix(): path.stat().st_size for path in run.rglob("*")}
        cells = _cells(run / "bathymetry.tif")
    scenario = _sized(many)
    mission = prepare(scenario)
    pixels = mission.camera.rows * mission.camera.columns
    per_pixel = max(seconds[1] - seconds[0], 0.0) / ((many - few) * pixels)
    kept = sum(size for name, size in sizes.items() if name.startswith("frames/"))
    flown = many * pixels
    return {
        "products_s": _number(max(seconds[0] - few * pixels * per_pixel, 0.0)),
        "products_s_per_pixel": _number(per_pixel),
        "bytes": {
            "frame_per_pixel": _number(kept / flown),
            "clouds_per_pixel": _number(sum(sizes[name] for name in CLOUDS) / flown),
            "rasters_per_cell": _number(sum(sizes[name] for name in RASTERS) / cells),
            "raw_per_pixel_and_bin": _number(_raw_bytes(scenario, mission)),
        },
    }


def _sized(frames: int) -> Scenario:
    return _scenario("coastal", SIZED_DEPTH, **{"flight.frames_per_line": frames})


def _written(frames: int, folder: Path) -> float:
    """Fly a run and return the seconds in which its products are written once more."""
    scenario = _sized(frames)
    mission = prepare(scenario)
    fly(scenario, folder, workers=1, mission=mission)
    start = time.process_time()
    fly(scenario, folder, workers=1, mission=mission)
    return time.process_time() - start


def _cells(raster: Path) -> int:
    import rasterio

    with rasterio.open(raster) as file:
        return int(file.width * file.height)


def _raw_bytes(scenario: Scenario, mission: Mission) -> float:
    """Return by how much a frame's file grows with its histograms, for each of their numbers."""
    kept = prepare(scenario.replace(**{"processing.keep_waveforms": "all"}))
    with_raw, without = (len(frame_bytes(fly_frame(m, m.frames[0]))) for m in (kept, mission))
    return (with_raw - without) / (mission.camera.rows * mission.camera.columns * BINS["coastal"])


def _column_error(name: str, illumination: str) -> list[float]:
    """Return the column's relative error in a flash at `_error_depths`."""
    scenario = _scenario(name, BOTTOMLESS, **{"laser.illumination": illumination})
    mission = prepare(scenario)
    pose = mission.frames[0].pose
    flashes = [mission.engine.flash(pose=pose, frame=number) for number in range(ERROR_FLASHES)]
    column = np.mean([flash.origin("column") for flash in flashes], axis=(0, 1, 2))
    errors = [np.sqrt(_neighbourly(flash.variance.sum(axis=0))) for flash in flashes]
    relative = np.median(np.concatenate(errors), axis=(0, 1)) / np.maximum(column, FAINTEST)
    height = pose.position[2] - mission.engine.surface.level
    depth = (0.5 * speed_of_light * flashes[0].times - height) / mission.engine.water.group_index
    return _rounded(np.interp(_error_depths(name), depth, relative))


def _neighbourly(variance: NDArray[np.float32]) -> FloatArray:
    """Return the variance as thresholds take it, see `survey.cloud.noise`."""
    smooth = uniform_filter(variance, size=(NEIGHBOURS, NEIGHBOURS, 1))
    return np.asarray(np.maximum(smooth, 0.0), np.float64)


def _error_depths(name: str) -> FloatArray:
    return np.asarray(np.arange(1, 17) * ERROR_DEPTHS[name])


def _rounded(values: FloatArray) -> list[float]:
    return [_number(value) for value in values]


def _number(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


if __name__ == "__main__":
    place = resources.files("survey.planning") / "data" / "run_costs.json"
    Path(str(place)).write_text(as_text(costs()), encoding="utf-8")

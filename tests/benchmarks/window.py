"""How fast the window turns a large cloud, drawn without a graphics card.

    python tests/benchmarks/window.py [--points 10000000] [--pictures 60] [--json]

Points lie as flashes of 64 x 32 pixels lay them, 1.6 m apart along lines over a seabed known by a
formula. The view orbits at 1280 x 720 pixels as a user turns it: every picture goes through the
window's own drag, and so through its choice of points. Told are milliseconds a picture while it
moves and once it rests, all on this machine as it is loaded now.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Cause, PointClass, PointCloud
from terrain.map_frame import MapFrame
from viewer.desktop.content import Content
from viewer.rendering import require_rendering
from viewer.run_folder import FlownSurvey

ROWS, COLUMNS, SPACING, HEIGHT = 32, 64, 1.6, 200.0
FRAMES_PER_LINE = 100
SIZE = (1280, 720)
WARM_UP = 20


def made_survey(points: int) -> FlownSurvey:
    """Return a survey of so many bottom points, rounded up to whole flashes."""
    frames = -(-points // (ROWS * COLUMNS))
    frame, row, column = (i.ravel() for i in np.mgrid[0:frames, 0:ROWS, 0:COLUMNS])
    line, step = np.divmod(np.arange(frames), FRAMES_PER_LINE)
    centre = np.column_stack([COLUMNS * SPACING * step, ROWS * SPACING * line]).astype(np.float64)
    lot = np.random.default_rng(0)
    x = centre[frame, 0] + SPACING * (column - COLUMNS / 2) + lot.normal(0.0, 0.05, frame.size)
    y = centre[frame, 1] + SPACING * (row - ROWS / 2) + lot.normal(0.0, 0.05, frame.size)
    true = -11.0 + 6.0 * np.sin(x / 900.0) + 2.0 * np.sin(y / 70.0)
    cloud = _cloud(np.column_stack([x, y, true + lot.normal(0.0, 0.05, frame.size)]), true)
    address = {"frame": frame.astype(np.uint32), "line": line[frame].astype(np.uint16)}
    bottom = PointCloud(**{**cloud.columns(), **address})
    level = np.column_stack([x, y, np.zeros(frame.size)])
    return FlownSurvey(
        title=f"{frame.size / 1e6:.1f} million points",
        description="",
        water_level=0.0,
        bottom=bottom,
        surface=PointCloud(**{**bottom.columns(), "position": level}),
        positions=np.column_stack([centre, np.full(frames, HEIGHT)]),
        headings=np.full(frames, np.pi / 2.0),
        frame=np.arange(frames),
        line=line,
        map_frame=MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714),
    )


def _cloud(place: NDArray[np.float64], true: NDArray[np.float64]) -> PointCloud:
    """Return a cloud with one row for what no picture of it shows."""
    n = len(place)

    def same(value: Any, dtype: Any) -> NDArray[Any]:
        return np.broadcast_to(np.asarray(value, dtype), (n, *np.shape(value)))

    numbers = ("water_path", "reflectance", "true_reflectance", "counts", "snr")
    return PointCloud(
        position=place,
        uncorrected=place,
        truth=place,
        true_surface=place,
        true_elevation=true,
        surface_elevation=same(0.0, np.float64),
        true_normal=same([0.0, 0.0, 1.0], np.float32),
        classification=same(PointClass.BATHYMETRIC, np.uint8),
        true_classification=same(PointClass.BATHYMETRIC, np.uint8),
        substrate=same(0, np.uint8),
        cause=same(Cause.RANGE_NOISE, np.uint8),
        tvu=same(0.2, np.float32),
        thu=same(1.0, np.float32),
        time=same(0.0, np.float64),
        depth=-place[:, 2],
        frame=same(0, np.uint32),
        line=same(0, np.uint16),
        row=same(0, np.uint16),
        column=same(0, np.uint16),
        **{name: same(20.0, np.float32) for name in numbers},
    )


def measure(points: int, pictures: int) -> dict[str, Any]:
    """Return what opening and turning such a survey takes."""
    require_rendering()
    import pyvista

    from viewer.desktop.window import Window

    flown = made_survey(points)
    begun = time.monotonic()
    plotter = pyvista.Plotter(off_screen=True, window_size=list(SIZE))
    window = Window(plotter, Content.of(flown), pictures=Path.cwd())
    plotter.show(auto_close=False, interactive=False)
    opened = time.monotonic() - begun
    turns = []
    for number in range(WARM_UP + pictures):
        begun = time.monotonic()
        window.drag(8.0, 1.0 if number % 20 < 10 else -1.0, move=False)
        turns.append(time.monotonic() - begun)
    begun = time.monotonic()
    window.become(window.state)
    rested = time.monotonic() - begun
    drawn = window.stage.paces
    window.charts.close()
    milliseconds = 1000.0 * np.array(turns[WARM_UP:])
    return {
        "points": len(flown.bottom),
        "open_s": round(opened, 1),
        "moving_ms_median": round(float(np.median(milliseconds)), 1),
        "moving_ms_95": round(float(np.percentile(milliseconds, 95.0)), 1),
        "moving_points": drawn["moving"].points,
        "resting_ms": round(1000.0 * rested, 1),
        "resting_points": drawn["resting"].points,
        "peak_memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
        "load": round(os.getloadavg()[0], 1),
    }


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=10_000_000)
    parser.add_argument("--pictures", type=int, default=60)
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args()
    found = measure(chosen.points, chosen.pictures)
    text = "\n".join(f"{name:18} {value}" for name, value in found.items())
    print(json.dumps(found) if chosen.json else text)


if __name__ == "__main__":
    main()

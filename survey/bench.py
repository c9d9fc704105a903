"""How fast the engine is, at an error that is measured from repeated flashes."""

from __future__ import annotations

import os
import platform
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from survey.bench_merit import figure_of_merit
from survey.flight.pose import Frame
from survey.mission import fly_frame
from survey.preparation import Mission, prepare
from survey.products.frame_file import frame_bytes
from survey.scenario.scenario import Scenario

FLASHES = 16
GATE_BINS = 10
TARGET_ERROR = 0.05
MERIT_CASE = "coastal 10 m"
MERIT_CHANGES = {"receiver.aperture_radius_m": 0.1, "transport.tracks_per_replicate": 8192}
"""What the comparison with the textbook engine changes of its case.

A wider receiver is in that engine's favour: its giant scores are smaller, and thirty flashes meet
them. All pixels together err by the tracks that they share, so there are more.
"""
SPACING_M = 1.23  # of a mesh that then has 100,000 triangles


@dataclass(frozen=True, kw_only=True)
class Case:
    """A water, a depth, and the work that gives about 5 % error a pixel.

    Where the bottom takes many walks, fewer points light the column: its error is then that of the
    other cases. Light that scatters often goes along more ``tracks`` in a replicate. ``surface``
    holds further keys of that section.
    """

    water: str
    depth_m: float
    walks_per_pixel: int
    column_spacing: float = 1.0
    tracks: int = 1024
    surface: dict[str, Any] = field(default_factory=dict)


WIND_WAVES = {
    "wind_speed_m_s": 5.0,
    "whitecaps": True,
    "waves": {"spectrum": "jonswap", "fetch_km": 20.0},
}
CASES = {
    "clear 20 m": Case(water="clear", depth_m=20.0, walks_per_pixel=20),
    "coastal 10 m": Case(water="coastal", depth_m=10.0, walks_per_pixel=20),
    "coastal 10 m, waves": Case(
        water="coastal", depth_m=10.0, walks_per_pixel=144, surface=WIND_WAVES
    ),
    "coastal 20 m": Case(water="coastal", depth_m=20.0, walks_per_pixel=56, column_spacing=2.5),
    "harbor 4 m": Case(water="harbor", depth_m=4.0, walks_per_pixel=56, tracks=2048),
}


def bench(*, threads: int = 0, merit: bool = False) -> Iterator[tuple[str, dict[str, Any]]]:
    """Measure the cases one after the other; yields name and figures.

    Figures of a case: ``seconds_per_frame`` of all threads together; ``error``, the standard
    deviation of sixteen flashes over their mean in the 10 ns around the bottom's peak, root mean
    square over all pixels; ``frames_per_second_at_5_percent``, the rate times (5 % / error)^2;
    ``frames_per_second_end_to_end`` with detection, ranging and the frame's file, at the measured
    error; ``ns_per_scattering``, all processor time of a flash shared out over the scatterings on
    its light paths; ``memory_mb``, the most that the arrays of one flash take.

    Parameters
    ----------
    threads : int
        Flashes at once; 0 is one for each core.
    merit : bool
        Compare with the textbook engine, too, in coastal water 10 m deep
        (`survey.bench_merit.figure_of_merit`): some ten minutes on two cores.
    """
    workers = threads or os.cpu_count() or 1
    for name, case in CASES.items():
        figures = _measured(prepare(bench_scenario(case)), workers)
        if merit and name == MERIT_CASE:
            scenario = bench_scenario(case, **MERIT_CHANGES)
            figures |= figure_of_merit(scenario=scenario, threads=threads)
        yield name, figures


def machine(*, threads: int = 0) -> dict[str, Any]:
    """Return what the figures were measured on."""
    libraries = ("bathyflash", "numpy", "numba")
    return {
        "machine": platform.machine(),
        "system": platform.platform(),
        "threads": threads or os.cpu_count() or 1,
        "versions": {"python": sys.version.split()[0]}
        | {library: metadata.version(library) for library in libraries},
    }


def _measured(mission: Mission, workers: int) -> dict[str, Any]:
    engine, pose = mission.engine, mission.frames[0].pose
    frames = [
        Frame(index=number, line=0, time=float(number), pose=pose) for number in range(FLASHES)
    ]

    def flash(frame: Frame) -> Any:
        return engine.flash(pose=pose, frame=frame.index).origin("bottom").astype(np.float32)

    flash(frames[0])
    seconds, echoes = _timed(flash, frames, workers)
    frame_bytes(fly_frame(mission, frames[0]))
    whole_seconds, _ = _timed(lambda frame: frame_bytes(fly_frame(mission, frame)), frames, workers)
    error = _gate_error(np.stack(echoes))
    return {
        "seconds_per_frame": seconds,
        "error": error,
        "frames_per_second_at_5_percent": (TARGET_ERROR / error) ** 2 / seconds,
        "frames_per_second_end_to_end": 1.0 / whole_seconds,
        "ns_per_scattering": _nanoseconds_per_scattering(mission),
        "memory_mb": _megabytes(mission),
    }


def _timed(
    work: Callable[[Frame], Any], frames: list[Frame], workers: int
) -> tuple[float, list[Any]]:
    start = time.perf_counter()
    with ThreadPoolExecutor(workers) as pool:
        results = list(pool.map(work, frames))
    return (time.perf_counter() - start) / len(frames), results


def _gate_error(echoes: Any) -> float:
    """Return the relative error in the 10 ns around each pixel's peak, root mean square."""
    peak = echoes.mean(axis=0).argmax(axis=-1)[..., None]
    gate = np.clip(peak + np.arange(GATE_BINS) - GATE_BINS // 2, 0, echoes.shape[-1] - 1)
    counts = np.take_along_axis(echoes, gate[None], axis=-1).sum(axis=-1)
    relative = counts.std(axis=0, ddof=1) / counts.mean(axis=0)
    return float(np.sqrt(np.mean(relative**2)))


def _nanoseconds_per_scattering(mission: Mission) -> float:
    start = time.thread_time()
    flash = mission.engine.flash(pose=mission.frames[0].pose, frame=0)
    return 1e9 * (time.thread_time() - start) / flash.scatterings


def _megabytes(mission: Mission) -> float:
    tracemalloc.start()
    mission.engine.flash(pose=mission.frames[0].pose, frame=0)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return most / 1e6


def bench_scenario(case: Case, **values: Any) -> Scenario:
    """Return a level sea bed of 100,000 triangles under one flash by day, some ``values`` changed.

    A micrometre of roughness makes the generator mesh it.
    """
    tables = {
        "mission": {"title": "bench"},
        "flight": {
            "start_easting_m": 500000.0,
            "start_northing_m": 6000000.0,
            "heading_deg": 0.0,
            "frames_per_line": 1,
        },
        "receiver": {"source": "assumed", "aperture_radius_m": 0.005, "filter_width_nm": 1.0},
        "detector": {
            "source": "assumed",
            "quantum_efficiency": 0.2,
            "dark_count_rate_hz": 1.0e4,
        },
        "water": {"type": case.water},
        "surface": {"water_level_m": 0.0} | case.surface,
        "seabed": {
            "kind": "plane",
            "depth_m": case.depth_m,
            "spacing_m": SPACING_M,
            "roughness_rms_m": 1e-6,
        },
        "transport": {
            "walks_per_pixel": case.walks_per_pixel,
            "tracks_per_replicate": case.tracks,
            "column_spacing": case.column_spacing,
        },
    }
    plain = Scenario.from_tables(tables, name="bench", folder=Path(tempfile.gettempdir()))
    return plain.replace(**values)

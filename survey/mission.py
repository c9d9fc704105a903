"""A mission: every flash from laser to points, then all of them to products."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from survey.cloud.error_causes import with_causes
from survey.cloud.frame_points import bottom_points, find_water, surface_points
from survey.cloud.georeference import pixel_rays
from survey.cloud.ranging import blind_at, first_echo
from survey.cloud.record import pixel_record
from survey.cloud.truth import true_targets
from survey.cloud.uncertainty import Surroundings
from survey.errors import UserError
from survey.flight.pose import Frame
from survey.preparation import Mission, prepare
from survey.products.frame_file import FrameResult
from survey.products.observation import Observation
from survey.products.performance import Stopwatch, write_performance
from survey.products.run_products import write_products
from survey.products.verdict.words import verdict_lines
from survey.progress import Unwatched, Watcher
from survey.run_folder import RunFolder
from survey.run_lock import require_free, sole_pilot
from survey.run_log import logged
from survey.scenario.scenario import Scenario
from survey.transport.random import COUNTS, chance


def fly_frame(mission: Mission, frame: Frame) -> FrameResult:
    """Fly one flash and return what a run keeps: points, and the truth beside them."""
    return observe(mission, frame).result


def observe(mission: Mission, frame: Frame) -> Observation:
    """Fly one flash: expected light, readings, ranges, points, and the truth beside them."""
    engine, surface = mission.engine, mission.sea.at(frame.time)
    noise = mission.noise_at(frame.measured, time=frame.time)
    waveforms = engine.flash(pose=frame.pose, frame=frame.index, time=frame.time)
    draws = chance(seed=engine.seed, purpose=COUNTS, frame=frame.index)
    readings = mission.detector.read(waveforms.total + noise.steady_light, draws)

    rays = pixel_rays(camera=mission.camera, pose=frame.measured)
    first = first_echo(counts=readings.counts, noise=noise)
    first = mission.scattering().on_time(first, rays)
    line = find_water(
        first=first,
        frame=frame,
        rays=rays,
        expected_level=mission.expected_level(frame.time),
        refractive_index=engine.water.refractive_index,
        wave_height=surface.wave_height,
    )
    line, unknown = mission.refraction.applied(
        line, first=first, frame=frame, rays=rays, pulse_sigma=mission.budget.pulse_sigma
    )
    search = mission.search.over(
        noise=noise,
        variance=waveforms.variance[:2].sum(axis=0),
        surface_time=line.surface_time,
    )
    bottom = search.echo(readings.counts)

    targets = true_targets(
        seabed=mission.seabed,
        surface=surface,
        water=engine.water,
        pose=frame.pose,
        rays=pixel_rays(camera=mission.camera, pose=frame.pose),
        time=frame.time,
    )
    on_surface = surface_points(line=line, first=first, frame=frame, targets=targets)
    on_bottom = bottom_points(
        line=line,
        first=first,
        bottom=bottom,
        frame=frame,
        rays=rays,
        targets=targets,
        seabed=mission.seabed,
        group_index=engine.water.group_index,
        scattering=mission.scattering(),
    )
    around = Surroundings(
        frame=frame,
        rays=rays,
        line=line,
        unknown=unknown,
        scattering=mission.scattering(),
        first=first,
        bottom=bottom,
    )
    on_surface, on_bottom = (
        with_causes(
            mission.calibration.applied(mission.budget.applied(cloud, around), frame=frame),
            budget=mission.budget,
            around=around,
            true_pose=frame.pose,
            true_level=surface.level,
            targets=targets,
        )
        for cloud in (on_surface, on_bottom)
    )
    record = pixel_record(
        waveforms=waveforms,
        saturated=blind_at(blind=readings.blind, time=targets.time, noise=noise),
        points=on_bottom,
        targets=targets,
        noise=noise,
        search=search,
        water=engine.water,
    )
    raw = mission.raw_of(readings)
    return Observation(
        frame=frame,
        waveforms=waveforms,
        readings=readings,
        noise=noise,
        first=first,
        bottom=bottom,
        targets=targets,
        result=FrameResult(bottom=on_bottom, surface=on_surface, record=record, raw=raw),
    )


def fly(
    scenario: Scenario,
    folder: Path,
    *,
    workers: int = 0,
    frames: range | None = None,
    refly: bool = False,
    watch: Watcher | None = None,
) -> Path:
    """Fly a mission into a run folder, and go on where an earlier run of it stopped.

    Parameters
    ----------
    scenario : Scenario
        What to fly.
    folder : Path
        Run folder: new, or of the same scenario.
    workers : int
        Frames flown at once; 0 is one for each core. The products do not depend on it.
    frames : range, optional
        Only these frames; the products cover all frames that are then present.
    refly : bool
        Remove what an earlier run left in the folder, whatever it was a run of.
    watch : Watcher, optional
        Is told of the progress; ``log.txt`` in the folder is too.

    Returns
    -------
    Path
        The run folder.

    Raises
    ------
    OtherRunError
        When the folder belongs to another scenario or to other code.
    BusyRunError
        At once, when another process flies into the folder.
    ValueError
        When the flight leaves the seabed, or nothing at all was found: the text says why.
    """
    require_free(folder)
    mission = prepare(scenario)
    run = RunFolder.open(folder, scenario, refly=refly)
    with sole_pilot(folder), logged(folder, watch or Unwatched()) as told:
        _fly_missing(mission, run, workers=workers, frames=frames, watch=told)
        found = _write_products(mission, run, told)
        told.finished(summary(folder, found))
    return folder


def _fly_missing(
    mission: Mission, run: RunFolder, *, workers: int, frames: range | None, watch: Watcher
) -> None:
    """Fly the chosen frames that are not whole."""
    clock = Stopwatch()
    chosen = set(frames if frames is not None else range(len(mission.frames)))
    missing = [f for f in mission.frames if f.index in chosen and f.index not in run.whole]
    for index in sorted(chosen & set(run.spoilt)):
        watch.noticed(f"frame {index} is flown again: {run.spoilt[index]}")
    watch.started(len(missing))
    for index, result, seconds in fly_frames(mission, missing, workers):
        run.keep(index, result)
        clock.add(seconds)
        watch.frame_done(index, seconds)
    write_performance(run.path / "performance.json", clock)


def _write_products(mission: Mission, run: RunFolder, watch: Watcher) -> dict[str, Any]:
    """Write the products of all frames that are whole, and return the metrics."""
    present = [frame for frame in mission.frames if frame.index in run.whole]
    if not present:
        raise UserError(f"{run.path}: no frame was flown. Choose frames with --frames A:B")
    return write_products(
        run.path,
        read=run.frame,
        frames=present,
        seabed=mission.seabed,
        settings=mission.products,
        watch=watch,
    )


def summary(folder: Path, metrics: dict[str, object]) -> str:
    """Return what a run achieved in a few lines for the user."""
    return "\n".join(
        (
            f"{metrics['points_bottom']} bottom points, {metrics['points_surface']} surface points",
            f"bottom against the true seabed: bias {_metres(metrics['bias_m'])}, "
            f"95 % within {_metres(metrics['p95_abs_error_m'])}, "
            f"false bottoms {metrics['false_bottoms']}",
            f"uncertainty, 95 %: vertical {_metres(metrics['tvu_median_m'])} holds for "
            f"{_share(metrics['tvu_coverage'])}, horizontal {_metres(metrics['thu_median_m'])} for "
            f"{_share(metrics['thu_coverage'])} of the points",
            *verdict_lines(metrics),
            f"written to {folder}: report.html, bottom.laz, bathymetry.tif and others",
        )
    )


def _metres(value: object) -> str:
    return f"{value:.3f} m" if isinstance(value, float) else "not measured"


def _share(value: object) -> str:
    return f"{100.0 * value:.1f} %" if isinstance(value, float) else "none"


def fly_frames(
    mission: Mission, frames: Sequence[Frame], workers: int = 0
) -> Iterator[tuple[int, FrameResult, float]]:
    """Yield frames as they are done: number, result, seconds that it took.

    So many ``workers`` fly at once, 0 is one for each core; the kernels run without the
    interpreter lock.
    """

    def timed(frame: Frame) -> tuple[int, FrameResult, float]:
        start = time.perf_counter()
        return frame.index, fly_frame(mission, frame), time.perf_counter() - start

    pool = ThreadPoolExecutor(workers or os.cpu_count() or 1)
    try:
        for flown in as_completed([pool.submit(timed, frame) for frame in frames]):
            yield flown.result()
    finally:
        pool.shutdown(cancel_futures=True)

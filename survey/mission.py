"""A mission: every flash from laser to points, then all of them to products."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from survey.cloud.error_causes import with_causes
from survey.cloud.frame_points import bottom_points, find_water, surface_points
from survey.cloud.georeference import pixel_rays
from survey.cloud.points import PointCloud
from survey.cloud.ranging import blind_at, first_echo
from survey.cloud.record import pixel_record
from survey.cloud.second_look import second_echo, weak_points
from survey.cloud.truth import TrueTargets, true_targets
from survey.cloud.uncertainty import Surroundings
from survey.crew.hire import local_crew
from survey.crew.outcome import Crew, Failed, Work
from survey.crew.patience import patiently
from survey.errors import FrameError, UserError
from survey.far_work import FarWork
from survey.flight.pose import Frame, Pose
from survey.preparation import Mission, prepare
from survey.products.frame_file import FrameResult, frame_bytes
from survey.products.observation import Observation
from survey.products.performance import Stopwatch, write_performance
from survey.products.report.sample import typical_pixel
from survey.products.run_products import write_products
from survey.progress import Unwatched, Watcher
from survey.run_folder import RunFolder
from survey.run_identity import found_manifest
from survey.run_lock import require_free, sole_pilot
from survey.run_log import logged
from survey.run_summary import summary
from survey.scenario.scenario import Scenario
from survey.soundness import sound
from survey.transport.random import COUNTS, chance

COMPILING = "the light engine is compiled first, once for each version: a minute or two"


def fly_frame(mission: Mission, frame: Frame) -> FrameResult:
    """Fly one flash and return what a run keeps: points, and the truth beside them."""
    return sound(observe(mission, frame)).result


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
    weak = second_echo(search, counts=readings.counts, bottom=bottom, rate=mission.second_look_rate)

    targets = true_targets(
        seabed=mission.seabed,
        surface=surface,
        water=engine.water,
        pose=frame.pose,
        rays=pixel_rays(camera=mission.camera, pose=frame.pose),
        time=frame.time,
    )
    on_surface = surface_points(line=line, first=first, frame=frame, targets=targets)
    placed = partial(
        bottom_points,
        line=line,
        first=first,
        frame=frame,
        rays=rays,
        camera=mission.camera,
        targets=targets,
        seabed=mission.seabed,
        group_index=engine.water.group_index,
        scattering=mission.scattering(),
        calibration=mission.calibration,
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
    judged = partial(
        _judged, mission, true_pose=frame.pose, true_level=surface.level, targets=targets
    )
    on_surface, on_bottom = (judged(cloud, around) for cloud in (on_surface, placed(bottom=bottom)))
    candidates = None
    if weak is not None:
        doubtful = weak_points(placed(bottom=weak), weak)
        candidates = judged(doubtful, replace(around, bottom=weak), bed=on_bottom)
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
        result=FrameResult(
            bottom=on_bottom, surface=on_surface, record=record, raw=raw, candidates=candidates
        ),
    )


def _judged(
    mission: Mission,
    cloud: PointCloud,
    around: Surroundings,
    *,
    true_pose: Pose,
    true_level: float,
    targets: TrueTargets,
    bed: PointCloud | None = None,
) -> PointCloud:
    """Return points with their uncertainties, reflectance and true causes of error."""
    bright = mission.calibration.applied(cloud, frame=around.frame, scattering=around.scattering)
    told = mission.budget.applied(bright, around, bed=bed)
    return with_causes(
        told,
        budget=mission.budget,
        around=around,
        true_pose=true_pose,
        true_level=true_level,
        targets=targets,
    )


def fly(
    scenario: Scenario,
    folder: str | os.PathLike[str],
    *,
    workers: int = 0,
    crew: Crew | None = None,
    frames: range | None = None,
    refly: bool = False,
    watch: Watcher | None = None,
    mission: Mission | None = None,
) -> Path:
    """Fly a mission into a run folder, and go on where an earlier run of it stopped.

    A frame that fails is flown again, and after three times set aside: it is named to the watcher,
    in metrics.json and in the report, the rest completes, and a later call tries it again.

    Parameters
    ----------
    scenario : Scenario
        What to fly.
    folder : path
        Run folder: new, or of the same scenario.
    workers : int
        Processes of this machine; 0 is one for each core. The products do not depend on it.
    crew : Crew, optional
        Others than these: `survey.crew` has threads, processes and the workers of a cluster.
    frames : range, optional
        Only these frames; the products cover all frames that are then present.
    refly : bool
        Remove what an earlier run left in the folder, whatever it was a run of.
    watch : Watcher, optional
        Is told of the progress, such as `survey.PlainLines`; ``log.txt`` in the folder is too.
    mission : Mission, optional
        What `survey.preparation.prepare` made of the scenario already.

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
    FrameError
        When every frame failed.
    ValueError
        When the flight leaves the seabed, or nothing at all was found: the text says why.
    """
    path = Path(folder)
    require_free(path)
    mission = mission or prepare(scenario)
    run = RunFolder.open(path, scenario, refly=refly)
    with sole_pilot(path), logged(path, watch or Unwatched()) as told:
        crew = crew or local_crew(workers)
        set_aside = _fly_missing(mission, scenario, run, crew=crew, frames=frames, watch=told)
        found = _write_products(mission, run, set_aside, told)
        told.finished(summary(path, found))
    return path


def _fly_missing(
    mission: Mission,
    scenario: Scenario,
    run: RunFolder,
    *,
    crew: Crew,
    frames: range | None,
    watch: Watcher,
) -> dict[int, str]:
    """Fly the chosen frames that are not whole, and return why some could not be flown."""
    clock, set_aside = Stopwatch(), dict[int, str]()
    chosen = set(frames if frames is not None else range(len(mission.frames)))
    missing = [f.index for f in mission.frames if f.index in chosen and f.index not in run.whole]
    for index in sorted(chosen & set(run.spoilt)):
        watch.noticed(f"frame {index} is flown again: {run.spoilt[index]}")
    watch.started(len(missing))
    if missing and not mission.engine.compiled_before():
        watch.noticed(COMPILING)
    if missing and crew.shares_memory:
        mission.scattering()
    elif missing:
        watch.noticed(f"flown by {crew.described}")
    with closing(patiently(crew, _work(mission, scenario, crew), missing)) as outcomes:
        for outcome in outcomes:
            if isinstance(outcome, Failed):
                set_aside[outcome.index] = outcome.reason
                watch.noticed(
                    f"frame {outcome.index} is set aside, it failed three times: {outcome.reason}"
                )
                continue
            run.keep(outcome.index, outcome.result)
            clock.add(outcome.seconds)
            watch.frame_done(outcome.index, outcome.seconds)
    write_performance(run.path / "performance.json", clock)
    return set_aside


def _work(mission: Mission, scenario: Scenario, crew: Crew) -> Work[bytes]:
    """Return what a crew does for a frame: on this machine, or where it must prepare itself."""
    if crew.shares_memory:
        return partial(frame_file, mission)
    return FarWork.of(scenario, frame_file)


def frame_file(mission: Mission, index: int) -> bytes:
    """Fly one flash and return the content of its file."""
    return frame_bytes(fly_frame(mission, mission.frames[index]))


def _write_products(
    mission: Mission, run: RunFolder, set_aside: Mapping[int, str], watch: Watcher
) -> dict[str, Any]:
    """Write the products of all frames that are whole, and return the metrics."""
    present = [frame for frame in mission.frames if frame.index in run.whole]
    if not present and set_aside:
        index, reason = min(set_aside.items())
        raise FrameError(f"{run.path}: no frame could be flown; frame {index}: {reason}")
    if not present:
        raise UserError(f"{run.path}: no frame was flown. Choose frames with --frames A:B")
    pixel = typical_pixel(run.frame, present)
    return write_products(
        run.path,
        read=run.frame,
        frames=present,
        seabed=mission.seabed,
        settings=mission.products,
        sample=pixel.figure(observe(mission, pixel.frame)) if pixel else None,
        manifest=found_manifest(run.path),
        set_aside=set_aside,
        watch=watch,
    )


def fly_frames(
    mission: Mission, frames: Sequence[Frame], workers: int = 0
) -> Iterator[tuple[int, FrameResult, float]]:
    """Yield frames as they are done: number, result, seconds that it took.

    So many threads fly at once, 0 is one for each core; the kernels run without the interpreter
    lock.

    Raises
    ------
    FrameError
        When a frame fails.
    """
    by_number = {frame.index: frame for frame in frames}
    crew = local_crew(workers, "threads")
    for outcome in crew.fly(lambda index: fly_frame(mission, by_number[index]), by_number):
        if isinstance(outcome, Failed):
            raise FrameError(f"frame {outcome.index}: {outcome.reason}")
        yield outcome.index, outcome.result, outcome.seconds

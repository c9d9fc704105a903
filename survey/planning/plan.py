"""The plan of a scenario: all that can be said before any light is traced."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.flight.pose import Frame
from survey.planning.expectation import Expectation, expectation
from survey.planning.eye_safety import EyeSafety, eye_safety
from survey.planning.gaps import Swath, swath
from survey.planning.overlap import (
    Overlap,
    between,
    flight_directions,
    one_after_another,
    overlap,
    side_by_side,
    triangles,
)
from survey.planning.run_costs import RunSize, output_bytes, run_seconds
from survey.planning.views import SAMPLES_ON_EDGE, Ground, UnderWater, Views, WaterSurface, views
from survey.preparation import ABREAST, MODEL_FLASHES, RAW_STEPS
from survey.scenario import components
from survey.scenario.scenario import Scenario
from survey.sensor.camera import Camera
from terrain.coverage import CoverageError
from terrain.map_frame import MapFrame
from terrain.seabed import Seabed

TABLE_DEPTHS = 7  # as a rule, see `survey.expected_errors`

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Coverage:
    """What the frames see of one ground.

    Parameters
    ----------
    views : Views
    forward, side : Overlap, optional
        Of frames one after another and side by side; None where there are no such pairs.
    swath : Swath
        What is seen and what is not.
    """

    views: Views
    forward: Overlap | None
    side: Overlap | None
    swath: Swath


@dataclass(frozen=True, kw_only=True)
class SurveyPlan:
    """What a flight comes to.

    Parameters
    ----------
    title : str
    map_frame : MapFrame
    frames : sequence of Frame
        With their true poses.
    height : float
        Median height above the water [m].
    pixels : int
        Of a frame.
    surface, bottom, bottom_in_air : Coverage
        At the water surface; on the seabed by bent rays, and by the straight rays of
        [Lisenko2017].
    area : array (n, 2), optional
        What the flight was ordered to cover [m, local].
    depth : (float, float, float)
        Least, median and greatest depth at the outlines of the views [m]; nan where all is dry.
    expectation : Expectation
        How deep the bottom may lie.
    eye : EyeSafety
    wave_height : float
        Significant height of the waves that the plan leaves out [m].
    output_bytes, run_seconds : float
        Of a run [bytes], [s].
    workers : int
        For which the run's time holds.
    seabed_fault : str, optional
        Why a run would refuse the flight.
    """

    title: str
    map_frame: MapFrame
    frames: Sequence[Frame]
    height: float
    pixels: int
    surface: Coverage
    bottom: Coverage
    bottom_in_air: Coverage
    area: FloatArray | None
    depth: tuple[float, float, float]
    expectation: Expectation
    eye: EyeSafety
    wave_height: float
    output_bytes: float
    run_seconds: float
    workers: int
    seabed_fault: str | None

    @property
    def flight_seconds(self) -> float:
        """Time from the first flash to the last [s]."""
        return self.frames[-1].time - self.frames[0].time

    @property
    def flight_length(self) -> float:
        """Length of the lines [m]."""
        place = np.array([frame.pose.position[:2] for frame in self.frames])
        line = np.array([frame.line for frame in self.frames])
        steps = np.linalg.norm(np.diff(place, axis=0), axis=1)
        return float(steps[line[1:] == line[:-1]].sum())

    @property
    def lines(self) -> int:
        """Survey lines."""
        return len({frame.line for frame in self.frames})

    @property
    def density(self) -> float:
        """Pixels for each square metre of the seabed that is seen [1/m2]."""
        seen = self.bottom.swath.seen_area
        return len(self.frames) * self.pixels / seen if seen > 0.0 else 0.0

    @property
    def frame_density(self) -> float:
        """Pixels for each square metre of a single frame on the seabed [1/m2]; nan on none."""
        areas = self.bottom.views.areas()
        known = areas[np.isfinite(areas)]
        return self.pixels / float(np.median(known)) if known.size else float("nan")


def make_plan(scenario: Scenario) -> SurveyPlan:
    """Plan a scenario.

    Raises
    ------
    FileNotFoundError, ValueError
        When seabed or flight cannot be built; a line for each fault.
    """
    camera, surface = components.camera(scenario), components.sea_surface(scenario)
    frames, seabed = components.frames(scenario), components.seabed(scenario)
    water = components.water(scenario)
    bent, straight = (
        UnderWater(grid=seabed.grid, level=surface.level, refractive_index=index)
        for index in (water.refractive_index, 1.0)
    )
    area = components.survey_area(scenario)
    at_surface = _coverage(camera, frames, WaterSurface(level=surface.level), area)
    bottom, in_air = (_coverage(camera, frames, ground, area) for ground in (bent, straight))
    depth = _depths(bottom.views, surface.level)
    height = float(np.median([frame.pose.position[2] for frame in frames]) - surface.level)
    size = RunSize(
        frames=len(frames),
        pixels=camera.rows * camera.columns,
        bins=scenario.receiver.bins,
        walks_per_pixel=scenario.transport.walks_per_pixel,
        scattering_depth=float(water.scattered(np.nan_to_num(depth[1]))),
        model_frames=_model_frames(scenario),
        area=bottom.swath.seen_area,
        grid=scenario.processing.grid_m,
        waveform_step=RAW_STEPS[scenario.processing.keep_waveforms],
    )
    workers = scenario.run.workers or os.cpu_count() or 1
    return SurveyPlan(
        title=scenario.mission.title,
        map_frame=seabed.map_frame,
        frames=frames,
        height=height,
        pixels=camera.rows * camera.columns,
        surface=at_surface,
        bottom=bottom,
        bottom_in_air=in_air,
        area=area,
        depth=depth,
        expectation=expectation(scenario, seabed=seabed, height=height),
        eye=_eye(scenario, camera, height),
        wave_height=surface.wave_height,
        output_bytes=output_bytes(size),
        run_seconds=run_seconds(size, workers=workers),
        workers=workers,
        seabed_fault=_seabed_fault(seabed, at_surface.views),
    )


def _model_frames(scenario: Scenario) -> int:
    """Return the flashes in turn for noise model and table of scattering; two fly abreast."""
    table = TABLE_DEPTHS if scenario.processing.correct_scattering else 0
    return MODEL_FLASHES // ABREAST + table


def _coverage(
    camera: Camera, frames: Sequence[Frame], ground: Ground, area: FloatArray | None
) -> Coverage:
    """Return what frames see; without an area, all that lies between neighbours is to be seen."""
    seen = views(camera, frames, ground)
    following, beside = one_after_another(frames), side_by_side(frames, seen)
    inner = [*between(following, seen), *between(beside, seen)]
    inner += triangles(following, beside, seen)
    return Coverage(
        views=seen,
        forward=overlap(following, seen),
        side=overlap(beside, seen),
        swath=swath(
            seen.polygons(),
            inner if area is None else [area],
            direction=flight_directions(frames)[0],
        ),
    )


def _depths(bottom: Views, level: float) -> tuple[float, float, float]:
    depth = level - bottom.outline[..., 2]
    wet = depth[depth > 0.0]
    if wet.size == 0:
        return float("nan"), float("nan"), float("nan")
    return float(wet.min()), float(np.median(wet)), float(wet.max())


def _eye(scenario: Scenario, camera: Camera, height: float) -> EyeSafety:
    flight, detector = scenario.flight, scenario.detector
    return eye_safety(
        laser=components.laser(scenario),
        camera=camera,
        height=height,
        speed=flight.speed_m_s,
        flash_rate=flight.flash_rate_hz,
        burst=detector.pulses_per_frame,
        burst_rate=detector.burst_rate_hz,
    )


def _seabed_fault(seabed: Seabed, at_surface: Views) -> str | None:
    try:
        seabed.require_coverage(list(at_surface.outline[:, ::SAMPLES_ON_EDGE, :2]))
    except CoverageError as fault:
        return str(fault)
    return None

"""Surveys and single looks made by hand, without light, for the tests of clouds and products."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.echo import Echo
from survey.cloud.georeference import pixel_rays
from survey.cloud.points import Outcome, PixelRecord, PointClass, PointCloud
from survey.cloud.reflectance import Calibration
from survey.cloud.truth import TrueTargets, true_targets
from survey.flight.pose import Frame, Pose
from survey.optics.water import WaterColumn, petzold_water
from survey.sensor.camera import Camera
from terrain.generators import Ground, slope
from terrain.map_frame import MapFrame
from terrain.sea_surface import SeaSurface
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]
HEADING = np.radians(70.0)
HEIGHT = 200.0
FORWARD = np.array([np.sin(HEADING), np.cos(HEADING)])
RIGHT = np.array([np.cos(HEADING), -np.sin(HEADING)])


@dataclass(frozen=True, kw_only=True)
class Survey:
    """Lines flown from a beach over a sandbar, each pixel with known truth and known error."""

    frames: list[Frame]
    bottom: PointCloud
    surface: PointCloud
    records: list[PixelRecord]
    map_frame: MapFrame
    water_level: float
    start_utc: datetime

    @staticmethod
    def elevation_at(x: FloatArray, y: FloatArray) -> FloatArray:
        """A beach, a bar 280 m out and a slope down to 9 m."""
        along = x * FORWARD[0] + y * FORWARD[1]
        across = x * RIGHT[0] + y * RIGHT[1]
        slope = 1.6 - 6.5 * np.tanh(along / 220.0) - 0.005 * np.maximum(along - 150.0, 0.0)
        bar = 2.8 * np.exp(-(((along - 290.0 - 12.0 * np.sin(across / 28.0)) / 45.0) ** 2))
        return np.asarray(slope + bar + 0.15 * np.sin(along / 19.0) * np.sin(across / 23.0))


SurveyMaker = Callable[..., Survey]


def make_survey(
    *,
    lines: int = 4,
    frames_per_line: int = 8,
    rows: int = 8,
    columns: int = 16,
    spacing: float = 41.0,
) -> Survey:
    """Return a survey: 64 x 32 pixels of 1.6 m are rows = 32, columns = 64."""
    frames = [
        Frame(
            index=line * frames_per_line + number,
            line=line,
            time=1.0 * number + 60.0 * line,
            pose=Pose(
                position=np.append(100.0 * number * FORWARD + spacing * line * RIGHT, HEIGHT),
                roll=0.0,
                pitch=0.0,
                heading=float(HEADING),
            ),
        )
        for line in range(lines)
        for number in range(frames_per_line)
    ]
    made = [_fly(frame, rows, columns) for frame in frames]
    return Survey(
        frames=frames,
        bottom=PointCloud.concatenate([bottom for bottom, _, _ in made]),
        surface=PointCloud.concatenate([surface for _, surface, _ in made]),
        records=[record for _, _, record in made],
        map_frame=MapFrame(easting=500123.25, northing=6000456.75, epsg=25832, vertical_epsg=5714),
        water_level=0.25,
        start_utc=datetime(2026, 6, 21, 10, 0, 0, tzinfo=UTC),
    )


def _fly(frame: Frame, rows: int, columns: int) -> tuple[PointCloud, PointCloud, PixelRecord]:
    random = np.random.default_rng(frame.index)
    row, column = (index.ravel() for index in np.mgrid[0:rows, 0:columns])
    along = (0.5 - (column + 0.5) / columns) * 102.4
    across = ((row + 0.5) / rows - 0.5) * 51.2
    place = frame.pose.position[:2] + along[:, None] * FORWARD + across[:, None] * RIGHT
    truth = np.column_stack([place, Survey.elevation_at(place[:, 0], place[:, 1])])
    depth = 0.25 - truth[:, 2]
    outcome = np.where(depth > 0.0, Outcome.FOUND, Outcome.DRY).astype(np.uint8)
    outcome[(depth > 7.0) & (random.random(depth.size) < 0.1)] = Outcome.TOO_DEEP
    measured = truth + random.normal(0.0, [0.05, 0.05, 0.08], truth.shape)
    level = np.column_stack([place, np.full(depth.size, 0.25)])
    level[:, 2] += random.normal(0.0, 0.05, depth.size)
    address = {"frame": frame, "row": row, "column": column}
    classes = np.where(depth > 0.0, PointClass.BATHYMETRIC, PointClass.GROUND)
    classes[outcome == Outcome.TOO_DEEP] = PointClass.NO_BOTTOM_FOUND
    measured[outcome == Outcome.TOO_DEEP, 2] = 0.25
    bottom = _cloud(measured, truth, classes, address)
    sea = _cloud(level, level, np.full(depth.size, PointClass.WATER_SURFACE), address)
    surface = replace(sea, true_elevation=np.full(depth.size, 0.25))
    shape = (rows, columns)
    record = PixelRecord(
        true_position=truth.reshape(rows, columns, 3),
        true_depth=depth.reshape(shape),
        detection_probability=np.where(depth > 7.0, 0.85, 0.99).reshape(shape),
        outcome=outcome.reshape(shape),
        bottom_counts=np.full(shape, 500.0),
        monte_carlo_relative_error=np.full(shape, 0.07),
    )
    return bottom, surface.select(depth > 0.0), record


def _cloud(
    position: FloatArray, truth: FloatArray, classes: NDArray[np.int64], address: dict[str, object]
) -> PointCloud:
    frame, n = address["frame"], position.shape[0]
    assert isinstance(frame, Frame)
    return PointCloud(
        position=position,
        uncorrected=position - np.array([0.0, 0.0, 0.3]),
        truth=truth,
        classification=classes.astype(np.uint8),
        true_classification=classes.astype(np.uint8),
        substrate=(np.arange(n) % 3).astype(np.uint8),
        true_elevation=Survey.elevation_at(position[:, 0], position[:, 1]),
        true_surface=np.column_stack([truth[:, :2], np.maximum(truth[:, 2], 0.25)]),
        true_normal=np.tile(np.array([0.0, 0.0, 1.0], np.float32), (n, 1)),
        water_path=np.maximum(0.25 - truth[:, 2], 0.0).astype(np.float32),
        tvu=np.full(n, 0.2, np.float32),
        thu=np.full(n, 1.5, np.float32),
        surface_elevation=np.full(n, 0.25),
        reflectance=np.linspace(0.0, 10.0, n, dtype=np.float32),
        true_reflectance=np.full(n, 0.1, np.float32),
        cause=(np.arange(n) % 7).astype(np.uint8),
        time=np.full(n, frame.time),
        depth=np.maximum(0.25 - position[:, 2], 0.0),
        counts=np.linspace(0.0, 1e5, n, dtype=np.float32),
        snr=np.full(n, 12.5, dtype=np.float32),
        frame=np.full(n, frame.index, dtype=np.uint32),
        line=np.full(n, frame.line, dtype=np.uint16),
        row=np.asarray(address["row"], dtype=np.uint16),
        column=np.asarray(address["column"], dtype=np.uint16),
    )


@pytest.fixture(scope="session")
def survey_of() -> SurveyMaker:
    """The maker of surveys."""
    return make_survey


@pytest.fixture(scope="session")
def small_survey() -> Survey:
    """Four lines of eight frames, 16 x 8 pixels each."""
    return make_survey()


@dataclass(frozen=True, kw_only=True)
class Look:
    """One frame over a known seabed, and where its rays truly end."""

    frame: Frame
    camera: Camera
    seabed: Seabed
    surface: SeaSurface
    water: WaterColumn
    rays: FloatArray
    targets: TrueTargets

    @property
    def calibration(self) -> Calibration:
        """Of light that nothing takes away."""
        return Calibration(
            launched=1e8,
            refractive_index=self.water.refractive_index,
            path=np.array([0.0, 100.0]),
            kept=np.ones(2),
        )

    @staticmethod
    def echo(time: FloatArray) -> Echo:
        """Return echoes at two-way times [s], nan where there is none."""
        there = np.isfinite(time)
        return Echo(
            time=np.where(there, time, np.nan),
            counts=np.where(there, 500.0, np.nan),
            snr=np.where(there, 20.0, np.nan),
            time_error=np.where(there, 1e-10, np.nan),
        )

    @property
    def surface_time(self) -> FloatArray:
        """Two-way times to the water, or to land where it is dry [s]."""
        way = self.targets.surface - self.frame.pose.position
        return np.asarray(2.0 * np.linalg.norm(way, axis=-1) / speed_of_light)


LookMaker = Callable[..., Look]


def make_look(
    *,
    depth: float = 6.0,
    gradient: float = 0.05,
    heading_deg: float = 70.0,
    roll_deg: float = 0.0,
    pitch_deg: float = 0.0,
    long_side: Literal["along", "across"] = "along",
    level: float = 0.4,
    seabed: Seabed | None = None,
) -> Look:
    """Return a look from 200 m at a bed that falls eastwards, ``depth`` below zero at nadir."""
    camera = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side=long_side)
    pose = Pose(
        position=np.array([30.0, -20.0, level + 200.0]),
        roll=np.radians(roll_deg),
        pitch=np.radians(pitch_deg),
        heading=np.radians(heading_deg),
    )
    ground = Ground(
        map_frame=MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714),
        centre=(30.0, -20.0),
        length=400.0,
        width=400.0,
        axis=np.pi / 2.0,
        reflectance=0.1,
    )
    bed = slope(ground=ground, depth=depth, gradient=gradient) if seabed is None else seabed
    surface = SeaSurface.from_wind(level=level, wind_speed=5.0, wind_from=0.0)
    water = WaterColumn.uniform(petzold_water("coastal", refractive_index=1.3415, group_index=1.36))
    rays = pixel_rays(camera=camera, pose=pose)
    return Look(
        frame=Frame(index=7, line=2, time=63.0, pose=pose),
        camera=camera,
        seabed=bed,
        surface=surface,
        water=water,
        rays=rays,
        targets=true_targets(seabed=bed, surface=surface, water=water, pose=pose, rays=rays),
    )


@pytest.fixture(scope="session")
def look_at() -> LookMaker:
    """The maker of looks."""
    return make_look

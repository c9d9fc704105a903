"""Echoes of one frame made into points: water line, classes, corrected and uncorrected places."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from survey.cloud.frame_points import WaterLine, bottom_points, find_water, surface_points
from survey.cloud.points import PointClass, PointCloud
from survey.cloud.scattering import Scattering

Looks = Callable[..., Any]
FloatArray = NDArray[np.float64]
BEACH = {"depth": 0.0, "gradient": 0.11, "heading_deg": 90.0}


def water_line(
    look: Any, first_time: FloatArray, expected_level: float = 0.4, wave_height: float = 0.0
) -> WaterLine:
    return find_water(
        first=look.echo(first_time),
        frame=look.frame,
        rays=look.rays,
        expected_level=expected_level,
        refractive_index=look.water.refractive_index,
        wave_height=wave_height,
    )


def bottom_of(look: Any, bottom_time: FloatArray, first_time: FloatArray) -> PointCloud:
    line = water_line(look, first_time)
    return bottom_points(
        line=line,
        first=look.echo(first_time),
        bottom=look.echo(np.where(np.isfinite(line.surface_time), bottom_time, np.nan)),
        frame=look.frame,
        rays=look.rays,
        camera=look.camera,
        targets=look.targets,
        seabed=look.seabed,
        group_index=look.water.group_index,
        scattering=Scattering.none(),
        calibration=look.calibration,
    )


def grid(cloud: PointCloud, name: str) -> NDArray[Any]:
    column = getattr(cloud, name)
    return np.asarray(column.reshape(32, 64, *column.shape[1:]))


def test_the_level_is_the_median_of_the_surface_echoes(look_at: Looks) -> None:
    look = look_at()
    line = water_line(look, look.surface_time + 1e-9, expected_level=0.0)
    assert line.level == pytest.approx(0.4 - 0.1499, abs=0.003)
    assert line.water.all()
    assert np.abs(line.path.entry[..., 2] - line.level).max() < 1e-9


def test_without_surface_echoes_the_expected_level_stands_and_all_is_water(look_at: Looks) -> None:
    look = look_at()
    time = np.full(look.rays.shape[:2], np.nan)
    time[:1, :19] = look.surface_time[:1, :19]
    line = water_line(look, time, expected_level=0.1)
    assert line.level == 0.1
    assert line.water.all()
    assert np.isfinite(line.surface_time).all()


def test_land_is_told_from_water_by_its_height(look_at: Looks) -> None:
    look = look_at(**BEACH)
    line = water_line(look, look.surface_time)
    height = look.targets.position[..., 2] - 0.4
    assert line.level == pytest.approx(0.4, abs=0.05)
    assert line.land[height > 0.85].all()
    assert not line.land[height < 0.65].any()
    assert line.land.sum() > 300
    assert np.array_equal(np.isfinite(line.surface_time), ~line.land)


def test_crests_of_waves_are_no_land_and_troughs_are_kept(look_at: Looks) -> None:
    """A swell of 1.6 m, significant: crests and troughs of 1.5 m, and a rock of 2.5 m."""
    look = look_at()
    column = np.arange(64)
    height = np.broadcast_to(1.5 * np.sin(0.3 * column), (32, 64)).copy()
    height[:4] = 2.5
    first = look.surface_time + 2.0 * height / look.rays[..., 2] / 299_792_458.0
    line = water_line(look, first, wave_height=1.6)
    assert np.array_equal(line.land, height == 2.5)
    points = surface_points(
        line=line, first=look.echo(first), frame=look.frame, targets=look.targets
    )
    assert len(points) == 28 * 64
    assert points.position[:, 2].min() == pytest.approx(0.4 - 1.5, abs=0.05)
    calm = water_line(look, first)
    assert calm.land[4:].mean() > 0.2


def test_surface_points_lie_on_the_water_and_not_on_land(look_at: Looks) -> None:
    look = look_at(**BEACH)
    first = look.surface_time
    first[3, 5] = np.nan
    first[4, 5] += 20e-9
    line = water_line(look, first)
    cloud = surface_points(
        line=line, first=look.echo(first), frame=look.frame, targets=look.targets
    )
    assert set(cloud.classification) == {PointClass.WATER_SURFACE}
    assert len(cloud) == line.water.sum() - 2
    wet = look.targets.depth[cloud.row, cloud.column] > 0.0
    assert np.array_equal(cloud.true_classification == PointClass.WATER_SURFACE, wet)
    assert np.abs(cloud.position - cloud.truth).max() < 1e-6
    assert np.abs(cloud.position[wet, 2] - cloud.true_elevation[wet]).max() < 1e-6
    assert not cloud.depth.any()


def test_a_frame_of_good_echoes_gives_the_seabed(look_at: Looks) -> None:
    look = look_at(roll_deg=4.0, pitch_deg=-3.0)
    cloud = bottom_of(look, look.targets.time, look.surface_time)
    assert len(cloud) == 32 * 64
    assert set(cloud.classification) == {PointClass.BATHYMETRIC}
    assert np.abs(cloud.position - look.targets.position.reshape(-1, 3)).max() < 1e-6
    assert np.abs(cloud.position[:, 2] - cloud.true_elevation).max() < 1e-6
    assert np.abs(cloud.depth - (0.4 - cloud.position[:, 2])).max() < 1e-6
    assert np.array_equal(cloud.row, np.repeat(np.arange(32), 64))
    assert np.array_equal(cloud.column, np.tile(np.arange(64), 32))
    assert (set(cloud.frame), set(cloud.line)) == ({7}, {2})
    assert np.abs(cloud.time - 63.0 - look.targets.time.ravel()).max() < 1e-12


def test_uncorrected_points_are_deeper_and_further_out(look_at: Looks) -> None:
    look = look_at()
    cloud = bottom_of(look, look.targets.time, look.surface_time)
    apparent, true = 0.4 - cloud.uncorrected[:, 2], cloud.depth
    assert np.all(apparent > 1.3 * true)
    assert np.all(apparent < 1.36 * true + 1e-6)
    nadir = look.frame.pose.position[:2]
    reach = np.linalg.norm(cloud.uncorrected[:, :2] - nadir, axis=1)
    assert np.all(reach > np.linalg.norm(cloud.position[:, :2] - nadir, axis=1))


def test_land_and_missing_bottoms_have_their_classes_and_places(look_at: Looks) -> None:
    look = look_at(**BEACH)
    bottom = look.targets.time.copy()
    bottom[10] = np.nan
    cloud = bottom_of(look, bottom, look.surface_time)
    classes, place = grid(cloud, "classification"), grid(cloud, "position")
    land = water_line(look, look.surface_time).land
    assert np.all(classes[land] == PointClass.GROUND)
    assert np.abs(place - look.targets.position)[land].max() < 1e-6
    assert np.all(grid(cloud, "depth")[land] == 0.0)
    missing = np.zeros(land.shape, bool)
    missing[10] = ~land[10]
    assert missing.any()
    assert np.all(classes[missing] == PointClass.NO_BOTTOM_FOUND)
    assert np.abs(place[missing][:, 2] - 0.4).max() < 0.05
    assert np.array_equal(place[missing], grid(cloud, "uncorrected")[missing])
    assert not grid(cloud, "counts")[missing].any()
    assert np.all(grid(cloud, "time")[missing] == 63.0)
    assert np.all(grid(cloud, "counts")[land] == 500.0)
    assert not np.isin(classes, (PointClass.SUBMERGED_OBJECT, PointClass.WATER_SURFACE)).any()


def test_what_stands_out_of_the_bottom_is_an_object(look_at: Looks) -> None:
    look = look_at(depth=8.0)
    bottom = look.targets.time.copy()
    bottom[12:16, 30:36] -= 20e-9
    bottom[20:24, 30:36] -= 5e-9
    bottom[26:30, 30:36] += 20e-9
    cloud = bottom_of(look, bottom, look.surface_time)
    objects = np.zeros((32, 64), bool)
    objects[12:16, 30:36] = True
    assert np.array_equal(grid(cloud, "classification") == PointClass.SUBMERGED_OBJECT, objects)


def test_a_steep_shallow_bottom_beside_land_is_no_object(look_at: Looks) -> None:
    look = look_at(depth=3.0, gradient=0.15, heading_deg=90.0)
    bottom = np.where(look.targets.depth > 0.0, look.targets.time, np.nan)
    cloud = bottom_of(look, bottom, look.surface_time)
    assert (cloud.classification == PointClass.GROUND).sum() > 100
    assert not np.any(cloud.classification == PointClass.SUBMERGED_OBJECT)

"""Causes of errors: one effect at a time, and it is named; local waves bend the paths."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from survey.cloud.error_causes import with_causes
from survey.cloud.frame_points import bottom_points, find_water
from survey.cloud.points import Cause, PointClass, PointCloud
from survey.cloud.scattering import Scattering
from survey.cloud.uncertainty import Budget, Surroundings
from survey.cloud.wave_statistics import Unknown
from survey.flight.navigation import PoseUncertainty
from survey.sensor.camera import Camera

BUDGET = Budget(
    camera=Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along"),
    pulse_sigma=4.25e-9,
    refractive_index=1.3415,
    group_index=1.36,
    pose=PoseUncertainty(position=(0.05, 0.05, 0.05)),
    level_error=0.2,
)


def points_of(
    look: Any,
    late: float = 0.0,
    raised: float = 0.0,
    moved: float = 0.0,
    scattering: Scattering | None = None,
) -> PointCloud:
    """Return points whose bottom echoes are late [s], whose surface echoes lie too high [m] and
    whose sensor is taken to be too far east [m]."""
    scattering = scattering or Scattering.none()
    pose = replace(look.frame.pose, position=look.frame.pose.position + np.array([moved, 0.0, 0.0]))
    frame = replace(look.frame, navigation=pose)
    early = 2.0 * raised / 299792458.0 / -look.rays[..., 2]
    line = find_water(
        first=look.echo(look.surface_time - early),
        frame=frame,
        rays=look.rays,
        expected_level=0.4,
        refractive_index=1.3415,
    )
    cloud = bottom_points(
        line=line,
        first=look.echo(look.surface_time - early),
        bottom=look.echo(look.targets.time + late),
        frame=frame,
        rays=look.rays,
        camera=BUDGET.camera,
        targets=look.targets,
        seabed=look.seabed,
        group_index=1.36,
        scattering=scattering,
        calibration=look.calibration,
    )
    around = Surroundings(
        frame=frame,
        rays=look.rays,
        line=line,
        unknown=Unknown(height=0.0, slope=0.0),
        scattering=scattering,
        first=look.echo(look.surface_time - early),
        bottom=look.echo(look.targets.time + late),
    )
    return with_causes(
        BUDGET.applied(cloud, around),
        budget=BUDGET,
        around=around,
        true_pose=look.frame.pose,
        true_level=0.4,
        targets=look.targets,
    )


@pytest.mark.parametrize(
    ("error", "cause"),
    [
        ({"late": 1e-10}, Cause.RANGE_NOISE),
        ({"late": 3e-9}, Cause.SCATTERING),
        ({"late": 2e-8}, Cause.FALSE_ECHO),
        ({"raised": 0.4}, Cause.WATER_LEVEL),
        ({"moved": 0.3}, Cause.NAVIGATION),
    ],
)
def test_a_lone_error_is_the_cause(look_at: Any, error: dict[str, float], cause: Cause) -> None:
    cloud = points_of(look_at(gradient=0.0), **error)
    named, count = np.unique(cloud.cause, return_counts=True)
    assert named[count.argmax()] == cause
    assert count.max() > 0.99 * len(cloud)


def test_waves_that_were_taken_for_level_are_the_cause(look_at: Any) -> None:
    look = look_at(gradient=0.0)
    aside = look.targets.position + np.array([0.4, 0.0, 0.0])
    bent = replace(look, targets=replace(look.targets, position=aside))
    assert np.all(points_of(bent).cause == Cause.WAVES)


def test_where_nothing_was_found_nothing_is_uncertain(look_at: Any) -> None:
    look = look_at(gradient=0.0)
    blind = replace(look, targets=replace(look.targets, time=np.full((32, 64), np.nan)))
    cloud = points_of(blind)
    assert np.all(cloud.classification == PointClass.NO_BOTTOM_FOUND)
    assert np.all(cloud.cause == Cause.NONE)
    assert np.isnan(cloud.tvu).all()
    assert np.isnan(cloud.thu).all()


def test_a_sloping_bed_turns_errors_sideways_into_errors_of_elevation(look_at: Any) -> None:
    level, slope = (points_of(look_at(gradient=gradient)) for gradient in (0.0, 0.5))
    middle = (level.row == 16) & (level.column == 32)
    across = 1.96 * 0.05 * 0.5
    assert slope.tvu[middle] ** 2 - level.tvu[middle] ** 2 == pytest.approx(across**2, rel=0.1)


def test_how_far_scattering_moves_points_counts_sideways(look_at: Any) -> None:
    look, shift = look_at(gradient=0.0), 6.0
    still = points_of(look)
    shifted = points_of(look, scattering=replace(Scattering.none(), shift=np.full(1, shift)))
    off = np.linalg.norm((shifted.position - still.position)[:, :2], axis=1)
    rays = look.rays.reshape(-1, 3)
    assert off == pytest.approx(shift * np.hypot(*rays[:, :2].T) / -rays[:, 2])
    assert (shifted.thu[off > 1.0] > off[off > 1.0]).all()
    assert shifted.thu[off > 1.0] == pytest.approx(1.96 * off[off > 1.0], rel=0.25)
    assert shifted.tvu == pytest.approx(still.tvu, abs=0.01)

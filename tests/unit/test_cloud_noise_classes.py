"""Noise classes 7 and 18, and the derived surface, class 42."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from survey.cloud.derived_surface import derived_surface
from survey.cloud.frame_points import bottom_points, find_water, surface_points
from survey.cloud.lone_echoes import SIDE, stands_alone, stands_high
from survey.cloud.points import PointClass, PointCloud
from survey.cloud.scattering import Scattering
from survey.cloud.stitch import stitched

Looks = Callable[..., Any]
LIGHT = 299_792_458.0


def points_of(look: Any, first_time: Any, bottom_time: Any) -> tuple[PointCloud, PointCloud]:
    """Return surface and bottom points of a look."""
    line = find_water(
        first=look.echo(first_time),
        frame=look.frame,
        rays=look.rays,
        expected_level=0.4,
        refractive_index=look.water.refractive_index,
    )
    seen = {"line": line, "first": look.echo(first_time), "frame": look.frame}
    bottom = bottom_points(
        **seen,
        bottom=look.echo(bottom_time),
        rays=look.rays,
        camera=look.camera,
        targets=look.targets,
        seabed=look.seabed,
        group_index=look.water.group_index,
        scattering=Scattering.none(),
        calibration=look.calibration,
    )
    return surface_points(**seen, targets=look.targets), bottom


def later(metres: float) -> float:
    """Return how much later an echo comes from so much deeper water [s]."""
    return 2.0 * metres * 1.36 / LIGHT


def test_lone_bottoms_are_noise_high_or_low_and_keep_their_place(look_at: Looks) -> None:
    look = look_at()
    time = look.targets.time.copy()
    time[5, 9] -= later(3.0)
    time[20, 40] += later(4.0)
    time[25, 10:12] += later(4.0)
    time[:, 50:], time[3, 60] = np.nan, time[3, 60]
    _, bottom = points_of(look, look.surface_time, time)
    classes = bottom.classification.reshape(32, 64)
    assert classes[5, 9] == PointClass.HIGH_NOISE
    assert classes[20, 40] == PointClass.LOW_NOISE
    assert np.all(classes[25, 10:12] == PointClass.BATHYMETRIC)
    assert classes[3, 60] in (PointClass.LOW_NOISE, PointClass.HIGH_NOISE)
    assert np.isin(classes, (PointClass.LOW_NOISE, PointClass.HIGH_NOISE)).sum() == 3
    high = bottom.select(np.array([5 * 64 + 9]))
    assert high.position[0, 2] - high.true_elevation[0] == pytest.approx(3.0, abs=0.15)


def test_a_lone_first_echo_in_the_air_is_noise_and_its_pixel_water(look_at: Looks) -> None:
    look = look_at()
    first = look.surface_time.copy()
    first[10, 30] -= 2.0 * 8.0 / LIGHT
    surface, bottom = points_of(look, first, look.targets.time)
    noise = surface.select(surface.classification == PointClass.HIGH_NOISE)
    assert (noise.row.tolist(), noise.column.tolist()) == ([10], [30])
    assert noise.position[0, 2] == pytest.approx(8.4, abs=0.3)
    assert bottom.classification.reshape(32, 64)[10, 30] == PointClass.BATHYMETRIC
    assert len(surface) == 32 * 64


def test_land_with_company_stays_land(look_at: Looks) -> None:
    look = look_at()
    first = look.surface_time.copy()
    first[10, 30:32] -= 2.0 * 8.0 / LIGHT
    surface, bottom = points_of(look, first, look.targets.time)
    assert (bottom.classification == PointClass.GROUND).sum() == 2
    assert not (surface.classification == PointClass.HIGH_NOISE).any()


def test_chances_are_those_that_the_docstring_states() -> None:
    """True echoes in 1 % of the pixels, and false ones in 1 % over D = 20 m."""
    random = np.random.default_rng(11)
    inner = np.zeros((1000, 2000), np.bool_)
    inner[3:-3, 3:-3] = True
    sparse = random.random(inner.shape) < 0.01
    level = np.full(inner.shape, -5.0)
    alone = stands_alone(level, sparse)[sparse & inner]
    error = np.sqrt(0.24 / alone.size)
    assert alone.mean() == pytest.approx((1.0 - 0.01) ** (SIDE**2 - 1), abs=4.0 * error)
    deep = random.uniform(-20.0, 0.0, inner.shape)
    central = sparse & inner & (np.abs(deep + 10.0) < 9.0)
    company = ~stands_alone(deep, sparse)[central]
    expected = 1.0 - (1.0 - 0.01 * 2.0 / 20.0) ** (SIDE**2 - 1)
    error = np.sqrt(expected / company.size)
    assert company.mean() == pytest.approx(expected, abs=4.0 * error)


def test_the_height_of_an_echo_without_company_is_judged_by_the_frame() -> None:
    elevation = np.full((20, 20), -6.0)
    elevation[0, 0], elevation[0, 19] = -9.0, -2.0
    which = np.zeros((20, 20), np.bool_)
    which[[0, 0, 15, 15, 16], [0, 19, 5, 6, 5]] = True
    high = stands_high(elevation, which)
    assert np.argwhere(high).tolist() == [[0, 19]]
    nothing = np.zeros((20, 20), np.bool_)
    assert not stands_high(elevation, nothing).any()
    assert not stands_alone(elevation, nothing).any()


def test_thinning_prefers_everything_to_noise(look_at: Looks) -> None:
    look = look_at()
    time = look.targets.time.copy()
    time[20, 40] += later(4.0)
    _, bottom = points_of(look, look.surface_time, time)
    kept = stitched([bottom], cell_size=4.0)
    assert not (kept.classification == PointClass.LOW_NOISE).any()


def test_the_derived_surface_lies_where_rays_were_bent(look_at: Looks) -> None:
    look = look_at(roll_deg=3.0)
    time = look.targets.time.copy()
    time[:, 50:] = np.nan
    _, bottom = points_of(look, look.surface_time, time)
    derived = derived_surface(bottom, [look.frame])
    assert len(derived) == 32 * 50
    assert np.all(derived.classification == PointClass.DERIVED_SURFACE)
    assert np.abs(derived.position[:, 2] - 0.4).max() < 0.01
    known = look.targets.surface[:, :50].reshape(-1, 3)
    assert np.abs(derived.position - known).max() < 0.02
    assert np.array_equal(derived.truth, known)
    assert np.isnan(derived.reflectance).all()
    assert len(derived_surface(bottom.select(np.zeros(len(bottom), np.bool_)), [])) == 0

"""The lidar equation turned round, against numbers worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import PointClass
from survey.cloud.reflectance import Calibration
from survey.cloud.scattering import Scattering

LAUNCHED = 5e7  # photo-electrons x m2
CALIBRATION = Calibration(
    launched=LAUNCHED,
    refractive_index=1.34,
    path=np.array([0.0, 40.0]),
    kept=np.array([1.0, np.exp(-2.0 * 0.2 * 40.0)]),
)

SCATTERING = Scattering.none()


def one_point(survey: Any, frame: Any, place: Any, uncorrected: Any, **columns: Any) -> Any:
    cloud = survey.bottom.select(np.array([0]))
    at = np.append(frame.measured.position[:2], 0.0)
    return replace(
        cloud,
        position=np.array([place]) + at,
        uncorrected=np.array([uncorrected]) + at,
        **{name: np.array([value]) for name, value in columns.items()},
    )


def test_a_bottom_at_nadir(small_survey: Any) -> None:
    """P = E T^2 (r / pi) A / (n H + z)^2 exp(-2 c z): H = 200, z = 8, T = 1 - (0.34 / 2.34)^2."""
    frame = small_survey.frames[0]
    passed = 1.0 - (0.34 / 2.34) ** 2
    counts = LAUNCHED * passed**2 * 0.15 / np.pi / (1.34 * 200.0 + 8.0) ** 2 * np.exp(-3.2)
    point = one_point(small_survey, frame, [0, 0, -8.0], [0, 0, -10.9], depth=8.0, counts=counts)
    found = CALIBRATION.applied(point, frame=frame, scattering=SCATTERING)
    assert found.reflectance[0] == pytest.approx(0.15, rel=1e-6)


def test_a_bottom_aside_goes_by_its_slant(small_survey: Any) -> None:
    """30 m aside: light on the water and path both by the slant, launched evenly over a plane."""
    frame = small_survey.frames[0]
    slant = np.sqrt(1.0 + 0.15**2)
    path = 8.0 / np.sqrt(1.0 - (0.15 / slant / 1.34) ** 2)
    passed = 1.0 - (0.34 / 2.34) ** 2
    reach = 1.34 * 200.0 * slant + path
    whole = LAUNCHED * passed**2 / np.pi / reach**2 / slant**2
    point = one_point(
        small_survey,
        frame,
        [30.9, 0, -8.0],
        [31.635, 0, -10.9],
        depth=8.0,
        counts=whole * 0.2 * np.exp(-0.4 * path),
    )
    found = CALIBRATION.applied(point, frame=frame, scattering=SCATTERING)
    assert found.reflectance[0] == pytest.approx(0.2, rel=1e-6)


def test_what_a_bottom_hides_is_added_in_water_alone(small_survey: Any) -> None:
    frame = small_survey.frames[0]
    hiding = replace(SCATTERING, hidden=np.array([0.02]))
    for depth, kind, added in ((8.0, PointClass.BATHYMETRIC, 0.02), (0.0, PointClass.GROUND, 0.0)):
        point = one_point(
            small_survey,
            frame,
            [0, 0, -depth],
            [0, 0, -1.36 * depth],
            depth=depth,
            counts=1.0,
            classification=np.uint8(kind),
        )
        plain, more = (
            CALIBRATION.applied(point, frame=frame, scattering=table).reflectance[0]
            for table in (SCATTERING, hiding)
        )
        assert more - plain == pytest.approx(added, abs=1e-7)


def test_land_has_no_water_on_the_way_and_no_echo_none(small_survey: Any) -> None:
    frame = small_survey.frames[0]
    counts = LAUNCHED * 0.3 / np.pi / 198.0**2
    for kind, expected in ((PointClass.GROUND, 0.3), (PointClass.NO_BOTTOM_FOUND, np.nan)):
        point = one_point(
            small_survey,
            frame,
            [0, 0, 2.0],
            [0, 0, 2.0],
            depth=0.0,
            counts=counts,
            classification=np.uint8(kind),
        )
        found = CALIBRATION.applied(point, frame=frame, scattering=SCATTERING).reflectance[0]
        assert found == pytest.approx(expected, rel=1e-6, nan_ok=True)

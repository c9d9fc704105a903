"""The paper's missions with few pixels: what is said of how deep they reach."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from survey import preparation
from survey.cloud.points import PointClass
from survey.expected_errors import LevelBottoms
from survey.paper_flights import FLIGHTS, fly_all
from survey.products.accuracy import StitchedDepths

LIMITS = {"P05": {"day": 11.4, "night": 14.6}}
SMALL = {
    "camera.rows": 8,
    "camera.columns": 16,
    "laser.pulse_energy_j": 1.0 / 16.0,
    "flight.frames_per_line": 3,
    "transport.walks_per_pixel": 64,
}


def flight_of(name: str) -> Any:
    return next(flight for flight in FLIGHTS if flight.name == name)


def test_there_are_twelve_by_day_and_night_over_two_seas() -> None:
    assert len({flight.name for flight in FLIGHTS}) == 12
    level = flight_of("p07-flat-night").scenario({})
    assert (level.seabed.kind, level.seabed.depth_m, level.sun.day) == ("plane", 50.0, False)
    assert level.water.type == "harbor"
    assert flight_of("p02-slope-day").scenario({}).sun.day


def test_a_bed_that_falls_is_lost_near_the_expected_depth(tmp_path: Path) -> None:
    """P05 by day, 4 to 34 m. A lit patch of a sixteenth gets less light from its neighbours."""
    steep = SMALL | {"seabed.slope_deg": 8.0}
    row = fly_all(tmp_path, limits=LIMITS, flights=[flight_of("p05-slope-day")], changes=steep)[
        "p05-slope-day"
    ]
    assert row["snr_depth_m"] == pytest.approx(11.4 / 0.398, abs=1e-3)
    assert row["run_depth_m"] <= row["threshold_depth_m"] < row["snr_depth_m"]
    assert 18.0 < row["stitched_depth_m"] <= row["half_stitched_depth_m"] < row["snr_depth_m"]
    assert row["stitched_depth_c_z"] == pytest.approx(0.398 * row["stitched_depth_m"], abs=1e-3)
    assert row["stitched_depth_k_d_z"] == pytest.approx(0.19 * row["stitched_depth_m"], rel=0.01)
    assert 33.0 < row["true_depth_greatest_m"] < 35.0
    assert 0.4 < row["found_fraction"] < 0.8


def test_the_light_of_a_water_is_reckoned_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it does to ranges once for each sun; products are those of flights of their own."""
    models = [Mock(wraps=preparation._mean_flash), Mock(wraps=LevelBottoms)]
    for name, model in zip(["_mean_flash", "LevelBottoms"], models, strict=True):
        monkeypatch.setattr(preparation, name, model)
    changes = SMALL | {"flight.frames_per_line": 1}
    flights = [flight_of(f"p05-{name}") for name in ("slope-day", "slope-night", "flat-night")]
    together = fly_all(tmp_path, limits=LIMITS, flights=flights, changes=changes)
    assert [model.call_count for model in models] == [1, 2]
    for flight in flights[1:]:
        alone = fly_all(tmp_path / "alone", limits=LIMITS, flights=[flight], changes=changes)
        assert together[flight.name] == alone[flight.name]
        frames = [
            next((f / flight.name / "frames").glob("*.npz")).read_bytes()
            for f in (tmp_path, tmp_path / "alone")
        ]
        assert frames[0] == frames[1]


def test_nothing_found_is_a_result_too(tmp_path: Path) -> None:
    """At 50 m coastal water hides the bottom; a second call flies nothing anew."""
    flights, told = [flight_of("p05-flat-day")], list[str]()
    rows = [
        fly_all(tmp_path, limits=LIMITS, flights=flights, changes=SMALL, tell=told.append)
        for _ in range(2)
    ]
    assert rows[0] == rows[1]
    assert told == ["flight p05-flat-day"] * 2
    row = rows[0]["p05-flat-day"]
    assert row["stitched_depth_m"] is row["half_stitched_depth_k_d_z"] is None
    assert row["found_fraction"] < 0.01
    assert row["false_bottom_fraction"] < 0.01


def test_how_deep_a_cloud_holds_the_true_bottom(small_survey: Any) -> None:
    """Right down to 6 m, half of it down to 8 m, 1.1 m too deep below."""
    cloud = small_survey.bottom
    depth = small_survey.water_level - cloud.truth[:, 2]
    error = np.where(depth > 8.0, -1.1, 0.2)
    lost = (depth > 6.0) & (np.arange(len(cloud)) % 2 == 0)
    position = cloud.position.copy()
    position[:, 2] = cloud.true_elevation + error
    found = np.where(lost, PointClass.NO_BOTTOM_FOUND, PointClass.BATHYMETRIC).astype(np.uint8)
    judged = StitchedDepths(water_level=small_survey.water_level)
    judged.add(replace(cloud, position=position, classification=found))
    assert judged.metrics() == {"stitched_depth_m": 6.0, "half_stitched_depth_m": 8.0}

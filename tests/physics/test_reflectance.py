"""Reflectance from counts against the reflectance that the engine was given."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from survey.cloud.points import PointClass
from survey.mission import fly_frame
from survey.preparation import prepare
from survey.scenario.scenario import Scenario


def flown(water: str, depth: float, reflectance: float) -> Scenario:
    """Return a single flash of the paper's field of view in 128 pixels."""
    tables = {
        "mission": {"title": "a test"},
        "flight": {
            "start_easting_m": 500250.0,
            "start_northing_m": 6000750.0,
            "heading_deg": 90.0,
            "frames_per_line": 1,
        },
        "camera": {"rows": 8, "columns": 16, "pixel_footprint_m": 8.0},
        "receiver": {"aperture_radius_m": 0.00125, "filter_width_nm": 1.0, "bins": 500},
        "detector": {"quantum_efficiency": 0.2, "dark_count_rate_hz": 1.0e4},
        "water": {"type": water},
        "surface": {"water_level_m": 0.0},
        "seabed": {"kind": "plane", "depth_m": depth, "reflectance": reflectance},
        "transport": {"walks_per_pixel": 256},
    }
    return Scenario.from_tables(tables, name="test.toml", folder=Path())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("water", "depth", "reflectance"), [("coastal", 8.0, 0.25), ("clear", 15.0, 0.05)]
)
def test_the_bed_of_the_engine_has_its_reflectance_again(
    water: str, depth: float, reflectance: float
) -> None:
    """Median over the inner pixels within 10 %: expected light is right to 7 % in the mean."""
    mission = prepare(flown(water, depth, reflectance))
    result = fly_frame(mission, mission.frames[0])
    bottom = result.bottom
    inner = (bottom.classification == PointClass.BATHYMETRIC) & np.isin(bottom.row, range(2, 6))
    inner &= np.isin(bottom.column, range(4, 12))
    assert inner.sum() >= 28
    assert np.all(bottom.true_reflectance == np.float32(reflectance))
    ratio = bottom.reflectance[inner] / reflectance
    assert np.median(ratio) == pytest.approx(1.0, abs=0.1)
    assert ratio.std() < 0.25
    assert np.all(np.isfinite(result.surface.reflectance))
    assert np.all(np.isnan(result.surface.true_reflectance))

"""The mission that all faults are tried on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from survey import mission as flights
from survey.preparation import prepare
from survey.scenario.scenario import Scenario
from tests.faults.rehearsal import ONE, Rehearsal, products

TABLES: dict[str, Any] = {
    "mission": {"title": "a test"},
    "flight": {
        "start_easting_m": 500250.0,
        "start_northing_m": 6000750.0,
        "heading_deg": 90.0,
        "frames_per_line": 4,
        "speed_m_s": 20.0,
    },
    "camera": {"rows": 6, "columns": 8},
    "receiver": {"aperture_radius_m": 0.005, "filter_width_nm": 1.0},
    "detector": {"quantum_efficiency": 0.2, "dark_count_rate_hz": 1.0e4},
    "water": {"type": "coastal"},
    "surface": {"water_level_m": 0.5},
    "seabed": {"kind": "slope", "depth_m": 3.0, "slope_deg": 3.0, "downhill_deg": 90.0},
    "transport": {"walks_per_pixel": 16},
    "processing": {"correct_scattering": False},
}


@pytest.fixture(scope="session")
def rehearsal(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Rehearsal]:
    """Four frames of 8 x 6 pixels; preparing is done once, since no fault is tried there."""
    folder = tmp_path_factory.mktemp("rehearsal")
    scenario = Scenario.from_tables(TABLES, name="reef.toml", folder=folder)
    mission = prepare(scenario)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(flights, "prepare", lambda scenario: mission)
        flights.fly(scenario, folder / "wanted", crew=ONE)
        yield Rehearsal(scenario=scenario, mission=mission, wanted=products(folder / "wanted"))

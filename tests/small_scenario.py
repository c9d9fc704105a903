"""A small sound scenario, only what must be given, for tests to change."""

from __future__ import annotations

from typing import Any

from survey.scenario.scenario import with_changes

TABLES: dict[str, Any] = {
    "mission": {"title": "a test"},
    "flight": {
        "start_easting_m": 500250.0,
        "start_northing_m": 6000750.0,
        "heading_deg": 90.0,
        "frames_per_line": 2,
    },
    "receiver": {"aperture_radius_m": 0.005, "filter_width_nm": 1.0},
    "detector": {"quantum_efficiency": 0.2, "dark_count_rate_hz": 1.0e4},
    "water": {"type": "coastal"},
    "surface": {"water_level_m": 0.5},
    "seabed": {"kind": "plane", "depth_m": 10.0},
}
SLOPE = {"kind": "slope", "depth_m": 3.0, "slope_deg": 3.0, "downhill_deg": 90.0}


def small_tables(**changes: Any) -> dict[str, Any]:
    """Return its tables, with changes by dotted key: ``**{"camera.rows": 6}``."""
    return with_changes(TABLES, changes, name="a test")

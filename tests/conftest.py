"""What all tests share."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import settings

settings.register_profile("same every time", derandomize=True, deadline=None)
settings.load_profile("same every time")


@pytest.fixture
def tables() -> dict[str, dict[str, Any]]:
    """Return the tables of a small sound scenario, only what must be given."""
    return {
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

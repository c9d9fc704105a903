"""Frames that overlap near the limit of depth, from scenario to products."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import BOTTOM_CLASSES, PointClass
from survey.mission import fly
from survey.preparation import prepare
from survey.products.frame_file import read_frame
from survey.products.ply_file import read_records
from survey.scenario.scenario import Scenario


@pytest.fixture
def weak(tables: dict[str, Any], tmp_path: Path) -> Scenario:
    """Six frames of 8 x 8 pixels that nearly cover each other, over a bed near the limit."""
    tables["flight"] |= {"frames_per_line": 6, "speed_m_s": 20.0, "flash_rate_hz": 20.0}
    tables["camera"] = {"rows": 8, "columns": 8}
    tables["transport"] = {"walks_per_pixel": 32}
    tables["seabed"] = {"kind": "plane", "depth_m": 18.0}
    tables["processing"] = {"second_look_rate": 0.05, "thinning_m": 0.0}
    return Scenario.from_tables(tables, name="weak.toml", folder=tmp_path)

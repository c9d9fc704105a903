"""One scenario of the gallery passes Special Order, one fails its order and says why."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from survey.mission import fly
from survey.scenario.load import load_scenario

pytestmark = pytest.mark.slow


def flown(name: str, folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(
        (fly(load_scenario(name), folder / name) / "metrics.json").read_text()
    )
    return found


def test_special_order_passes_special_order_on_all_criteria(tmp_path: Path) -> None:
    s44 = flown("special-order", tmp_path)["s44"]
    special, exclusive = s44["orders"]["special"], s44["orders"]["exclusive"]
    assert s44["asked"] == "special"
    assert (special["result"], special["not_assessable"]) == ("pass", [])
    assert len(special["criteria"]["feature_detection"]["cubes"]) == 2
    assert all(row["share"] > 0.97 for row in special["criteria"]["tvu"]["by_depth"])
    assert "coverage" in exclusive["failed"]


def test_turbid_layer_fails_by_its_false_floor(tmp_path: Path) -> None:
    found = flown("turbid-layer", tmp_path)
    order = found["s44"]["orders"][found["s44"]["asked"]]
    assert order["result"] == "fail"
    assert "tvu" in order["failed"]
    reason = order["criteria"]["tvu"]["reason"]
    assert "95 % are asked: bias +" in reason
    failures = json.loads((tmp_path / "turbid-layer/failures.geojson").read_text())["features"]
    causes = [feature["properties"]["cause"] for feature in failures]
    assert {"false bottom", "depth error over the limit"} & set(causes)

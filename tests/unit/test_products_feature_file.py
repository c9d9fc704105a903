"""Feature collections written one feature at a time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from survey.products.feature_file import write_features
from survey.products.json_file import json_bytes


@pytest.mark.parametrize("count", [0, 1, 3])
def test_bytes_are_those_of_the_whole_collection(tmp_path: Path, count: int) -> None:
    features: list[dict[str, Any]] = [
        {
            "type": "Feature",
            "properties": {"cause": 'ä "line"\nmore', "none": None},
            "geometry": {"type": "Point", "coordinates": [1e-9, number]},
        }
        for number in range(count)
    ]
    write_features(tmp_path / "some.geojson", iter(features))
    whole = json_bytes({"type": "FeatureCollection", "features": features})
    assert (tmp_path / "some.geojson").read_bytes() == whole


def test_nothing_stays_of_a_collection_that_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="JSON"):
        write_features(tmp_path / "some.geojson", [{"ok": 1.0}, {"bad": float("nan")}])
    assert list(tmp_path.iterdir()) == []

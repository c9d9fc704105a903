"""Covered ground and holes with their cause."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyproj import Transformer

from survey.cloud.points import Outcome
from survey.products.coverage import (
    GAP,
    OUTSIDE_AREA,
    CoverageMap,
    CoverageTally,
    hull_of,
    looked_at,
    write_coverage_geojson,
)
from survey.products.writing import ProductError

REACH = 4.6
"""Half the diagonal of the 6.4 m pixels of these surveys [m]."""


def map_of(survey: Any, *, records: list[Any] | None = None, cell_size: float = 2.0) -> CoverageMap:
    """Return the coverage over the hull of a survey, or what some records make of it."""
    origin = survey.map_frame.origin[:2]
    coverage = CoverageTally(
        survey_area=hull_of(survey.records) + origin, cell_size=cell_size, reach=REACH
    )
    seen = [looked_at(record) for record in records or survey.records]
    places = np.concatenate([places for places, _ in seen]) + origin
    coverage.add(places, np.concatenate([outcomes for _, outcomes in seen]))
    return coverage.map()


def spoil(survey: Any) -> Any:
    """Return the survey with a failed disc, 40 m wide, under one flash."""
    centre = survey.frames[12].pose.position[:2]

    def failed(record: Any) -> Any:
        distance = np.hypot(*np.moveaxis(record.true_position[..., :2] - centre, -1, 0))
        outcome = record.outcome.copy()
        outcome[distance < 20.0] = Outcome.SATURATED
        outcome[distance < 5.0] = Outcome.CHANCE
        return replace(record, outcome=outcome)

    return replace(survey, records=[failed(record) for record in survey.records])


def features_of(survey: Any, path: Path, **options: float) -> list[dict[str, Any]]:
    """Write and read the GeoJSON of a survey."""
    write_coverage_geojson(path, map_of(survey), survey.map_frame, **options)
    collection = json.loads(path.read_text())
    assert collection["type"] == "FeatureCollection"
    return list(collection["features"])


def test_overlapping_lines_have_no_gap(small_survey: Any) -> None:
    coverage = map_of(small_survey)
    assert not np.any(coverage.state == GAP)
    assert np.any(coverage.state == Outcome.DRY)
    assert np.any(coverage.state == OUTSIDE_AREA)


def test_a_gap_between_lines_has_its_true_width(survey_of: Any, tmp_path: Path) -> None:
    apart = survey_of(lines=2, frames_per_line=4, spacing=91.2)
    gaps = [
        feature["properties"]
        for feature in features_of(apart, tmp_path / "coverage.geojson")
        if feature["properties"]["kind"] == "hole"
    ]
    assert [gap["cause"] for gap in gaps] == ["gap between frames"]
    length = 300.0 + 102.4 - 6.4
    assert gaps[0]["area_m2"] / length == pytest.approx(91.2 - 51.2, abs=3.2)


def test_a_failed_patch_names_its_commonest_cause(small_survey: Any, tmp_path: Path) -> None:
    """A disc 40 m wide fails; elsewhere single failures stay below 50 m2."""
    spoiled = spoil(small_survey)
    holes = [
        feature
        for feature in features_of(spoiled, tmp_path / "coverage.geojson")
        if feature["properties"]["kind"] == "hole"
        and feature["properties"]["cause"] in ("saturated", "chance")
    ]
    assert "saturated" in {hole["properties"]["cause"] for hole in holes}
    area = sum(hole["properties"]["area_m2"] for hole in holes)
    assert np.pi * (20.0 - REACH - 2.0) ** 2 < area < np.pi * 20.0**2


def test_small_holes_are_left_out(small_survey: Any, tmp_path: Path) -> None:
    areas = [
        feature["properties"]["area_m2"]
        for feature in features_of(small_survey, tmp_path / "a.geojson", min_hole_area=20.0)
        if feature["properties"]["kind"] == "hole"
    ]
    assert areas
    assert min(areas) > 20.0


def test_places_are_longitude_latitude_and_right_handed(small_survey: Any, tmp_path: Path) -> None:
    features = features_of(spoil(small_survey), tmp_path / "coverage.geojson")
    assert max(len(feature["geometry"]["coordinates"]) for feature in features) > 1
    to_map = Transformer.from_crs(4326, 25832, always_xy=True)
    for feature in features:
        rings = feature["geometry"]["coordinates"]
        turns = []
        for ring in rings:
            assert ring[0] == ring[-1]
            x, y = to_map.transform(*np.array(ring).T)
            assert np.all(np.abs(x - 500450.0) < 500.0)
            assert np.all(np.abs(y - 6000500.0) < 500.0)
            x, y = x - x[0], y - y[0]
            turns.append(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
        assert turns[0] > 0.0
        assert all(turn < 0.0 for turn in turns[1:])
        assert feature["properties"]["area_m2"] == pytest.approx(0.5 * sum(turns), rel=1e-3)


def test_same_bytes_twice(small_survey: Any, tmp_path: Path) -> None:
    for name in "ab":
        features_of(small_survey, tmp_path / f"{name}.geojson")
    assert (tmp_path / "a.geojson").read_bytes() == (tmp_path / "b.geojson").read_bytes()


def test_a_flight_that_sees_nothing_is_an_error(small_survey: Any) -> None:
    record = small_survey.records[0]
    blind = replace(record, true_position=np.full_like(record.true_position, np.nan))
    with pytest.raises(ProductError, match="fewer than three pixels"):
        hull_of([blind])


def test_one_pixel_that_saw_the_bottom_covers_its_cell(small_survey: Any) -> None:
    """Ten failures and one success look at the same place."""
    record = small_survey.records[20]
    failed = replace(record, outcome=np.full_like(record.outcome, Outcome.TOO_WEAK))
    covered = map_of(replace(small_survey, records=[record]), records=[failed] * 10 + [record])
    assert np.all(np.isin(covered.state, [Outcome.FOUND, OUTSIDE_AREA]))

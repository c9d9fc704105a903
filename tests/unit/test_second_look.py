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
    tables["seabed"] = {"kind": "plane", "depth_m": 27.0}
    tables["processing"] = {"second_look_rate": 0.1, "thinning_m": 0.0}
    return Scenario.from_tables(tables, name="weak.toml", folder=tmp_path)


def run_files(folder: Path) -> dict[str, bytes]:
    kept = ("bottom.*", "bathymetry.*", "metrics.json", "coverage.geojson", "frames/*")
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for pattern in kept
        for path in folder.glob(pattern)
    }


def bottoms(folder: Path) -> dict[tuple[int, ...], float]:
    """Return the elevation of every bottom point by frame, row and column."""
    records, _ = read_records(folder / "bottom.ply")
    solid = records[np.isin(records["classification"], BOTTOM_CLASSES)]
    pixel = zip(
        *(solid[name].tolist() for name in ("frame", "pixel_row", "pixel_column")), strict=True
    )
    return dict(zip(pixel, solid["z"].tolist(), strict=True))


def test_frames_that_overlap_add_bottoms_and_change_none(weak: Scenario, tmp_path: Path) -> None:
    helped = fly(weak, tmp_path / "helped", workers=1)
    alone = fly(weak.replace(**{"processing.second_look_rate": 0.0}), tmp_path / "alone", workers=1)
    metrics, before = (
        json.loads((folder / "metrics.json").read_text()) for folder in (helped, alone)
    )
    added = metrics["found_with_other_frames"]
    assert before["found_with_other_frames"] == 0
    assert added == metrics["points_bottom"] - before["points_bottom"] > 0
    assert bottoms(alone).items() <= bottoms(helped).items()
    assert sum(metrics["missed"].values()) < sum(before["missed"].values())
    assert f"{added} pixels found it with the help" in (helped / "report.html").read_text()

    frame = read_frame(helped / "frames/000003.npz")
    assert frame.candidates is not None
    assert set(frame.candidates.classification) == {PointClass.BATHYMETRIC}
    assert np.isfinite([frame.candidates.tvu, frame.candidates.thu]).all()
    pixels = frame.candidates.row * 8 + frame.candidates.column
    assert set(frame.bottom.classification[pixels]) == {PointClass.NO_BOTTOM_FOUND}
    unhelped = read_frame(alone / "frames/000003.npz")
    assert unhelped.candidates is None
    assert np.array_equal(unhelped.bottom.position, frame.bottom.position)


@pytest.mark.slow
def test_same_bytes_for_any_workers(weak: Scenario, tmp_path: Path) -> None:
    one, two = (fly(weak, tmp_path / str(n), workers=n) for n in (1, 2))
    assert run_files(one) == run_files(two)


def test_a_flight_without_overlap_looks_once(weak: Scenario) -> None:
    assert prepare(weak).second_look_rate == 0.1
    assert prepare(weak.replace(**{"flight.flash_rate_hz": 1.0})).second_look_rate is None
    assert prepare(weak.replace(**{"processing.ranging": "threshold"})).second_look_rate is None

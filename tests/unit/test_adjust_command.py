"""Adjusting a flown run: what stands in the way, and what a real flight gains."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from survey.adjustment import _adjusted, adjust_run, pooled_rms, write_adjustment
from survey.adjustment_report import as_json, as_text
from survey.adjustment_truth import true_mounting
from survey.errors import UserError
from survey.exit_status import BAD_INPUT, FILE_MISSING, explain
from survey.flight.navigation import Mounting, Navigation
from survey.mission import fly
from survey.optics.water import WaterColumn, petzold_water
from survey.products.frame_file import FrameResult
from survey.scenario.load import load_scenario


def status(run: Path, output: Path) -> tuple[int, str]:
    with pytest.raises((UserError, OSError)) as fault:
        adjust_run(run, output, mode="boresight")
    return explain(fault.value)


def test_a_missing_run_or_a_wrong_place_says_so(tmp_path: Path) -> None:
    run, full, file = tmp_path / "run", tmp_path / "full", tmp_path / "file"
    code, words = status(run, tmp_path / "new")
    assert (code, "no run" in words) == (FILE_MISSING, True)
    for folder in (run, full):
        folder.mkdir()
        (folder / "manifest.json").write_text('{"scenario_sha256": "0"}')
        (folder / "scenario.toml").write_text("")
    file.write_text("")
    for output, reason in (
        (tmp_path / "new", "no frame was flown"),
        (run, "the run itself"),
        (full, "holds files but no adjustment"),
        (file, "a file"),
    ):
        code, words = status(run, output)
        assert code == BAD_INPUT
        assert reason in words
    assert not (tmp_path / "new").exists()


def test_true_mounting_is_the_turn_and_arm_that_is_missing() -> None:
    true = Mounting(roll=0.02, pitch=-0.01, heading=0.3, lever_arm=(1.0, 0.0, 0.5))
    plain = true_mounting(Navigation(mounting=true))
    assert (plain.roll, plain.pitch, plain.heading) == pytest.approx((0.02, -0.01, 0.3))
    assert plain.lever_arm == true.lever_arm
    known = true_mounting(Navigation(mounting=true, believed_mounting=true))
    assert (known.roll, known.pitch, known.heading) == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


def test_candidates_go_where_bottoms_go(small_survey: Any) -> None:
    """Weak echoes that other frames may believe are placed anew with the rest of their frame."""
    cloud = small_survey.bottom.select(small_survey.bottom.frame == 3)
    weak = np.arange(0, len(cloud), 7)
    result = FrameResult(
        bottom=cloud,
        surface=small_survey.surface.select(small_survey.surface.frame == 3),
        record=small_survey.records[3],
        candidates=cloud.select(weak),
    )
    lines = np.unique(cloud.line).tolist()
    found: Any = SimpleNamespace(
        unknowns=SimpleNamespace(lines=lines),
        offset=lambda line: np.array([2.0, -1.0, 0.5]),
        mounting=Mounting(roll=0.01),
    )
    frames = {frame.index: frame for frame in small_survey.frames}
    water = WaterColumn.uniform(petzold_water("coastal", refractive_index=1.34, group_index=1.36))
    told = _adjusted(result, found, frames, small_survey, water)
    assert told.candidates is not None
    for name in ("position", "true_elevation", "depth"):
        new, old = getattr(told.bottom, name), getattr(cloud, name)
        assert np.nanmax(np.abs(new - old)) > 0.1, name
        assert getattr(told.candidates, name) == pytest.approx(new[weak], nan_ok=True), name


def test_pooled_differences_weigh_by_cells() -> None:
    pairs = [{"cells": 3, "rms_difference_m": 1.0}, {"cells": 1, "rms_difference_m": 3.0}]
    assert pooled_rms(pairs) == pytest.approx(np.sqrt(3.0))


@pytest.mark.slow
def test_a_flown_calibration_is_found_and_the_points_come_right(tmp_path: Path) -> None:
    """The gallery's flight: three angles within 3 standard errors; errors fall by a factor 3."""
    run = fly(load_scenario("boresight"), tmp_path / "run")
    untouched = {path: path.read_bytes() for path in run.rglob("*") if path.is_file()}
    found = adjust_run(run, tmp_path / "adjusted", mode="boresight")
    told = as_json(found)
    write_adjustment(tmp_path / "adjusted", told)
    angles = [row for row in told["mounting"] if row["name"].endswith("_deg")]
    assert [row["name"] for row in angles] == ["roll_deg", "pitch_deg", "heading_deg"]
    assert [row["true"] for row in angles] == pytest.approx([0.3, 0.2, 0.5], abs=1e-4)
    for row in angles:
        assert row["determined"]
        assert abs(row["correction"] - row["true"]) < 3.0 * row["standard_error"]
    assert found.after.horizontal < found.before.horizontal / 3.0
    assert found.after.elevation < found.before.elevation
    far_before, far_after = (
        max(pair["p95_abs_difference_m"] for pair in pairs)
        for pairs in (found.overlaps_before, found.overlaps_after)
    )
    assert far_after < 0.5 * far_before
    assert {path: path.read_bytes() for path in run.rglob("*") if path.is_file()} == untouched
    _states_what_it_is(tmp_path / "adjusted")
    assert "truly +0.300" in as_text(found)
    again = adjust_run(run, tmp_path / "adjusted", mode="boresight")
    assert as_json(again) == told


def _states_what_it_is(folder: Path) -> None:
    import laspy

    metrics: dict[str, Any] = json.loads((folder / "metrics.json").read_text())
    assert metrics["strip_adjustment"] == "boresight"
    assert "strips adjusted" in (folder / "report.html").read_text()
    with laspy.open(str(folder / "bottom.laz")) as file:
        assert file.header.generating_software == "bathyflash adjust boresight"


@pytest.mark.slow
def test_a_flat_bottom_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    level = {"seabed.kind": "plane", "seabed.roughness_rms_m": 0.0}
    run = fly(load_scenario("boresight", level), tmp_path / "run")
    for mode in ("boresight", "offsets"):
        with pytest.raises(UserError, match="refused: the overlaps carry too little shape"):
            adjust_run(run, tmp_path / "adjusted", mode=mode)
    assert not (tmp_path / "adjusted").exists()

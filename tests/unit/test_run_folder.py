"""Run folders: what is taken up again, what is flown again, what is left alone."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey import run_identity
from survey.errors import OtherRunError
from survey.exit_status import OTHER_RUN, explain
from survey.products.frame_file import FrameResult, frame_bytes, read_frame
from survey.run_folder import RunFolder
from survey.scenario.scenario import Scenario


@pytest.fixture
def scenario(tables: dict[str, Any], tmp_path: Path) -> Scenario:
    return Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)


@pytest.fixture
def result(small_survey: Any) -> FrameResult:
    bottom, surface = small_survey.bottom, small_survey.surface
    return FrameResult(
        bottom=bottom.select(bottom.frame == 3),
        surface=surface.select(surface.frame == 3),
        record=small_survey.records[3],
    )


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_a_frame_reads_back_as_it_was_written(tmp_path: Path, result: FrameResult) -> None:
    (tmp_path / "000003.npz").write_bytes(written := frame_bytes(result))
    again = read_frame(tmp_path / "000003.npz")
    assert written == frame_bytes(again)
    for cloud in ("bottom", "surface"):
        for name, column in getattr(result, cloud).columns().items():
            found = getattr(again, cloud).columns()[name]
            assert found.dtype == column.dtype
            assert np.array_equal(found, column)
    assert np.array_equal(again.record.outcome, result.record.outcome)


def test_a_frame_keeps_its_candidates(tmp_path: Path, result: FrameResult) -> None:
    weak = replace(result, candidates=result.bottom.select(np.arange(3)))
    (tmp_path / "000003.npz").write_bytes(written := frame_bytes(weak))
    again = read_frame(tmp_path / "000003.npz")
    assert again.candidates is not None
    assert np.array_equal(again.candidates.position, result.bottom.position[:3])
    assert written == frame_bytes(again)


def test_a_frame_over_land_has_no_surface(tmp_path: Path, result: FrameResult) -> None:
    dry = replace(result, surface=result.surface.select(slice(0, 0)))
    (tmp_path / "000003.npz").write_bytes(frame_bytes(dry))
    surface = read_frame(tmp_path / "000003.npz").surface
    assert (len(surface), surface.position.shape, surface.frame.dtype) == (0, (0, 3), np.uint32)


def test_anybody_reads_a_frame_with_numpy(tmp_path: Path, result: FrameResult) -> None:
    (tmp_path / "000003.npz").write_bytes(frame_bytes(result))
    with np.load(tmp_path / "000003.npz") as arrays:
        assert sorted(arrays) == ["bottom", "pixel", "surface"]
        assert np.array_equal(arrays["bottom"]["position"], result.bottom.position)
        assert np.array_equal(arrays["pixel"]["outcome"], result.record.outcome)


@pytest.mark.parametrize("damage", ["empty", "short", "flipped", "other", "no column"])
def test_a_damaged_frame_is_named(tmp_path: Path, result: FrameResult, damage: str) -> None:
    path, content = tmp_path / "000003.npz", frame_bytes(result)
    half = len(content) // 2
    ruined = {
        "empty": b"",
        "short": content[:half],
        "flipped": content[:half] + bytes(b ^ 255 for b in content[half : half + 64])
        + content[half + 64 :],
        "other": b"no zip at all",
    }  # fmt: skip
    if damage == "no column":
        np.savez(path, bottom_position=np.zeros((0, 3)))
    else:
        path.write_bytes(ruined[damage])
    with pytest.raises(ValueError, match=r"000003\.npz: not a whole frame .* run again"):
        read_frame(path)


def test_a_new_run_is_empty_and_holds_its_scenario(scenario: Scenario, tmp_path: Path) -> None:
    run = RunFolder.open(tmp_path / "a" / "run", scenario)
    assert run.whole == {}
    assert (run.path / "scenario.toml").read_text() == scenario.to_toml(beside=run.path)
    assert sorted(contents(run.path)) == ["manifest.json", "scenario.toml"]


def test_a_run_is_taken_up_where_it_stopped(
    scenario: Scenario, tmp_path: Path, result: FrameResult
) -> None:
    run = RunFolder.open(tmp_path / "run", scenario)
    run.keep(3, frame_bytes(result))
    run.keep(0, frame_bytes(result))
    again = RunFolder.open(tmp_path / "run", scenario)
    assert again.whole == run.whole
    assert set(again.whole) == {0, 3}
    assert frame_bytes(again.frame(3)) == frame_bytes(result)


@pytest.mark.parametrize("damage", ["gone", "changed"])
def test_a_frame_that_is_not_what_the_journal_says_is_not_whole(
    scenario: Scenario, tmp_path: Path, result: FrameResult, damage: str
) -> None:
    run = RunFolder.open(tmp_path / "run", scenario)
    run.keep(0, frame_bytes(result))
    run.keep(1, frame_bytes(result))
    if damage == "gone":
        run.frame_path(1).unlink()
    else:
        run.frame_path(1).write_bytes(run.frame_path(1).read_bytes()[:-1])
    assert set(RunFolder.open(tmp_path / "run", scenario).whole) == {0}
    run.keep(1, frame_bytes(result))
    assert set(RunFolder.open(tmp_path / "run", scenario).whole) == {0, 1}


def test_a_torn_or_strange_journal_costs_only_its_frames(
    scenario: Scenario, tmp_path: Path, result: FrameResult
) -> None:
    run = RunFolder.open(tmp_path / "run", scenario)
    run.keep(0, frame_bytes(result))
    with (run.path / "journal.jsonl").open("a") as journal:
        journal.write('[]\n"word"\n{"frame": "x", "sha256": 1}\n{"frame": 7, "sha256": "ab"}\n{"fr')
    assert set(RunFolder.open(tmp_path / "run", scenario).whole) == {0}


def test_a_frame_without_a_note_in_the_journal_is_not_whole(
    scenario: Scenario, tmp_path: Path, result: FrameResult
) -> None:
    run = RunFolder.open(tmp_path / "run", scenario)
    run.frame_path(4).write_bytes(frame_bytes(result))
    assert RunFolder.open(tmp_path / "run", scenario).whole == {}


def refused(scenario: Scenario, path: Path) -> str:
    before = contents(path)
    with pytest.raises(OtherRunError) as caught:
        RunFolder.open(path, scenario)
    assert contents(path) == before
    status, lines = explain(caught.value)
    assert status == OTHER_RUN == 5
    assert "\n" not in lines
    assert str(path) in lines
    return lines


def test_another_scenario_is_refused(
    scenario: Scenario, tmp_path: Path, result: FrameResult
) -> None:
    RunFolder.open(tmp_path / "run", scenario).keep(0, frame_bytes(result))
    for change in ({"mission.seed": 2}, {"flight.lines": 2}, {"water.type": "clear"}):
        assert "other scenario" in refused(scenario.replace(**change), tmp_path / "run")
    assert set(RunFolder.open(tmp_path / "run", scenario).whole) == {0}


def test_other_files_are_refused(tables: dict[str, Any], tmp_path: Path) -> None:
    tables["seabed"]["objects"] = [
        {"kind": "mesh", "file": "hull.ply", "easting_m": 500250.0, "northing_m": 6000750.0}
    ]
    (tmp_path / "hull.ply").write_bytes(b"one hull")
    scenario = Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)
    RunFolder.open(tmp_path / "run", scenario)
    RunFolder.open(tmp_path / "run", scenario)
    (tmp_path / "hull.ply").write_bytes(b"another hull")
    assert "other files that the scenario names" in refused(scenario, tmp_path / "run")


def test_other_code_and_versions_are_refused(
    scenario: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    RunFolder.open(tmp_path / "run", scenario)
    monkeypatch.setattr(run_identity, "_code_digest", lambda: "other")
    monkeypatch.setattr(run_identity, "_lock_digest", lambda: "other")
    monkeypatch.setattr(run_identity.metadata, "version", lambda name: "0")
    assert "other library versions, other lock of the libraries, other code" in refused(
        scenario, tmp_path / "run"
    )


def test_the_keys_that_differ_are_named(scenario: Scenario, tmp_path: Path) -> None:
    RunFolder.open(tmp_path / "run", scenario)
    other = scenario.replace(**{"mission.seed": 2, "flight.lines": 3})
    lines = refused(other, tmp_path / "run")
    assert "mission.seed was 1, now 2" in lines
    assert "flight.lines was 1, now 3" in lines


def test_a_run_flown_anew_leaves_nothing_of_the_old_and_all_of_the_user_s(
    scenario: Scenario, tmp_path: Path, result: FrameResult
) -> None:
    run = RunFolder.open(tmp_path / "run", scenario)
    run.keep(3, frame_bytes(result))
    for name in ("bottom.laz", "metrics.json", "trajectory_cblue.txt", "notes.md"):
        (run.path / name).write_text("old")
    other = RunFolder.open(tmp_path / "run", scenario.replace(**{"mission.seed": 2}), refly=True)
    assert other.whole == {}
    assert sorted(contents(run.path)) == [".lock", "manifest.json", "notes.md", "scenario.toml"]
    assert other.path.joinpath("scenario.toml").read_text() != scenario.to_toml(beside=run.path)


def test_a_note_after_a_torn_one_counts(
    scenario: Scenario, tmp_path: Path, result: FrameResult
) -> None:
    run = RunFolder.open(tmp_path / "run", scenario)
    (run.path / "journal.jsonl").write_text('{"frame": 0, "sha')
    run.keep(3, frame_bytes(result))
    assert set(RunFolder.open(tmp_path / "run", scenario).whole) == {3}


def test_a_run_killed_at_its_first_file_is_taken_up(scenario: Scenario, tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / ".manifest.partial.json").write_text("{")
    (tmp_path / "run" / ".lock").touch()
    assert RunFolder.open(tmp_path / "run", scenario).whole == {}


def test_why_a_frame_is_no_longer_whole_is_known(
    scenario: Scenario, tmp_path: Path, result: FrameResult
) -> None:
    run = RunFolder.open(tmp_path / "run", scenario)
    for index in (0, 1, 2):
        run.keep(index, frame_bytes(result))
    run.frame_path(0).unlink()
    run.frame_path(2).write_bytes(b"ruined")
    again = RunFolder.open(tmp_path / "run", scenario)
    assert set(again.whole) == {1}
    assert again.spoilt == {0: "its file is gone", 2: "its file is not what was written"}


@pytest.mark.parametrize(
    "foreign", [{"photo.jpg": "x"}, {"manifest.json": "[]"}, {"manifest.json": '{"name": "web"}'}]
)
def test_a_foreign_folder_is_left_alone(
    scenario: Scenario, tmp_path: Path, foreign: dict[str, str]
) -> None:
    folder = tmp_path / "photos"
    folder.mkdir()
    for name, text in foreign.items():
        (folder / name).write_text(text)
    assert "holds files but no run" in refused(scenario, folder)


def test_a_run_killed_before_its_first_frame_is_taken_up(
    scenario: Scenario, tmp_path: Path
) -> None:
    run = RunFolder.open(tmp_path / "run", scenario)
    manifest = json.loads((run.path / "manifest.json").read_text())
    assert set(manifest["versions"]) >= {"bathyflash", "numpy", "numba"}
    (run.path / "frames").rmdir()
    (run.path / "scenario.toml").unlink()
    assert RunFolder.open(tmp_path / "run", scenario).frame_path(0).parent.is_dir()

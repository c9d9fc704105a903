"""Scenario files as they come from disk, their variations, and the resolved text."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from survey.scenario.faults import ScenarioError
from survey.scenario.gallery import gallery
from survey.scenario.load import load_scenario, parse_frames, parse_overrides
from survey.scenario.scenario import Scenario
from survey.scenario.toml_text import to_toml


@pytest.fixture
def file(tmp_path: Path, tables: dict[str, Any]) -> Path:
    path = tmp_path / "reef.toml"
    path.write_text(to_toml(tables), encoding="utf-8")
    return path


def test_defaults_are_filled_in(file: Path) -> None:
    scenario = load_scenario(file)
    assert scenario.flight.height_m == 200.0
    assert scenario.camera.long_side == "along"
    assert scenario.mission.crs_epsg == 25832


def test_resolved_text_reads_back_and_holds_every_default(file: Path, tmp_path: Path) -> None:
    text = load_scenario(file).to_toml()
    (tmp_path / "again.toml").write_text(text, encoding="utf-8")
    again = load_scenario(tmp_path / "again.toml")
    assert again.to_toml() == text
    assert again.receiver.gate_start_ns == pytest.approx(1304.26, abs=0.01)
    assert again.water.absorption_per_m == 0.179
    assert again.processing.echo_gate_ns == 10.0


def test_resolved_text_keeps_objects_and_names_files_from_its_place(
    tmp_path: Path, tables: dict[str, Any]
) -> None:
    (tmp_path / "rock.ply").touch()
    rock = {"kind": "mesh", "easting_m": 1.0, "northing_m": 2.0, "file": "rock.ply"}
    tables["seabed"]["objects"] = [rock]
    scenario = Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)
    run = tmp_path / "runs" / "reef"
    run.mkdir(parents=True)
    (run / "scenario.toml").write_text(scenario.to_toml(beside=run), encoding="utf-8")
    again = load_scenario(run / "scenario.toml")
    assert getattr(again.seabed.objects[0], "file") == "../../rock.ply"  # noqa: B009
    assert 'file = "rock.ply"' in scenario.to_toml()


@given(st.text())
def test_any_text_survives_toml(text: str) -> None:
    assert tomllib.loads(to_toml({"mission": {"title": text}})) == {"mission": {"title": text}}


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_any_number_survives_toml(number: float) -> None:
    assert tomllib.loads(to_toml({"a": {"b": number}})) == {"a": {"b": number}}


def test_overrides_replace_values(file: Path) -> None:
    scenario = load_scenario(file, {"water.type": "harbor", "flight.height_m": 150})
    assert scenario.water.type == "harbor"
    assert scenario.flight.height_m == 150.0


def test_a_variation_follows_its_own_defaults_and_leaves_the_first_alone(file: Path) -> None:
    scenario = load_scenario(file)
    lower = scenario.replace(**{"flight.height_m": 150.0, "laser.pulse_width_ns": 5.0})
    assert "gate_start_ns = 970.69" in lower.to_toml()
    assert "echo_gate_ns = 5.0" in lower.to_toml()
    assert scenario.flight.height_m == 200.0
    assert scenario.replace(**{"mission.seed": 2}).flight.height_m == 200.0
    assert lower.replace(**{"flight.height_m": None}).flight.height_m == 200.0


def test_a_variation_is_checked(file: Path) -> None:
    with pytest.raises(ScenarioError, match=r"water\.type: 'mud' is not one of"):
        load_scenario(file).replace(**{"water.type": "mud"})


def test_a_whole_section_can_be_replaced(file: Path) -> None:
    changed = load_scenario(file).replace(seabed={"kind": "rough", "depth_m": 4})
    assert "roughness_rms_m = 0.15" in changed.to_toml()


def test_a_place_that_is_none_is_refused(file: Path) -> None:
    with pytest.raises(ScenarioError, match=r"mission\.title\.a: there is no such place"):
        load_scenario(file, {"mission.title.a": 1})


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (b"[water]\ntype = clear\n", "line 2: not valid TOML: "),
        (b"[water\n", "line 1: not valid TOML: "),
        (b"a = 1\na = 2\n", "line 2: not valid TOML: "),
        (b"\n\na = '\xff'\n", "line 3: not UTF-8 text. Save the file as UTF-8."),
        (b"a = " + b"[" * 5000, "file: nested too deeply."),
        (b"#" * 1_000_001, "file: larger than 1 MB. Is it a scenario?"),
    ],
)
def test_broken_files_name_the_line(tmp_path: Path, content: bytes, line: str) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert len(caught.value.lines) == 1
    assert caught.value.lines[0].startswith(f"{path}: {line}")


def test_huge_numbers_are_faults(tmp_path: Path, file: Path) -> None:
    file.write_text(file.read_text().replace("10.0", "1" + "0" * 400), encoding="utf-8")
    with pytest.raises(ScenarioError):
        load_scenario(file)
    file.write_text("a = " + "1" * 5000, encoding="utf-8")
    with pytest.raises(ScenarioError, match="not valid TOML"):
        load_scenario(file)


def test_a_folder_is_no_scenario(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"cannot be read: Is a directory"):
        load_scenario(tmp_path)


def test_an_unknown_name_suggests_one_of_the_gallery() -> None:
    with pytest.raises(FileNotFoundError, match="Did you mean 'sandbar'"):
        load_scenario("sandbr")


def test_names_of_the_gallery_load() -> None:
    assert load_scenario("too-deep") == load_scenario(gallery()["too-deep"])


def test_settings_are_toml_values_or_bare_words() -> None:
    assert parse_overrides(["a.b=1", "a.c=1.5", "a.d=true", "a.e=word", "a.f = 'x = y'"]) == {
        "a.b": 1,
        "a.c": 1.5,
        "a.d": True,
        "a.e": "word",
        "a.f": "x = y",
    }


def test_a_setting_may_be_a_whole_section() -> None:
    flat = parse_overrides(['seabed={kind="plane", depth_m=50}'])
    assert flat == {"seabed": {"kind": "plane", "depth_m": 50}}
    assert load_scenario("sandbar", flat).seabed.kind == "plane"


@pytest.mark.parametrize(
    "setting", ["water.type", "water=3", "=3", "", "seabed={kind=plane}", "={a=1}"]
)
def test_settings_without_place_or_value_are_refused(setting: str) -> None:
    with pytest.raises(ScenarioError, match=r"Write section\.key=value"):
        parse_overrides([setting])


@pytest.mark.parametrize("text", ["3", "a:b", "5:5", "4:2", "0:99", "-1:3", "33:"])
def test_frames_outside_the_mission_are_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match=r"--frames"):
        parse_frames(text, 33)

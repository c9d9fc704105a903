"""The command `plan`: what it says, what it warns of, what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from survey.cli import app

KEYS = {
    *("overlap", "gaps", "density_per_m2", "depth_limit_m", "frames", "flight_time_s"),
    *("output_mb", "run_time_s"),
}
TURNED = ("turned-footprint", "--set", "flight.frames_per_line=3")


def planned(*words: str | Path) -> Any:
    return CliRunner().invoke(app, ["plan", *map(str, words)])


def test_gaps_are_warned_of_and_drawn(tmp_path: Path) -> None:
    picture = tmp_path / "plan.png"
    result = planned(*TURNED, "--plot", picture)
    assert result.exit_code == 0
    assert "WARNING: gaps at the water surface: 2, " in result.stderr
    assert "48.8 m along the lines" in result.stderr
    assert "WARNING: gaps on the seabed: 2, " in result.stderr
    assert "none, gap 48.8 m" in result.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert [file.name for file in tmp_path.iterdir()] == ["plan.png"]


def test_json_is_alone_on_standard_output(tmp_path: Path) -> None:
    result = planned(*TURNED, "--json", "--plot", tmp_path / "plan.svg")
    found = json.loads(result.stdout)
    assert set(found) >= KEYS
    assert result.stderr.splitlines() == [f"WARNING: {line}" for line in found["warnings"]]
    assert "<svg" in (tmp_path / "plan.svg").read_text()


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["nowhere"], 3, "no such file, and no scenario of that name"),
        (["sandbar", "--set", "flight.height_m=-5"], 2, "flight.height_m"),
        (["sandbar", "--set", "flight.hight_m=5"], 2, "Did you mean 'height_m'?"),
        (["sandbar", "--plot", "plan.bmp"], 2, "writes .png or .svg"),
        (["sandbar", "--plot", "no/such/plan.png"], 2, "there is no folder"),
    ],
)
def test_bad_input_is_told_without_a_traceback(
    words: list[str], status: int, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = planned(*words)
    assert result.exit_code == status
    assert message in result.stderr
    assert "Traceback" not in result.output
    assert not list(tmp_path.iterdir())

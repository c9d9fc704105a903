"""The command line: what users type, what they get, and with which status."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.errors import OtherRunError
from survey.scenario.gallery import gallery
from survey.scenario.toml_text import to_toml

HEAVY = {"open3d", "pyvista", "vtkmodules", "matplotlib", "trimesh", "rasterio", "laspy", "numba"}


@pytest.fixture
def file(tmp_path: Path, tables: dict[str, Any]) -> Path:
    path = tmp_path / "reef.toml"
    path.write_text(to_toml(tables), encoding="utf-8")
    return path


class FlyingClub:
    """Stands in for the mission: remembers what it was asked for."""

    def __init__(self) -> None:
        self.asked: dict[str, Any] = {}
        self.trouble: BaseException | None = None

    def fly(self, scenario: Any, folder: Path, **wishes: Any) -> Path:
        self.asked = {"scenario": scenario, "folder": folder, **wishes}
        if self.trouble is not None:
            raise self.trouble
        watch = wishes["watch"]
        watch.started(1)
        watch.frame_done(0, 0.5)
        watch.finished("1 frame, 2048 bottom points")
        return folder


@pytest.fixture
def club(monkeypatch: pytest.MonkeyPatch) -> FlyingClub:
    club, mission = FlyingClub(), ModuleType("survey.mission")
    mission.fly = club.fly  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "survey.mission", mission)
    return club


def typed(*words: str | Path) -> Any:
    return CliRunner().invoke(app, [str(word) for word in words])


def test_run_hands_its_wishes_to_the_mission(club: FlyingClub, file: Path, tmp_path: Path) -> None:
    result = typed(
        *("run", file, "-o", tmp_path / "out", "--workers", "2", "--frames", "1:2"),
        *("--set", "water.type=clear", "--set", "flight.lines=3"),
    )
    assert result.exit_code == 0
    assert club.asked["folder"] == tmp_path / "out"
    assert club.asked["crew"].described == "2 processes"
    assert club.asked["frames"] == range(1, 2)
    assert club.asked["scenario"].water.type == "clear"
    assert club.asked["scenario"].flight.lines == 3
    assert "1/1 frames" in result.stdout
    assert "2048 bottom points" in result.stdout


def test_run_takes_workers_from_the_scenario_and_flies_all_frames(
    club: FlyingClub, file: Path, tmp_path: Path
) -> None:
    assert typed("run", file, "-o", tmp_path, "--set", "run.workers=5").exit_code == 0
    assert (club.asked["crew"].described, club.asked["frames"]) == ("5 processes", None)


def test_run_flies_with_threads_and_on_clusters(
    club: FlyingClub, file: Path, tmp_path: Path
) -> None:
    assert typed("run", file, "-o", tmp_path, "--workers", "3", "--with", "threads").exit_code == 0
    assert club.asked["crew"].described == "3 threads"
    both = typed("run", file, "-o", tmp_path, "--with", "threads", "--cluster", "tcp://there:1")
    assert both.exit_code == 2
    assert "Leave out --workers and --with" in both.stderr


def test_quiet_is_quiet(club: FlyingClub, file: Path, tmp_path: Path) -> None:
    assert typed("run", file, "-o", tmp_path, "--quiet").output == ""


@pytest.mark.parametrize(
    ("trouble", "status", "text"),
    [
        (OtherRunError("runs/a: another scenario."), 5, "runs/a: another scenario."),
        (KeyboardInterrupt(), 130, "interrupted. The same command goes on from here."),
        (FileNotFoundError(2, "No such file", "a.tif"), 3, "a.tif: no such file."),
        (PermissionError(13, "Permission denied", "runs"), 2, "runs: permission denied."),
        (OSError(28, "No space left on device"), 2, "No space left on device"),
        (MemoryError(), 70, "out of memory."),
        (ZeroDivisionError("by\nzero"), 70, "a fault of bathyflash: ZeroDivisionError: by zero."),
        (ValueError("shapes"), 70, "a fault of bathyflash: ValueError: shapes."),
    ],
)
def test_trouble_has_its_status_and_no_traceback(
    club: FlyingClub, file: Path, tmp_path: Path, trouble: BaseException, status: int, text: str
) -> None:
    club.trouble = trouble
    result = typed("run", file, "-o", tmp_path)
    assert result.exit_code == status
    assert text in result.stderr
    assert "Traceback" not in result.output


def test_check_says_sound(file: Path) -> None:
    result = typed("check", file)
    assert result.exit_code == 0
    assert result.stdout == f"{file}: sound, lines x frames: 1 x 2\n"


def test_check_shows_the_faults_of_all_files(file: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.toml"
    bad.write_text(file.read_text().replace("depth_m", "depht_m"), encoding="utf-8")
    result = typed("check", bad, file, "no-such-name")
    assert result.exit_code == 2
    assert f"{bad}: seabed.depth_m: missing. Give it a value." in result.stderr
    assert f"{bad}: seabed.depht_m: unknown key. Did you mean 'depth_m'?" in result.stderr
    assert "no-such-name: no such file" in result.stderr
    assert f"{file}: sound" in result.stdout


def test_missing_files_have_status_3(tmp_path: Path, file: Path) -> None:
    assert typed("check", tmp_path / "none.toml").exit_code == 3
    assert typed("run", tmp_path / "none.toml", "-o", tmp_path / "out").exit_code == 3
    seabed = '[seabed]\nkind = "raster"\nfile = "none.tif"\n'
    file.write_text(file.read_text().split("[seabed]")[0] + seabed, encoding="utf-8")
    assert typed("check", file).exit_code == 3


@pytest.mark.parametrize(
    "words",
    [
        ["fly"],
        ["run"],
        ["run", "too-deep"],
        ["run", "too-deep", "-o", "out", "--workers", "-1"],
        ["run", "too-deep", "-o", "out", "--frames", "3"],
        ["run", "too-deep", "-o", "out", "--set", "water.type=mud"],
        ["run", "too-deep", "-o", "out", "--set", "water"],
        ["check"],
    ],
)
def test_bad_words_have_status_2(words: list[str]) -> None:
    result = typed(*words)
    assert result.exit_code == 2
    assert "Traceback" not in result.output


def test_view_of_nothing_has_status_3(tmp_path: Path) -> None:
    result = typed("view", tmp_path / "none", "--screenshot", tmp_path / "a.png")
    assert result.exit_code == 3
    assert str(tmp_path / "none") in result.stderr


def test_the_gallery_is_listed_with_a_line_each() -> None:
    result = typed("scenarios")
    assert result.exit_code == 0
    assert "sandbar           Two lines out from a made beach over a bar" in result.stdout
    lines = result.stdout.splitlines()
    assert len(lines) == len(gallery())
    assert max(map(len, lines)) <= 120


def test_help_and_check_load_no_heavy_library(file: Path) -> None:
    program = (
        "import sys; from survey.cli import app\n"
        "try: app(['check', sys.argv[1]])\n"
        "except SystemExit as end: print(end.code, sorted(set(sys.modules) & set(sys.argv[2:])))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, str(file), *HEAVY],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1] == "0 []"

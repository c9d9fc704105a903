"""The picture of a run folder, and what is said when there can be none."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.products.ply_file import write_ply
from survey.products.trajectory_file import write_trajectory_csv
from viewer import rendering
from viewer.run_folder import read_run
from viewer.screenshot import screenshot

SCENARIO = """
[mission]
title = "A bar"
description = "Made by hand."
[surface]
water_level_m = 0.25
"""


@pytest.fixture
def run(small_survey: Any, tmp_path: Path) -> Path:
    """A run folder with the files that a picture needs."""
    folder = tmp_path / "run"
    folder.mkdir()
    write_ply(folder / "bottom.ply", small_survey.bottom, small_survey.map_frame)
    write_ply(folder / "water_surface.ply", small_survey.surface, small_survey.map_frame)
    frames = small_survey.frames
    poses = [frame.pose for frame in frames]
    write_trajectory_csv(folder / "trajectory.csv", frames, poses, small_survey.map_frame)
    (folder / "scenario.toml").write_text(SCENARIO)
    return folder


@pytest.fixture
def fresh_probe() -> Iterator[None]:
    """Forget what was found out about rendering, before and after."""
    rendering._fault.cache_clear()
    yield
    rendering._fault.cache_clear()


def pixels_of(file: Path) -> np.ndarray[Any, Any]:
    """Return the picture (height, width, 3) of bytes."""
    from matplotlib.image import imread

    return (imread(BytesIO(file.read_bytes()), format="png")[..., :3] * 255).astype(np.int64)


def share_of(picture: np.ndarray[Any, Any], colour: tuple[int, int, int], near: int) -> float:
    """Return the share of pixels within a distance of a colour."""
    return float(np.mean(np.abs(picture - np.array(colour)).max(axis=2) <= near))


def test_picture_shows_seabed_flight_and_land(run: Path, tmp_path: Path) -> None:
    screenshot(run, tmp_path / "a.png")
    picture = pixels_of(tmp_path / "a.png")
    assert picture.shape == (1000, 1600, 3)
    assert 0.4 < share_of(picture, (255, 255, 255), 0) < 0.85
    assert share_of(picture, (196, 80, 12), 12) > 1e-3
    assert share_of(picture, (33, 144, 140), 45) > 0.02
    assert share_of(picture, (196, 178, 142), 30) > 0.01
    frame = np.concatenate([picture[:8].reshape(-1, 3), picture[-8:].reshape(-1, 3)])
    assert np.all(frame == 255)


def test_same_run_same_picture(run: Path, tmp_path: Path) -> None:
    screenshot(run, tmp_path / "a.png")
    screenshot(run, tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_caption_changes_the_foot_alone(run: Path, tmp_path: Path) -> None:
    screenshot(run, tmp_path / "a.png")
    screenshot(run, tmp_path / "b.png", caption="Another caption.")
    first, second = pixels_of(tmp_path / "a.png"), pixels_of(tmp_path / "b.png")
    rows = np.flatnonzero(np.any(first != second, axis=(1, 2)))
    assert rows.size > 0
    assert rows.min() > 900


def test_run_is_read_as_it_was_flown(run: Path, small_survey: Any) -> None:
    flown = read_run(run)
    assert (flown.title, flown.description, flown.water_level) == ("A bar", "Made by hand.", 0.25)
    positions = np.array([frame.pose.position for frame in small_survey.frames])
    np.testing.assert_allclose(flown.positions, positions, atol=1e-4)
    np.testing.assert_allclose(flown.headings, np.radians(70.0))
    assert len(flown.bottom) == len(small_survey.bottom)
    assert len(flown.surface) == len(small_survey.surface)


def test_missing_files_are_all_named(run: Path, tmp_path: Path) -> None:
    (run / "bottom.ply").unlink()
    (run / "trajectory.csv").unlink()
    with pytest.raises(FileNotFoundError, match=r"run: no bottom\.ply, no trajectory\.csv\."):
        screenshot(run, tmp_path / "a.png")


def test_a_scenario_without_water_level_is_refused(run: Path) -> None:
    (run / "scenario.toml").write_text('[mission]\ntitle = "A bar"\n')
    with pytest.raises(ValueError, match=r"scenario\.toml: surface\.water_level_m: missing"):
        read_run(run)


@pytest.mark.parametrize(
    ("program", "words"),
    [
        ("import os; os.kill(os.getpid(), 11)", "VTK crashed (signal 11)"),
        ("raise ImportError('libGL.so.1: cannot open')", "libGL.so.1: cannot open"),
        ("raise SystemExit(3)", "blank picture"),
    ],
)
@pytest.mark.usefixtures("fresh_probe")
def test_a_machine_that_cannot_render_says_what_to_type(
    monkeypatch: pytest.MonkeyPatch, program: str, words: str
) -> None:
    monkeypatch.setattr(rendering, "PROBE", program)
    with pytest.raises(RuntimeError) as caught:
        rendering.require_rendering()
    assert words in str(caught.value)
    assert "apt-get install -y libexpat1 libegl1 libgl1" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("fresh_probe")
def test_this_machine_renders() -> None:
    rendering.require_rendering()

"""Waveforms on the page are the run's own; what cannot be shown is left out loudly or refused."""

from __future__ import annotations

import zlib
from base64 import b64decode
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.errors import OtherRunError
from survey.labelled.flown_run import FlownRun
from survey.labelled.picked import PickedPixels
from survey.mission import fly
from survey.progress import Unwatched
from survey.scenario.load import load_scenario
from survey.scenario.toml_text import to_toml
from tests.small_scenario import small_tables
from viewer.web import make
from viewer.web.make import make_page
from viewer.web.marks import marked_pixels
from viewer.web.waveforms import waveforms

SMALL = small_tables(
    **{
        "camera": {"rows": 4, "columns": 8},
        "seabed": {"kind": "plane", "depth_m": 4.0, "substrate": "sand"},
        "transport": {"walks_per_pixel": 16, "tracks_per_replicate": 128},
    }
)


class Listener(Unwatched):
    """Keeps what it is told."""

    def __init__(self) -> None:
        self.notices: list[str] = []
        self.frames: list[int] = []

    def noticed(self, text: str) -> None:
        """Keep it."""
        self.notices.append(text)

    def frame_done(self, index: int, seconds: float) -> None:
        """Keep it."""
        self.frames.append(index)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    room = tmp_path_factory.mktemp("flown")
    (room / "small.toml").write_text(to_toml(SMALL))
    fly(load_scenario(room / "small.toml"), room / "run", workers=1)
    return room / "run"


@pytest.fixture(scope="module")
def shown(folder: Path) -> dict[str, Any]:
    return waveforms(FlownRun.open(folder), at_least=20, watch=Unwatched())


def curve(shown: dict[str, Any], name: str, pixel: int) -> Any:
    """Return the codes of one curve, by the words of the format."""
    table = shown["curves"]
    content = np.frombuffer(zlib.decompress(b64decode(table["data"])), np.uint8)
    start = 0
    for column in table["columns"]:
        size = column["bytes"] * table["count"]
        if column["name"] == name:
            planes = content[start : start + size].reshape(-1, table["count"]).astype(np.int64)
            zigzag = sum(plane << (8 * k) for k, plane in enumerate(planes))
            whole = np.cumsum((zigzag >> 1) ^ -(zigzag & 1))
            return whole[pixel * shown["bins"] : (pixel + 1) * shown["bins"]]
        start += size
    raise AssertionError(name)


def test_they_are_those_of_the_frames_flown_again(folder: Path, shown: dict[str, Any]) -> None:
    number = 7
    pixel = shown["pixels"][number]
    address = {name: pixel[name] for name in ("frame", "row", "column")}
    true = PickedPixels(FlownRun.open(folder)).waveform(**address)
    np.testing.assert_array_equal(curve(shown, "counts", number), true.counts)
    light = true.expected_bottom.values * shown["pulses"]
    codes = curve(shown, "bottom", number)
    again = np.where(codes == 0, 0.0, 1e-4 * 1.02 ** (codes - 1.0))
    np.testing.assert_allclose(again, np.where(light < 1e-4, 0.0, light), rtol=0.0101)
    assert light.max() > 1.0
    assert pixel["trueBottom"] == pytest.approx(float(true.true_bottom_time) * 1e9, rel=1e-5)
    in_water = (pixel["trueBottom"] - pixel["trueSurface"]) * pixel["metresPerNs"]
    assert in_water == pytest.approx(pixel["trueDepth"], abs=0.3)


def test_more_frames_are_flown_where_one_has_too_few_pixels(folder: Path) -> None:
    frames = FlownRun.open(folder).whole
    found = marked_pixels(folder, frames, at_least=40)
    assert [(mark.frame, len(mark.row)) for mark in found] == [(0, 20), (1, 20)]


def test_the_page_that_is_tested_has_the_same_parts(
    shown: dict[str, Any], flown: Any, waveforms_of: Callable[..., dict[str, Any]]
) -> None:
    made = waveforms_of(flown.bottom)
    assert made.keys() == shown.keys()
    assert made["pixels"][0].keys() == shown["pixels"][0].keys()
    names = [{column["name"] for column in table["curves"]["columns"]} for table in (made, shown)]
    assert names[0] == names[1]


def test_a_page_of_a_run_is_written_whole(folder: Path, tmp_path: Path) -> None:
    watch = Listener()
    make_page(folder, tmp_path / "run.html", pixels=20, watch=watch)
    text = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert text.endswith("</html>\n")
    assert "Waveforms of 20 marked pixels of 1 frames are here" in text
    assert len(watch.frames) == 1
    assert watch.notices == []
    assert [file.name for file in tmp_path.iterdir()] == ["run.html"]


def test_a_run_of_other_code_is_shown_without_waveforms_or_refused(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def other(*_: Any, **__: Any) -> None:
        raise OtherRunError("the frame differs")

    monkeypatch.setattr(make, "waveforms", other)
    watch = Listener()
    make_page(folder, tmp_path / "run.html", pixels=None, watch=watch)
    assert watch.notices == ["waveforms are left out: the frame differs"]
    assert "No waveforms are here" in (tmp_path / "run.html").read_text(encoding="utf-8")
    with pytest.raises(OtherRunError, match="leave waveforms out: --waveforms 0"):
        make_page(folder, tmp_path / "other.html", pixels=8, watch=watch)
    assert not (tmp_path / "other.html").exists()


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (["--web", "page.txt"], 2, "page.txt: not a page"),
        ([], 2, "no display for a window: DISPLAY is not set"),
        (["--web", "none/page.html"], 2, "no folder none. Make it first"),
    ],
)
def test_what_cannot_be_done_is_told(
    folder: Path, words: list[str], status: int, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    result = CliRunner().invoke(app, ["view", str(folder), *words])
    assert (result.exit_code, "Traceback" in result.output) == (status, False)
    assert said in result.stderr


def test_a_missing_run_has_status_3(tmp_path: Path) -> None:
    result = CliRunner().invoke(
        app, ["view", str(tmp_path / "none"), "--web", str(tmp_path / "a.html")]
    )
    assert result.exit_code == 3
    assert str(tmp_path / "none") in result.stderr

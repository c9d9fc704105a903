"""The page as a file: whole, alone, in order, and honest about what it lacks."""

from __future__ import annotations

import json
import re
from base64 import b64decode, b64encode
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import PointClass
from survey.errors import UserError
from viewer.web import marks
from viewer.web.make import require_place
from viewer.web.page import html, page_contents
from viewer.web.points import chosen_points
from viewer.web.seabed import true_seabed

LARGEST_MB = 20.0


def test_policy_forbids_the_network_and_names_the_very_script(page_file: Path) -> None:
    text = page_file.read_text(encoding="utf-8")
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)
    assert policy is not None
    assert policy[1].startswith("default-src 'none'; img-src data:; script-src 'sha256-")
    script = text[text.rindex("<script>") + len("<script>") : text.rindex("</script>")]
    digest = b64encode(sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in policy[1]


def test_licence_of_three_js_is_in_the_page(page_file: Path) -> None:
    text = page_file.read_text(encoding="utf-8")
    assert "three.js authors" in text
    assert "Permission is hereby granted, free of charge" in text


def test_words_of_a_scenario_cannot_leave_their_place(flown: Any) -> None:
    evil = replace(flown, title="</script><script>alert(1)</script>@SCRIPT@")
    text = html(page_contents(evil, chosen_points(evil, at_most=100)))
    assert text.count("</script>") == 2
    assert "<script>alert" not in text


def test_same_run_same_page(flown: Any, contents: dict[str, Any]) -> None:
    again = page_contents(
        flown, chosen_points(flown, at_most=10_000), waveforms=contents["waveforms"],
        substrates={1: "sand"},
    )  # fmt: skip
    assert html(again) == html(contents)


def test_points_beyond_the_limit_are_drawn_by_lot_and_told(flown: Any) -> None:
    chosen = chosen_points(flown, at_most=200)
    bottom = chosen["bottom"].cloud
    assert len(bottom) == 200
    assert np.all(np.diff(bottom.frame.astype(int)) >= 0)
    assert np.unique(bottom.frame).size == 6
    told = page_contents(flown, chosen)["leftOut"]
    assert told[0] == ("200 of 1,641 points of bottom, objects and ground are here, drawn by lot.")
    assert any(words.startswith("No waveforms are here") for words in told)


def test_a_run_without_bottom_is_refused_with_a_reason(flown: Any) -> None:
    none = np.full_like(flown.bottom.classification, PointClass.NO_BOTTOM_FOUND)
    empty = replace(flown, bottom=replace(flown.bottom, classification=none))
    with pytest.raises(UserError, match="no point of bottom or ground in the run"):
        chosen_points(empty, at_most=10)


def test_contents_are_plain_json(contents: dict[str, Any]) -> None:
    assert json.loads(json.dumps(contents, allow_nan=False))["waterLevel"] == 0.25


def test_true_seabed_is_where_it_is(flown: Any) -> None:
    class Slope:
        """A plane that falls 1 m in 10 m eastwards."""

        @staticmethod
        def elevation_at(x: Any, y: Any) -> Any:
            return -0.1 * x + 0.0 * y

    found = true_seabed(Slope(), flown.bottom)  # type: ignore[arg-type]
    assert found["columns"] * found["rows"] == found["elevation"]["count"]
    assert found["start"] * found["step"] == pytest.approx(
        -0.1 * (found["x"] + found["cell"] * (found["columns"] - 1)), abs=0.003
    )


def test_marks_show_every_outcome_and_all_of_the_rare() -> None:
    outcome = np.zeros((16, 16), np.uint8)
    outcome[3, 4:7] = 7
    found = marks._marks(5, outcome, 40)
    assert len(found.row) == 40
    chosen = set(zip(found.row.tolist(), found.column.tolist(), strict=True))
    assert {(3, 4), (3, 5), (3, 6)} <= chosen
    assert len(chosen) == 40


@pytest.mark.parametrize("name", ["page.txt", "none/page.html", "folder.html"])
def test_a_page_without_a_place_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "folder.html").mkdir()
    with pytest.raises(UserError, match=re.escape(name.split("/")[0])):
        require_place(tmp_path / name)


@pytest.mark.slow
def test_two_million_points_stay_below_20_mb(survey_of: Any) -> None:
    flown = survey_of(frames=1000, rows=32, columns=68)
    contents = page_contents(flown, chosen_points(flown, at_most=2_000_000))
    assert contents["clouds"]["bottom"]["count"] == 2_000_000
    assert len(html(contents).encode()) < LARGEST_MB * 1e6
    assert b64decode(contents["clouds"]["bottom"]["data"])

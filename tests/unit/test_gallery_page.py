"""The page of the gallery has every scenario, in its own words, with a picture."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from PIL import Image

from survey.scenario.gallery import gallery, shows
from survey.scenario.load import load_scenario
from tools.gallery.page import NOT_FLOWN

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "gallery.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", sorted(gallery()))
def test_the_page_has_the_scenario_in_its_own_words(name: str) -> None:
    mission = load_scenario(name).mission
    part = PAGE.partition(f"\n## {name}\n")[2].partition("\n## ")[0]
    assert mission.description.strip() in part
    assert f"**Expect:** {mission.expect.strip()}" in part
    assert f"| [{name}](#{name}) | {shows(gallery()[name]).rstrip('.')} |" in PAGE
    if NOT_FLOWN not in part:
        assert "**Measured:** " in part
        assert f"](gallery/{name}.png)" in part


@pytest.mark.parametrize("name", re.findall(r"\]\(gallery/(.+)\.png\)", PAGE))
def test_the_picture_is_there_and_small(name: str) -> None:
    file = DOCS / f"gallery/{name}.png"
    assert file.stat().st_size < 150_000
    with Image.open(file) as picture:
        picture.verify()
        assert picture.width >= 800


def test_no_picture_is_left_of_a_scenario_that_is_gone() -> None:
    assert {file.stem for file in (DOCS / "gallery").iterdir()} <= gallery().keys()

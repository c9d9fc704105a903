"""The page on orientation says what is tested, sentence by sentence."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/orientation.md"
TESTS = Path(__file__).parent / "test_orientation.py"


def as_name(sentence: str) -> str:
    """Return how a test of a sentence is called: "Pixel (0, 0) is left." is pixel_0_0_is_left."""
    return re.sub(r"[^a-z0-9]+", "_", sentence.lower()).strip("_")


def test_the_page_says_exactly_what_is_tested() -> None:
    sentences = re.findall(r"^- (.+)$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    tested = re.findall(r"^def test_(\w+)\(", TESTS.read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert sorted(map(as_name, sentences)) == sorted(tested)

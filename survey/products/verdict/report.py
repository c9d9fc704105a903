"""The verdict as a section of the report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

from survey.products.report.page import Figure
from survey.products.verdict.failure_picture import failure_picture
from survey.products.verdict.mission import Judged
from survey.products.verdict.words import CRITERIA, verdict_sentence

RULES = {"density": "density", "holes": "holes with their cause"}


def verdict_section(judged: Judged) -> list[str]:
    """Return lines of HTML: the order's verdict and why, the others, the map of failures."""
    s44, norway = judged.metrics["s44"], judged.metrics["norwegian_alb"]
    spoken_of = s44["orders"][s44["judged"]]
    asked = "asked for" if s44["asked"] else "the strictest order that passes, or the least strict"
    others = [found for key, found in s44["orders"].items() if key != s44["judged"]]
    return [
        "<h2>Verdict</h2>",
        f"<p>By {escape(s44['standard'])} ({asked}): <b>{verdict_sentence(spoken_of)}.</b> "
        "Depths count from the scenario's water level.</p>",
        *_table(spoken_of["criteria"], CRITERIA),
        *(f"<p>{_other(found)}</p>" for found in others),
        f"<p>By {escape(norway['standard'])}:</p>",
        *_table(norway["criteria"], RULES),
    ]


def failure_figure(judged: Judged) -> Figure:
    """Return the map of where the order is not met."""
    return Figure(
        name="failures",
        png=failure_picture(judged.failures),
        words=f"Where {judged.failures.title} is not met, and why; failures.geojson has the same "
        "areas.",
    )


def _table(criteria: Mapping[str, Any], names: Mapping[str, str]) -> Iterator[str]:
    yield "<table>"
    for name, found in criteria.items():
        yield (
            f"<tr><td>{names[name]}</td><td>{found['result']}</td>"
            f"<td>{escape(found['reason'])}</td></tr>"
        )
    yield "</table>"


def _other(found: Mapping[str, Any]) -> str:
    reasons = "; ".join(
        dict.fromkeys(found["criteria"][name]["reason"] for name in found["failed"])
    )
    return escape(f"{verdict_sentence(found)}{': ' if reasons else ''}{reasons}.")

"""The documents' examples: scenarios are sound, Python runs, commands and tests are there."""

from __future__ import annotations

import ast
import doctest
import re
import tomllib
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
import typer

import survey
from survey.cli import app
from survey.scenario import Scenario, ScenarioError
from survey.scenario.seabed_files import require_readable_files
from tests.small_scenario import small_tables

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs").glob("**/*.md"))
FENCE = re.compile(r"^```(\w*)\n(.*?)^```", flags=re.MULTILINE | re.DOTALL)
COMPARISON = re.compile(r"`(tests/[\w/.]+)(?:::(\w+))?` \|$", flags=re.MULTILINE)


def fences(language: str) -> list[Any]:
    """Return every example in a language, named by its page."""
    return [
        pytest.param(text, id=f"{page.stem}: {text.splitlines()[0]}")
        for page in PAGES
        for name, text in FENCE.findall(page.read_text(encoding="utf-8"))
        if name == language
    ]


def completed(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of an example, with what a small scenario says where they are silent."""
    whole = small_tables()
    for section, table in tables.items():
        states_all = section == "water" or "kind" in table or "device" in table
        whole[section] = table if states_all else whole.get(section, {}) | table
    whole["detector"] = {"quantum_efficiency": 0.2, "dark_count_rate_hz": 1e4} | whole["detector"]
    return whole


def fault_of(tables: Mapping[str, Any], folder: Path) -> str:
    """Return what is wrong with a scenario beside files that are not there; nothing if sound."""
    try:
        Scenario.from_tables(tables, name="page", folder=folder)
    except ScenarioError as error:
        return "" if error.only_missing_files else str(error)
    return ""


@pytest.mark.parametrize("example", fences("toml"))
def test_scenarios_of_the_documents_are_sound(example: str, tmp_path: Path) -> None:
    assert fault_of(completed(tomllib.loads(example)), tmp_path) == ""


@pytest.mark.parametrize("example", fences("python"))
def test_python_of_the_documents_runs_or_reads(example: str) -> None:
    if not example.startswith(">>>"):
        ast.parse(example)
        return
    test = doctest.DocTestParser().get_doctest(example, {}, "page", None, 0)
    assert doctest.DocTestRunner().run(test).failed == 0


def commands_in(text: str) -> Iterator[list[str]]:
    """Yield the words of every command line that begins a line or stands between back ticks."""
    for line in re.findall(r"(?:^|`)bathyflash ([a-z][^`#\n]*)", text, flags=re.MULTILINE):
        yield line.split()


@pytest.mark.parametrize("page", [ROOT / "README.md", *PAGES], ids=lambda page: page.stem)
def test_commands_of_the_documents_have_their_options(page: Path) -> None:
    group: Any = typer.main.get_command(app)
    for name, *words in commands_in(page.read_text(encoding="utf-8")):
        known = {option for param in group.commands[name].params for option in param.opts}
        assert {word for word in words if re.match(r"--?[a-z]", word)} <= known | {"--help"}


def test_comparisons_of_the_page_on_validation_are_tests() -> None:
    rows = COMPARISON.findall((ROOT / "docs/validation.md").read_text(encoding="utf-8"))
    assert len(rows) > 30
    for file, name in rows:
        source = (ROOT / file).read_text(encoding="utf-8")
        assert f"\ndef {name or 'test_'}" in source, f"{file}::{name}"


def test_figures_of_the_page_on_validation_are_those_that_are_drawn() -> None:
    source = (ROOT / "tools/validation_figures.py").read_text(encoding="utf-8")
    drawn = re.findall(r'^    "([\w-]+)": \w+,$', source, flags=re.MULTILINE)
    shown = re.findall(r"validation/([\w-]+)\.svg", (ROOT / "docs/validation.md").read_text())
    kept = {file.stem for file in (ROOT / "docs/validation").glob("*.svg")}
    assert set(drawn) == set(shown) == kept


def test_the_python_page_names_what_is_there_and_all_that_is_public() -> None:
    page = (ROOT / "docs/reference/python.md").read_text(encoding="utf-8")
    places = re.findall(r"^::: ([\w.]+)$", page, flags=re.MULTILINE)
    for place in places:
        module, name = place.rsplit(".", 1)
        assert getattr(import_module(module), name).__doc__, place
    assert {place.rsplit(".", 1)[1] for place in places} >= set(survey.__all__)


@pytest.mark.parametrize(("page", "file"), [("own-water", "cast"), ("own-trajectory", "flight")])
def test_files_of_the_documents_are_read(page: str, file: str, tmp_path: Path) -> None:
    shown = FENCE.findall((ROOT / f"docs/{page}.md").read_text(encoding="utf-8"))
    (text,) = (text for language, text in shown if not language and "," in text.splitlines()[0])
    (tmp_path / f"{file}.csv").write_text(text, encoding="utf-8")
    (tables,) = (tomllib.loads(toml) for _, toml in shown if f'"{file}.csv"' in toml)
    tables.get("flight", {}).pop("legs_s", None)  # of a flight that is longer
    sound = Scenario.from_tables(completed(tables), name="page", folder=tmp_path)
    require_readable_files(sound)

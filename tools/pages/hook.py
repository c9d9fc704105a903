"""What mkdocs does beside reading `docs`: pages that the code tells, formulas, links to sources."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

from tools.pages.command_reference import command_reference
from tools.pages.formulas import with_formulas
from tools.pages.notebook import notebook_page
from tools.pages.scenario_reference import scenario_reference

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
NOTEBOOK = DOCS / "notebook.ipynb"
OPTIONAL = {"gallery.md": DOCS / "gallery.md", "notebook.md": NOTEBOOK}
"""Pages of the navigation that stand in it once their source is there."""
SOURCE_LINK = re.compile(r"\[([^\]]+)\]\(\.\./([^)]+)\)")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Leave pages out of the navigation that are not there yet."""
    absent = {page for page, source in OPTIONAL.items() if not source.exists()}
    config.nav = _without(config.nav, absent)
    return config


def _without(entry: Any, pages: set[str]) -> Any:
    """Return a part of the navigation without some pages, and without what is empty then."""
    if isinstance(entry, list):
        kept = [_without(part, pages) for part in entry]
        return [part for part in kept if part]
    if isinstance(entry, dict):
        kept_pages = {title: _without(part, pages) for title, part in entry.items()}
        return {title: part for title, part in kept_pages.items() if part}
    return None if entry in pages else entry


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages and figures."""
    made: dict[str, Callable[[], str]] = {
        "index.md": partial(_moved, ROOT / "README.md"),
        "changes.md": partial(_moved, ROOT / "CHANGELOG.md"),
        "reference/scenario.md": scenario_reference,
        "reference/commands.md": command_reference,
    }
    for place, make in made.items():
        files.append(File.generated(config, place, content=make()))
    if NOTEBOOK.exists():
        for place, content in notebook_page(NOTEBOOK).items():
            files.append(File.generated(config, place, content=content))
    return files


def _moved(page: Path) -> str:
    """Return a page of the root with its links as they are among the documents."""
    text = page.read_text(encoding="utf-8")
    return text.replace("](docs/", "](")


def on_page_markdown(markdown: str, page: Any, config: MkDocsConfig, files: Files) -> str:
    """Name sources in the stead of links that leave the site."""
    return SOURCE_LINK.sub(r"\1 (`\2`)", markdown)


def on_page_content(html: str, page: Any, config: MkDocsConfig, files: Files) -> str:
    """Draw the formulas."""
    return with_formulas(html)

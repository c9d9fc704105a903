"""The scenarios that come with the package."""

from __future__ import annotations

import tomllib
from pathlib import Path

import scenarios


def gallery() -> dict[str, Path]:
    """Return the files of the gallery by their names.

    Examples
    --------
    >>> "measured-seabed" in gallery()
    True
    """
    folder = Path(scenarios.__path__[0])
    return {file.stem: file for file in sorted(folder.glob("*.toml"))}


def title(file: Path) -> str:
    """Return the title in a scenario file."""
    return str(tomllib.loads(file.read_text(encoding="utf-8"))["mission"]["title"])

"""The scenarios that come with the package."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import scenarios

SENTENCE_END = re.compile(r"(?<=\.) (?=[A-Z0-9])")


def gallery() -> dict[str, Path]:
    """Return the files of the gallery by their names.

    Examples
    --------
    >>> "measured-seabed" in gallery()
    True
    """
    folder = Path(scenarios.__path__[0])
    return {file.stem: file for file in sorted(folder.glob("*.toml"))}


def shows(file: Path) -> str:
    """Return what a scenario shows in one line: the first sentence of its description.

    Examples
    --------
    >>> shows(gallery()["turned-footprint"])
    'A camera turned by a quarter leaves gaps between flashes, over a bed from 2 m to 9 m deep.'
    """
    mission = tomllib.loads(file.read_text(encoding="utf-8"))["mission"]
    return SENTENCE_END.split(" ".join(mission["description"].split()))[0]

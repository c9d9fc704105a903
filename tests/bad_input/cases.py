"""Broken files by recipe: what is done to a sound file, and what the program must say of it."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from survey.scenario.scenario import with_changes
from survey.scenario.toml_text import to_toml
from tests.bad_input.good_files import GOOD_FILES, Good

CORPUS = Path(__file__).parent / "corpus"
REPEATED = re.compile(r"\{\{(\d+) x (.)\}\}")
"""``{{1000 x a}}`` in a recipe stands for a thousand of them."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A broken file.

    Parameters
    ----------
    kind : str
        Of the sound file that it is made from.
    name : str
        What is wrong with it.
    recipe : mapping
        One of ``text`` and ``hex``, the whole content; ``made``, arguments of the sound file's
        maker. Or changes of the sound content: ``replace`` old by new, ``line`` number by text,
        ``cut`` after so many bytes, ``prepend`` and ``append`` text, ``poke`` hex bytes at a
        place, ``set`` values of a scenario by dotted key.
    """

    kind: str
    name: str
    recipe: dict[str, Any]

    @property
    def good(self) -> Good:
        """The sound file's kind."""
        return GOOD_FILES[self.kind]

    @property
    def file(self) -> str:
        """The broken file's name."""
        return str(self.recipe.get("named", self.good.file))

    @property
    def says(self) -> list[str]:
        """What must stand in the message."""
        says = self.recipe.get("says", [])
        return [says] if isinstance(says, str) else says

    @property
    def status(self) -> int:
        """The exit status."""
        return int(self.recipe.get("exit", 2))

    def content(self) -> bytes:
        """Return the broken content."""
        recipe = self.recipe
        if "text" in recipe:
            return _long(recipe["text"]).encode()
        if "hex" in recipe:
            return bytes.fromhex(recipe["hex"])
        content = self.good.make(**recipe.get("made", {}))
        if "replace" in recipe:
            old, new = (words.encode() for words in recipe["replace"])
            assert content.count(old), f"{self.name}: {old!r} is not in the file"
            content = content.replace(old, new, 1)
        if "line" in recipe:
            lines = content.splitlines()
            lines[recipe["line"][0] - 1] = recipe["line"][1].encode()
            content = b"\n".join(lines) + b"\n"
        if "poke" in recipe:
            place, patch = recipe["poke"][0], bytes.fromhex(recipe["poke"][1])
            content = content[:place] + patch + content[place + len(patch) :]
        if "set" in recipe:
            content = _changed(content, recipe["set"])
        content = content[: recipe.get("cut")]
        return b"".join(
            [
                recipe.get("prepend", "").encode(),
                content,
                _long(recipe.get("append", "")).encode(),
            ]
        )

    def scenario(self) -> str:
        """Return the scenario that uses the broken file."""
        tables = tomllib.loads(self.good.scenario(self.file))
        return to_toml(with_changes(tables, self.recipe.get("used_by", {}), name="a test"))


def cases() -> Iterator[Case]:
    """Yield the corpus."""
    for table in sorted(CORPUS.glob("*.toml")):
        for name, recipe in tomllib.loads(table.read_text("utf-8")).items():
            yield Case(kind=recipe.pop("of", table.stem), name=name, recipe=recipe)


def _long(text: str) -> str:
    return REPEATED.sub(lambda found: int(found[1]) * found[2], text)


def _changed(content: bytes, changes: dict[str, Any]) -> bytes:
    changes = {key: _longer(value) for key, value in changes.items()}
    return to_toml(with_changes(tomllib.loads(content.decode()), changes, name="a test")).encode()


def _longer(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _longer(inner) for key, inner in value.items()}
    return _long(value) if isinstance(value, str) else value

"""Keys of scenarios with one slip of the finger: the key that was meant is suggested."""

from __future__ import annotations

import string
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from survey.scenario.addresses import Model, models_in, words_of
from survey.scenario.faults import ScenarioError
from survey.scenario.validate import SECTIONS, validate, validated

SLIPS_PER_KEY = 3
AT_LEAST = 0.95
Table = dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Place:
    """A table of a section, at any depth: its model, the kind it must say, and the way to it."""

    section: str
    model: Model
    said: Table
    around: Callable[[Table], Table]


def slips(word: str, random: np.random.Generator) -> list[str]:
    """Return a word with a letter left out, doubled, swapped with the next, or replaced."""
    found = set()
    for i in range(len(word)):
        found |= {word[:i] + word[i + 1 :], word[: i + 1] + word[i:]}
        found.add(word[:i] + word[i + 1 : i + 2] + word[i] + word[i + 2 :])
        other = string.ascii_lowercase[int(random.integers(26))]
        found.add(word[:i] + other + word[i + 1 :])
    return sorted(found - {word, ""})


def places(section: str, annotation: Any, around: Callable[[Table], Table]) -> Iterator[Place]:
    """Yield every table that a section may have, each model once on its way."""
    for model in models_in(annotation):
        words = {key: words_of(model, key)[:1] for key in ("kind", "type")}
        said = {key: word[0] for key, word in words.items() if word}
        yield Place(section=section, model=model, said=said, around=around)
        for name, field in model.model_fields.items():
            if models_in(field.annotation):
                yield from places(section, field.annotation, _inside(around, said, name, field))


def _inside(
    around: Callable[[Table], Table], said: Table, name: str, field: Any
) -> Callable[[Table], Table]:
    is_list = "list[" in str(field.annotation)
    return lambda table: around({**said, name: [table] if is_list else table})


def all_places() -> list[Place]:
    """Return the tables of all sections, of each model one."""
    found = [
        place
        for section, annotation in SECTIONS.items()
        for place in places(section, annotation, dict)
    ]
    return list({(place.section, place.model): place for place in reversed(found)}.values())


@pytest.fixture(scope="module")
def suggestions() -> list[tuple[str, bool]]:
    """Slips in the keys of all tables, and whether the right key was suggested."""
    random = np.random.default_rng(1)
    found = []
    for place in all_places():
        keys = place.model.model_fields.keys()
        for key in keys:
            wrong = [slip for slip in slips(key, random) if slip not in keys]
            for number in random.permutation(len(wrong))[:SLIPS_PER_KEY]:
                found.append((f"{place.section}: {key}", suggested(place, key, wrong[number])))
    return found


def suggested(place: Place, key: str, slip: str) -> bool:
    """Tell whether a table with a slip in a key is refused with the right suggestion."""
    table = {name: value for name, value in place.said.items() if name != key}
    table[slip] = place.said.get(key, 1)
    with pytest.raises(ScenarioError) as refused:
        validated(place.around(table), SECTIONS[place.section], place=place.section)
    return f"{slip}: unknown key. Did you mean '{key}'?" in str(refused.value)


def test_the_key_that_was_meant_is_suggested(suggestions: list[tuple[str, bool]]) -> None:
    assert len(suggestions) > 1000
    missed = [key for key, right in suggestions if not right]
    assert len(missed) <= (1.0 - AT_LEAST) * len(suggestions), missed


def test_the_section_that_was_meant_is_suggested() -> None:
    random = np.random.default_rng(2)
    found = []
    for section in SECTIONS:
        for slip in random.choice(slips(section, random), SLIPS_PER_KEY, replace=False).tolist():
            _, faults = validate({slip: {}})
            said = [fault.text for fault in faults if fault.place == slip]
            found.append(said == [f"unknown section. Did you mean '{section}'?"])
    assert np.mean(found) >= AT_LEAST

"""From plain tables to sections: every fault of every section in one go."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import BaseModel, TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from survey.scenario import motion_sections, sections
from survey.scenario.addresses import Way, all_models, follow, models_in, words_of
from survey.scenario.detector_sections import AnyDetector
from survey.scenario.faults import (
    Fault,
    ScenarioError,
    did_you_mean,
    nearest,
    shown,
    shown_key,
)
from survey.scenario.flight_sections import AnyFlight
from survey.scenario.seabed_sections import Seabed
from survey.scenario.surface_sections import Surface
from survey.scenario.water_sections import WAYS_TO_STATE_A_WATER, AnyWater

SECTIONS: dict[str, Any] = {
    "mission": sections.Mission,
    "flight": AnyFlight,
    "motion": motion_sections.Motion,
    "navigation": motion_sections.Navigation,
    "laser": sections.Laser,
    "camera": sections.Camera,
    "receiver": sections.Receiver,
    "detector": AnyDetector,
    "water": AnyWater,
    "surface": Surface,
    "seabed": Seabed,
    "sun": sections.Sun,
    "transport": sections.Transport,
    "processing": sections.Processing,
    "run": sections.Run,
}


def validate(tables: Mapping[str, Any]) -> tuple[dict[str, BaseModel], list[Fault]]:
    """Return the sections that are sound and the faults of all others."""
    sound: dict[str, BaseModel] = {}
    faults = [
        Fault(shown_key(name), f"unknown section.{did_you_mean(name, SECTIONS)}")
        for name in tables
        if name not in SECTIONS
    ]
    for name, annotation in SECTIONS.items():
        try:
            sound[name] = validated(tables.get(name, {}), annotation, place=name)
        except ScenarioError as error:
            faults += error.faults
    return sound, faults


def validated(table: Any, annotation: Any, *, place: str) -> Any:
    """Return the model of a type that a plain table describes.

    Raises
    ------
    ScenarioError
        With every fault of the table, each at its place below ``place``.
    """
    try:
        return TypeAdapter(annotation).validate_python(table)
    except ValidationError as error:
        details = error.errors(include_url=False)
    first = details[0]
    if first["type"] == "union_tag_invalid" and not first["loc"] and isinstance(table, Mapping):
        details += _faults_besides_the_kind(table, annotation, first["ctx"])
    ways = [follow((place, *detail["loc"]), {place: annotation}) for detail in details]
    raise ScenarioError(place, map(_fault, ways, details))


def _faults_besides_the_kind(
    table: Mapping[str, Any], annotation: Any, context: Mapping[str, Any]
) -> list[ErrorDetails]:
    """Return what else is wrong with a table of an unknown kind: as the kind with most its keys."""
    key = context["discriminator"].strip("'")
    likeliest = max(models_in(annotation), key=lambda model: len(model.model_fields.keys() & table))
    try:
        TypeAdapter(annotation).validate_python({**table, key: words_of(likeliest, key)[0]})
    except ValidationError as error:
        details = error.errors(include_url=False)
        return [detail for detail in details if detail["type"] != "missing"]
    return []


def _fault(way: Way, detail: ErrorDetails) -> Fault:
    place = ".".join(shown_key(step) for step in way.shown)
    if detail["type"].startswith("union_tag"):
        key = detail["ctx"]["discriminator"].strip("'")
        misspelt = _misspelt(key, way, detail["input"])
        if misspelt is not None:
            return Fault(f"{place}.{shown_key(misspelt)}", f"unknown key. Did you mean '{key}'?")
        place += "." + key
    return Fault(place, _text(way, detail))


def _misspelt(key: str, way: Way, table: Any) -> str | None:
    """Return the unknown key of a table that stands for a missing one, if any is like it."""
    if not isinstance(table, Mapping) or key in table:
        return None
    known = {name for model in way.choices for name in model.model_fields}
    return nearest(key, table.keys() - known)


def _unknown_key(way: Way) -> str:
    assert way.model is not None
    key = str(way.shown[-1])
    near = did_you_mean(key, way.model.model_fields)
    return f"unknown key.{_other_kind(key, way) or near or _other_home(key)}"


def _other_kind(key: str, way: Way) -> str:
    """Return which other kinds of the same table have the key, or nothing."""
    for name in ("kind", "type"):
        words = [
            word for model in way.choices if key in model.model_fields
            for word in words_of(model, name)
        ]  # fmt: skip
        if words:
            return f" It goes with {name} = {' or '.join(words)}."
    return ""


def _other_home(key: str) -> str:
    """Return the nearest key of another section and that section's name, or nothing."""
    homes = {known: place for place, model in all_models(SECTIONS) for known in model.model_fields}
    if key in homes:
        return f" It belongs in [{homes[key]}]."
    near = nearest(key, homes, likeness=0.8)
    return f" Did you mean '{near}'? It belongs in [{homes[near]}]." if near else ""


def _wrong_kind(detail: ErrorDetails) -> str:
    if detail["type"] == "union_tag_not_found":
        if detail["ctx"]["discriminator"] == "'type'":
            return f"missing. {WAYS_TO_STATE_A_WATER}"
        return "missing. Say which kind it is."
    return _not_one_of(detail["ctx"]["tag"], detail["ctx"]["expected_tags"])


def _not_one_of(given: object, expected: str) -> str:
    words = expected.replace(" or ", ", ").replace("'", "").split(", ")
    return f"{shown(given)} is not one of {', '.join(words)}.{did_you_mean(str(given), words)}"


def _text(way: Way, detail: ErrorDetails) -> str:
    kind, given = detail["type"], detail["input"]
    if kind == "extra_forbidden":
        return _unknown_key(way)
    if kind.startswith("union_tag"):
        return _wrong_kind(detail)
    if kind == "literal_error":
        return _not_one_of(given, detail["ctx"]["expected"])
    if kind in _BOUNDS:
        return f"{shown(given)} is out of bounds. It must be {_BOUNDS[kind](detail['ctx'])}."
    return _PLAIN.get(kind, "{given}: {message}.").format(given=shown(given), message=detail["msg"])


_BOUNDS: dict[str, Callable[[dict[str, Any]], str]] = {
    "greater_than": lambda bound: f"greater than {bound['gt']:g}",
    "greater_than_equal": lambda bound: f"at least {bound['ge']:g}",
    "less_than": lambda bound: f"less than {bound['lt']:g}",
    "less_than_equal": lambda bound: f"at most {bound['le']:g}",
}

_PLAIN = {
    "missing": "missing. Give it a value.",
    "finite_number": "{given} is not a finite number. Give it a value.",
    "beyond_reckoning": "{given} is {message}.",
    "float_type": "{given} is not a number.",
    "int_type": "{given} is not a whole number.",
    "bool_type": "{given} is not true or false.",
    "string_type": "{given} is not text in quotes.",
    "string_too_short": "the text is empty. Write some or leave the key out.",
    "list_type": "{given} is not a list.",
    "model_type": "{given} is not a table of keys.",
    "model_attributes_type": "{given} is not a table of keys.",
    "datetime_type": "{given} is not a date and time such as 2026-06-21T10:00:00Z.",
    "timezone_aware": "the time lacks its zone. Write it with Z, as 2026-06-21T10:00:00Z.",
}

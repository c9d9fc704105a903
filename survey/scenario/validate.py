"""From plain tables to sections: every fault of every section in one go."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, get_args

from pydantic import BaseModel, TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from survey.scenario import sections
from survey.scenario.faults import Fault, did_you_mean, nearest, shown, shown_key
from survey.scenario.seabed_sections import Seabed, SeabedObject

SECTIONS: dict[str, Any] = {
    "mission": sections.Mission,
    "flight": sections.Flight,
    "laser": sections.Laser,
    "camera": sections.Camera,
    "receiver": sections.Receiver,
    "detector": sections.Detector,
    "water": sections.Water,
    "surface": sections.Surface,
    "seabed": Seabed,
    "sun": sections.Sun,
    "transport": sections.Transport,
    "processing": sections.Processing,
    "run": sections.Run,
}


def kinds(union: Any) -> dict[str, type[BaseModel]]:
    """Return the models of a discriminated union by the word in their key `kind`."""
    models = get_args(get_args(union)[0])
    return {get_args(model.model_fields["kind"].annotation)[0]: model for model in models}


SEABEDS, OBJECTS = kinds(Seabed), kinds(SeabedObject)
ALL_MODELS: list[tuple[str, type[BaseModel]]] = [
    *(("seabed.objects", model) for model in OBJECTS.values()),
    *(("seabed", model) for model in SEABEDS.values()),
    *((name, model) for name, model in SECTIONS.items() if name != "seabed"),
]


def validate(tables: Mapping[str, Any]) -> tuple[dict[str, BaseModel], list[Fault]]:
    """Return the sections that are sound and the faults of all others."""
    sound: dict[str, BaseModel] = {}
    faults = [
        Fault(shown_key(name), f"unknown section.{did_you_mean(name, SECTIONS)}")
        for name in tables
        if name not in SECTIONS
    ]
    for name, model in SECTIONS.items():
        try:
            sound[name] = TypeAdapter(model).validate_python(tables.get(name, {}))
        except ValidationError as error:
            details = error.errors(include_url=False)
            faults += [_fault((name, *detail["loc"]), detail) for detail in details]
    return sound, faults


def _fault(address: tuple[str | int, ...], detail: ErrorDetails) -> Fault:
    path = _without_kinds(address)
    place = ".".join(shown_key(step) for step in path)
    if detail["type"].startswith("union_tag"):
        place += ".kind"
    return Fault(place, _text(address, detail))


def _without_kinds(address: tuple[str | int, ...]) -> tuple[str | int, ...]:
    """Leave out the words that say which kind of seabed or object was tried."""
    return tuple(
        step
        for index, step in enumerate(address)
        if not (_is_seabed(address[:index]) or _is_object(address[:index]))
    )


def _is_seabed(address: tuple[str | int, ...]) -> bool:
    return address == ("seabed",)


def _is_object(address: tuple[str | int, ...]) -> bool:
    return len(address) == 4 and address[2] == "objects"


def _model_at(address: tuple[str | int, ...]) -> type[BaseModel]:
    """Return the model whose keys stand beside the last step of an address."""
    if address[0] != "seabed":
        return SECTIONS[str(address[0])]  # type: ignore[no-any-return]
    if len(address) > 4:
        return OBJECTS[str(address[4])]
    return SEABEDS[str(address[1])]


def _unknown_key(address: tuple[str | int, ...]) -> str:
    key = str(address[-1])
    near = did_you_mean(key, _model_at(address).model_fields)
    return f"unknown key.{near or _other_home(key)}"


def _other_home(key: str) -> str:
    """Return the nearest key of another section and that section's name, or nothing."""
    homes = {known: name for name, model in ALL_MODELS for known in model.model_fields}
    if key in homes:
        return f" It belongs in [{homes[key]}]."
    near = nearest(key, homes, likeness=0.8)
    return f" Did you mean '{near}'? It belongs in [{homes[near]}]." if near else ""


def _wrong_kind(detail: ErrorDetails) -> str:
    if detail["type"] == "union_tag_not_found":
        return "missing. Say which kind it is."
    return _not_one_of(detail["ctx"]["tag"], detail["ctx"]["expected_tags"])


def _not_one_of(given: object, expected: str) -> str:
    words = expected.replace(" or ", ", ").replace("'", "").split(", ")
    return f"{shown(given)} is not one of {', '.join(words)}.{did_you_mean(str(given), words)}"


def _text(address: tuple[str | int, ...], detail: ErrorDetails) -> str:
    kind, given = detail["type"], detail["input"]
    if kind == "extra_forbidden":
        return _unknown_key(address)
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

"""The page that says of every key of a scenario what it means, from the models themselves."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, get_args, get_origin

from survey.scenario.addresses import Model, models_in, words_of
from survey.scenario.sections import LARGEST_SIZE, LEAST_SIZE
from survey.scenario.validate import SECTIONS

BOUNDS = (
    ("minimum", "from {}"),
    ("exclusiveMinimum", "above {}"),
    ("maximum", "to {}"),
    ("exclusiveMaximum", "below {}"),
)
TYPES = {"number": "number", "integer": "whole number", "boolean": "`true`, `false`"}
UNITS = {
    "w_m2_um_sr": "W/(m² µm sr)",
    "w_m2_nm": "W/(m² nm)",
    "pa_per_sqrt_hz": "pA/√Hz",
    "per_m2": "1/m²",
    "per_nm": "1/nm",
    "per_m": "1/m",
    "mg_m3": "mg/m³",
    "m_s": "m/s",
    "degc": "°C",
    "psu": "psu",
    "ntu": "NTU",
    "deg": "°",
    "mhz": "MHz",
    "hz": "Hz",
    "km": "km",
    "nm": "nm",
    "ns": "ns",
    "ps": "ps",
    "m": "m",
    "s": "s",
    "h": "h",
    "j": "J",
}
HEAD = f"""# Every key of a scenario

A scenario is a TOML file of these sections. A key ends in its unit. What has no default must be
stated; `[mission]`, `[flight]`, `[receiver]`, `[detector]`, `[water]`, `[surface]` and `[seabed]`
have such keys. Any table may have `source = "..."`, which says where its numbers come from.

Any number but 0 lies between {LEAST_SIZE:g} and {LARGEST_SIZE:g} in size. Rules that bind several
keys are told by `bathyflash check`, with every other fault of the file.
"""


def scenario_reference() -> str:
    """Return every section and table with its keys, units, values, defaults and meanings."""
    lines, told = [HEAD], dict[Model, str]()
    for place, annotation in _places():
        models = models_in(annotation)
        lines += ["", f"{'##' if place in SECTIONS else '###'} {_title(place, annotation)}", ""]
        if told.keys() >= set(models):
            lines += [f"As {told[models[0]]}{_words_among(models)}."]
        elif len(models) == 1:
            lines += [meaning_of(models[0]), "", *_table(models[0], model_keys(models[0]))]
        else:
            lines += _kinds([model for model in models if model not in told])
        told |= {model: _title(place, annotation) for model in models if model not in told}
    return "\n".join(lines) + "\n"


def _places() -> Iterator[tuple[str, Any]]:
    """Yield every table's place with what it may be: section by section, outer tables first."""
    for section, annotation in SECTIONS.items():
        level = {section: annotation}
        while level:
            yield from level.items()
            level = {
                f"{place}.{key}": field.annotation
                for place, outer in level.items()
                for model in models_in(outer)
                for key, field in model.model_fields.items()
                if models_in(field.annotation)
            }


def _title(place: str, annotation: Any) -> str:
    return f"`[[{place}]]`" if _is_list(annotation) else f"`[{place}]`"


def _is_list(annotation: Any) -> bool:
    if get_origin(annotation) is list:
        return True
    return any(_is_list(part) for part in get_args(annotation))


def _word(model: Model) -> str:
    """Return what `kind` or `type` says where a table is of this model."""
    words = words_of(model, "kind") or words_of(model, "type")
    return ", ".join(str(word) for word in words)


def _words_among(models: list[Model]) -> str:
    return "" if len(models) == 1 else f": {', '.join(f'`{_word(model)}`' for model in models)}"


def _discriminator(model: Model) -> str:
    return "kind" if "kind" in model.model_fields else "type"


def _kinds(models: list[Model]) -> Iterator[str]:
    """Yield what several kinds of a table have in common, and each with its own keys."""
    shared = [key for key in model_keys(models[0]) if all(_same(models, key))]
    key = _discriminator(models[0])
    yield f"`{key}` says which: {', '.join(f'`{_word(model)}`' for model in models)}."
    if shared:
        yield from ("", "Each of them has", "", *_table(models[0], shared))
    for model in models:
        own = [name for name in model_keys(model) if name not in shared]
        yield from ("", f"#### `{key}` = `{_word(model)}` {{ data-toc-label='{_word(model)}' }}")
        yield from ("", meaning_of(model), "", *(_table(model, own) if own else ()))


def _same(models: list[Model], key: str) -> Iterator[bool]:
    first = _schema(models[0])["properties"][key]
    for model in models:
        same = _schema(model)["properties"].get(key) == first
        yield same and text_of(model, key) == text_of(models[0], key)


def model_keys(model: Model) -> list[str]:
    """Return the keys of a table, without what says its kind and its source."""
    told_by_kind = {_discriminator(model)} if _word(model) else set()
    return [key for key in model.model_fields if key not in {"source", *told_by_kind}]


def meaning_of(model: Model) -> str:
    """Return what a table is, as its docstring says."""
    return inspect.cleandoc(model.__doc__ or "").replace("``", "`")


def text_of(model: Model, key: str) -> str:
    """Return what a key means: the text under it, in its own model or in one that it extends."""
    for owner in model.__mro__:
        text = _texts(owner).get(key)
        if text:
            return text
    return ""


@cache
def _texts(model: type) -> Mapping[str, str]:
    """Return the texts under a model's own keys.

    Pydantic can read them itself, for a tenth of a second at every start.
    """
    if not model.__module__.startswith("survey."):
        return {}
    body = ast.parse(textwrap.dedent(inspect.getsource(model))).body[0]
    assert isinstance(body, ast.ClassDef)
    return {
        field.target.id: " ".join(text.value.value.split())
        for field, text in zip(body.body, body.body[1:], strict=False)
        if isinstance(field, ast.AnnAssign)
        and isinstance(field.target, ast.Name)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
        and isinstance(text.value.value, str)
    }


@cache
def _schema(model: Model) -> dict[str, Any]:
    return model.model_json_schema()


def _table(model: Model, keys: list[str]) -> Iterator[str]:
    schema = _schema(model)
    required = schema.get("required", ())
    yield "| key | unit | values | default | meaning |"
    yield "|---|---|---|---|---|"
    for key in keys:
        about = schema["properties"][key]
        default = "**must be stated**" if key in required else _default(about.get("default"))
        cells = (f"`{key}`", unit_of(key), _values(about), default, text_of(model, key))
        yield f"| {' | '.join(cells)} |"


def unit_of(key: str) -> str:
    """Return the unit that a key ends in; nothing where it has none.

    Examples
    --------
    >>> unit_of("absorption_per_m"), unit_of("wind_speed_m_s"), unit_of("lines")
    ('1/m', 'm/s', '')
    """
    fitting = [unit for ending, unit in UNITS.items() if f"_{key}".endswith(f"_{ending}")]
    return fitting[0] if fitting else ""


def _default(value: Any) -> str:
    if value is None or value == []:
        return ""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, Mapping):
        return f'`"{value["kind"]}"`'
    return f'`"{value}"`' if isinstance(value, str) else f"`{value}`"


def _values(about: Mapping[str, Any]) -> str:
    """Return which values a key may have, in words."""
    if "anyOf" in about:
        ways = [_values(way) for way in about["anyOf"] if way.get("type") != "null"]
        return " or ".join(dict.fromkeys(ways))
    if "enum" in about:
        return ", ".join(f'`"{word}"`' for word in about["enum"])
    if "const" in about:
        return f'`"{about["const"]}"`'
    if any(word in about for word in ("$ref", "oneOf", "discriminator")):
        return "table"
    kind = about.get("type")
    if kind == "object":
        return "table"
    if kind == "array":
        return f"list: {_values(about.get('items', {}))}"
    if about.get("format") == "date-time":
        return "date and time"
    bounds = [words.format(_plain(about[name])) for name, words in BOUNDS if name in about]
    return f"{TYPES.get(str(kind), 'text')}{', ' if bounds else ''}{' '.join(bounds)}"


def _plain(number: float) -> str:
    """Return a bound; large whole ones are powers of two, or one less.

    Examples
    --------
    >>> _plain(2**31 - 1), _plain(2**63), _plain(1e8), _plain(0.25)
    ('2^31 - 1', '2^63', '1e8', '0.25')
    """
    if isinstance(number, int) and number >= 2**31 - 1:
        length = number.bit_length()
        return f"2^{length} - 1" if number == 2**length - 1 else f"2^{length - 1}"
    return f"{number:g}".replace("e+0", "e")

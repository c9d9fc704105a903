"""Where in a scenario a fault lies: the way through sections, kinds and keys."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel

Model = type[BaseModel]


@dataclass(frozen=True, kw_only=True)
class Way:
    """The way to a place in a scenario.

    Parameters
    ----------
    shown : sequence of str or int
        The steps as the user knows them.
    model : Model or None
        Whose key the last step is; None where the section itself is meant.
    choices : sequence of Model
        The kinds that a table may be: beside `model`, or at the place itself without one.
    """

    shown: Sequence[str | int]
    model: Model | None
    choices: Sequence[Model]


def models_in(annotation: Any) -> list[Model]:
    """Return the models that a value of a type may be, through lists, options and unions."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if get_origin(annotation) is Literal:
        return []
    return [model for inner in get_args(annotation) for model in models_in(inner)]


def words_of(model: Model, key: str) -> tuple[str, ...]:
    """Return the words that a key of a model, such as `kind`, may hold."""
    return get_args(model.model_fields[key].annotation) if key in model.model_fields else ()


def follow(address: Sequence[str | int], sections: Mapping[str, Any]) -> Way:
    """Return the way along an address, the words left out that only say which kind was tried."""
    shown: list[str | int] = [address[0]]
    choices = beside = models_in(sections[str(address[0])])
    model: Model | None = None
    owner = choices[0] if len(choices) == 1 else None
    for step in address[1:]:
        if isinstance(step, int):
            shown.append(step)
        elif owner is None:
            owner = next((m for m in choices if _is_kind(m, step)), None)
        else:
            shown.append(step)
            model, beside = owner, choices
            field = owner.model_fields.get(step)
            choices = models_in(field.annotation) if field else []
            owner = choices[0] if len(choices) == 1 else None
    return Way(shown=shown, model=model, choices=beside)


def _is_kind(model: Model, word: str) -> bool:
    return any(word in words_of(model, key) for key in ("kind", "type"))


def all_models(sections: Mapping[str, Any]) -> Iterator[tuple[str, Model]]:
    """Yield every model with its place, what lies deeper first."""
    for place, annotation in sections.items():
        models = models_in(annotation)
        fields = {
            f"{place}.{name}": field.annotation
            for model in models
            for name, field in model.model_fields.items()
            if models_in(field.annotation)
        }
        yield from all_models(fields)
        yield from ((place, model) for model in models)

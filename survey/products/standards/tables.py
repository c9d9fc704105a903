"""The data files of standards: every figure with its source."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib import resources
from typing import Any


def read_table(file: str) -> dict[str, Any]:
    """Return a data file of this package as plain tables."""
    text = (resources.files("survey.products.standards") / file).read_text(encoding="utf-8")
    return tomllib.loads(text)


def values_of(table: Mapping[str, Any]) -> dict[str, float]:
    """Return the bare figures of a table by their key.

    Raises
    ------
    ValueError
        When a figure has no source.

    Examples
    --------
    >>> values_of({"title": "Order 9", "coverage": {"value": 1.0, "source": "a text"}})
    {'coverage': 1.0}
    """
    figures = {key: figure for key, figure in table.items() if isinstance(figure, Mapping)}
    bare = [key for key, figure in figures.items() if not figure.get("source")]
    if bare:
        raise ValueError(f"standards: no source for {', '.join(bare)}")
    return {key: float(figure["value"]) for key, figure in figures.items()}

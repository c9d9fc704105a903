"""Devices by name: figures of detectors as they were published, or assumed and marked so."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

FILES = ("spads.toml", "apds.toml", "pmts.toml")


@dataclass(frozen=True, kw_only=True)
class Figure:
    """One figure of a device, in the unit that its key ends in.

    Parameters
    ----------
    value : float
    source : str
        Where it was published; begins with "assumed" where it was not.
    """

    value: float
    source: str


@dataclass(frozen=True, kw_only=True)
class Device:
    """One device of the catalogue.

    Parameters
    ----------
    title : str
        What it is.
    kind : str
        "spad", "apd" or "pmt".
    figures : Mapping
        Figures by the key of the scenario's section [detector].
    """

    title: str
    kind: str
    figures: Mapping[str, Figure]


@cache
def devices() -> Mapping[str, Device]:
    """Return the catalogue by name.

    Examples
    --------
    >>> device = devices()["linospad2"]
    >>> device.kind, device.figures["crosstalk_probability"].value
    ('spad', 0.0022)
    """
    return {
        name: Device(
            title=table.pop("title"),
            kind=table.pop("kind"),
            figures={key: Figure(**figure) for key, figure in table.items()},
        )
        for file in FILES
        for name, table in _tables(file).items()
    }


def _tables(file: str) -> dict[str, dict[str, Any]]:
    source = resources.files("survey.sensor") / "data" / file
    return tomllib.loads(source.read_text(encoding="utf-8"))

"""A seabed below the gate is told before the flight."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.scenario.gate_notes import gate_notes
from survey.scenario.scenario import Scenario


def make(tables: dict[str, Any], **keys: Any) -> Scenario:
    return Scenario.from_tables(tables, name="reef.toml", folder=Path()).replace(**keys)


@pytest.mark.parametrize(("depth", "noted"), [(29.7, False), (29.8, True), (90.0, True)])
def test_a_plane_below_the_gate_is_noted(tables: dict[str, Any], depth: float, noted: bool) -> None:
    """300 ns from 30 ns before the surface: 270 ns of water are 29.76 m at n = 1.36."""
    assert len(list(gate_notes(make(tables, **{"seabed.depth_m": depth})))) == noted


def test_the_bins_that_it_names_are_just_enough(tables: dict[str, Any]) -> None:
    deep = {"seabed.depth_m": 90.0}
    (note,) = gate_notes(make(tables, **deep))
    bins = int(note.split("receiver.bins = ")[1].split()[0])
    assert not list(gate_notes(make(tables, **deep, **{"receiver.bins": bins})))
    assert list(gate_notes(make(tables, **deep, **{"receiver.bins": bins - 1})))


def test_check_tells_it() -> None:
    result = CliRunner().invoke(app, ["check", "too-deep"])
    assert result.exit_code == 0
    assert "no bottom echo can come" in result.output

"""Work carried elsewhere: prepared once, and for no other run."""

from __future__ import annotations

import json
import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from survey import far_work
from survey.errors import OtherRunError
from survey.far_work import FarWork
from survey.scenario.scenario import Scenario


def content(mission: Any, index: int) -> bytes:
    """Stand for a frame's file."""
    return f"{mission} {index}".encode()


@pytest.fixture
def prepared(monkeypatch: pytest.MonkeyPatch) -> list[Scenario]:
    """Return the scenarios that are prepared from now on, none of them in earnest."""
    seen = list[Scenario]()

    def prepare(scenario: Scenario) -> str:
        seen.append(scenario)
        return scenario.mission.title

    monkeypatch.setattr(far_work, "prepare", prepare)
    far_work._prepared.cache_clear()
    return seen


@pytest.fixture
def scenario(tables: dict[str, Any], tmp_path: Path) -> Scenario:
    return Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)


def test_a_process_prepares_a_mission_once_for_all_its_threads(
    scenario: Scenario, prepared: list[Scenario]
) -> None:
    sent = pickle.dumps(FarWork.of(scenario, content))
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda index: pickle.loads(sent)(index), range(8)))
    assert found == [f"a test {index}".encode() for index in range(8)]
    assert len(prepared) == 1
    FarWork.of(scenario.replace(**{"mission.seed": 2}), content)(0)
    assert [seen.mission.seed for seen in prepared] == [1, 2]


def test_what_is_sent_is_small(scenario: Scenario) -> None:
    assert len(pickle.dumps(FarWork.of(scenario, content))) < 20_000


@pytest.mark.parametrize(
    ("part", "words"),
    [("code_sha256", "code"), ("lock_sha256", "lock of the libraries"), ("versions", "versions")],
)
def test_a_worker_with_something_else_refuses(
    scenario: Scenario, prepared: list[Scenario], part: str, words: str
) -> None:
    work = FarWork.of(scenario, content)
    there = replace(work, manifest=json.dumps(json.loads(work.manifest) | {part: "other"}))
    with pytest.raises(OtherRunError, match=f"worker on .*: other .*{words}. Install there"):
        there(0)
    assert prepared == []


def test_files_are_looked_for_at_the_same_place(
    tables: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    scenario = Scenario.from_tables(tables, name="reef.toml", folder=Path())
    assert FarWork.of(scenario, content).scenario.folder == tmp_path

"""Sound files damaged by chance: refused with a message, or accepted with a meaning."""

from __future__ import annotations

import zlib
from pathlib import Path

import pytest

from tests.bad_input.door import Answer, Door
from tests.bad_input.good_files import GOOD_FILES
from tests.bad_input.meaning import MEANS
from tests.bad_input.mutations import mutant

FEW, MANY = 10, 100
"""Mutants of each kind in the fast suite and in the slow one."""


def test_there_are_mutants_by_the_hundred() -> None:
    assert FEW * len(GOOD_FILES) >= 200
    assert MANY * len(GOOD_FILES) >= 2000


@pytest.mark.parametrize("kind", GOOD_FILES)
def test_mutants(kind: str, door: Door, scored: Path) -> None:
    assert damaged(kind, range(FEW), door, scored) == []


@pytest.mark.slow
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("kind", GOOD_FILES)
def test_many_mutants(kind: str, door: Door, scored: Path) -> None:
    assert damaged(kind, range(FEW, FEW + MANY), door, scored) == []


def damaged(kind: str, numbers: range, door: Door, scored: Path) -> list[str]:
    """Return what is not as it must be with mutants of a kind."""
    content, file = GOOD_FILES[kind].make(), GOOD_FILES[kind].file
    faults = []
    for number in numbers:
        name, changed = mutant(content, seed=(zlib.crc32(kind.encode()), number))
        folder = door.folder()
        (folder / file).write_bytes(changed)
        answer = asked(kind, folder, door, scored)
        found = answer.faults(file, "scene.toml") + left_behind(folder, answer)
        faults += [f"{folder / file}: {name}: {fault}" for fault in found]
    return faults


def asked(kind: str, folder: Path, door: Door, scored: Path) -> Answer:
    """Ask the program about a file; a cloud is scored, and the score written."""
    file, scene = folder / GOOD_FILES[kind].file, folder / "scene.toml"
    if kind.startswith("cloud"):
        score = folder / "score.json"
        return door.ask("score", file, "--run", scored, "--json", score, means="score", path=score)
    if kind == "scenario":
        scene = file
    else:
        scene.write_text(GOOD_FILES[kind].scenario(file.name), encoding="utf-8")
    return door.ask("check", scene, means=MEANS[kind], path=scene)


def left_behind(folder: Path, answer: Answer) -> list[str]:
    """Return the products that a refusal leaves half done."""
    known = {*(good.file for good in GOOD_FILES.values()), "scene.toml"}
    names = {path.name for path in folder.iterdir()} - known
    return [f"leaves {', '.join(sorted(names))} behind"] if answer.status and names else []

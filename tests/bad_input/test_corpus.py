"""Broken files of every kind: each gets its message, soon and in little memory."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.bad_input.cases import Case, cases
from tests.bad_input.door import LONGEST_SECONDS, MOST_BYTES, Answer, Door
from tests.bad_input.good_files import GOOD_FILES
from tests.bad_input.meaning import MEANS

CASES = list(cases())
MOST_LINES = 40
STARTING_SECONDS = 5.0  # two interpreters with their libraries, on a slow machine


def test_the_corpus_is_large_and_has_every_kind() -> None:
    assert len(CASES) >= 200
    assert len({(case.kind, case.name) for case in CASES}) == len(CASES)
    assert min(Counter(case.kind for case in CASES)[kind] for kind in GOOD_FILES) >= 3


@pytest.mark.parametrize("kind", GOOD_FILES)
def test_the_sound_files_are_sound(kind: str, door: Door, scored: Path) -> None:
    answer = asked(door, Case(kind=kind, name="sound", recipe={}), scored)
    assert (answer.status, answer.faults()) == (0, []), answer.err


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.kind}: {case.name}")
def test_a_broken_file_gets_its_message(case: Case, door: Door, scored: Path) -> None:
    answer = asked(door, case, scored)
    assert answer.faults(case.file, "scene.toml") == []
    assert answer.status == case.status, answer.out + answer.err
    assert case.says
    for words in case.says:
        assert words in answer.err
    assert len(answer.lines) <= MOST_LINES
    assert all(len(line) < 1000 and line.isprintable() for line in answer.lines)


def test_a_broken_table_is_refused_by_response_too(door: Door) -> None:
    for case in CASES:
        if case.kind == "phase" and "used_by" not in case.recipe:
            file = door.folder() / case.file
            file.write_bytes(case.content())
            answer = door.ask(*("response", "--a", "0.1", "--b", "0.3"), "--phase-function", file)
            assert (answer.status, answer.faults(case.file)) == (2, []), case.name
            assert all(words in answer.err for words in case.says), case.name


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES[::5], ids=lambda case: f"{case.kind}: {case.name}")
def test_a_program_of_its_own_says_the_same(case: Case, tmp_path: Path, scored: Path) -> None:
    """Not in the warm process but as users start it, with readers in fresh interpreters."""
    (tmp_path / case.file).write_bytes(case.content())
    words = ["check", case.file]
    if case.kind.startswith("cloud"):
        words = ["score", case.file, "--run", str(scored)]
    elif case.kind != "scenario":
        (tmp_path / "scene.toml").write_text(case.scenario(), encoding="utf-8")
        words = ["check", "scene.toml"]
    program = subprocess.Popen(
        [sys.executable, "-m", "survey.cli", *words],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])},
        stderr=subprocess.PIPE,
    )
    assert program.stderr is not None
    with program.stderr as told:
        said = told.read().decode()
    _, status, used = os.wait4(program.pid, 0)
    program.returncode = os.waitstatus_to_exitcode(status)
    assert program.returncode == case.status, said
    assert all(words in said for words in case.says)
    assert used.ru_utime + used.ru_stime < LONGEST_SECONDS + STARTING_SECONDS
    assert used.ru_maxrss * 1024 < MOST_BYTES


def asked(door: Door, case: Case, scored: Path) -> Answer:
    """Write a case's files and ask the program about them."""
    folder = door.folder()
    file, scene = folder / case.file, folder / "scene.toml"
    file.write_bytes(case.content())
    if case.kind.startswith("cloud"):
        return door.ask("score", file, "--run", scored)
    if case.kind == "scenario":
        scene = file
    else:
        scene.write_text(case.scenario(), encoding="utf-8")
    return door.ask("check", scene, means=MEANS[case.kind], path=scene)

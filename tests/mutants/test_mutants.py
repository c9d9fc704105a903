"""Thirty deliberate faults of the physics: the tests must notice at least 29 of them.

Each fault is put into a copy of the project, in which its tests run in a process of their own. It
is killed when an assertion fails; any other error says that the mutant is badly made. Two copies
are worked on side by side and restored in between, so that sound kernels are compiled but once.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

import pytest

from tests.mutants.witness import VERDICT

ROOT = Path(__file__).resolve().parents[2]
COPIED = ("survey", "terrain", "scenarios", "tests", "pyproject.toml")
SIDE_BY_SIDE, AT_LEAST, IN_ALL = 2, 29, 30
LONGEST_RUN = 300.0


@dataclass(frozen=True, kw_only=True)
class Mutant:
    """One fault: ``new`` in the stead of ``old`` in ``file``, and the tests that notice it."""

    name: str
    breaks: str
    file: str
    old: str
    new: str
    killed_by: list[str]


MUTANTS = [
    Mutant(**table)
    for table in tomllib.loads((Path(__file__).parent / "mutants.toml").read_text("utf-8"))[
        "mutant"
    ]
]


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_the_list_fits_the_sources(mutant: Mutant) -> None:
    assert (ROOT / mutant.file).read_text("utf-8").count(mutant.old) == 1, "rewrite this mutant"
    for node in mutant.killed_by:
        path, _, name = node.partition("::")
        assert f"def {name}(" in (ROOT / path).read_text("utf-8"), f"there is no {node}"


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_the_tests_kill_the_mutants(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """At least 29 of 30, and the same tests pass without any fault."""
    assert len(MUTANTS) == len({mutant.name for mutant in MUTANTS}) == IN_ALL
    copies: Queue[Path] = Queue()
    for number in range(SIDE_BY_SIDE):
        copies.put(copy_project(tmp_path / f"copy-{number}"))
    nodes = sorted({node for mutant in MUTANTS for node in mutant.killed_by})

    def judged(mutant: Mutant | None) -> list[str]:
        copy = copies.get()
        try:
            with applied(mutant, copy) if mutant else nullcontext():
                tests = mutant.killed_by if mutant else nodes
                return failures(copy, tests, cache=tmp_path / "cache")
        finally:
            copies.put(copy)

    with ThreadPoolExecutor(SIDE_BY_SIDE) as pool:
        sound, *verdicts = pool.map(judged, [None, *MUTANTS])
    assert sound == []
    killed = sum(map(bool, verdicts))
    with capsys.disabled():
        print(f"\n{killed} of {len(MUTANTS)} mutants killed")
        for mutant, failed in zip(MUTANTS, verdicts, strict=True):
            print(f"{mutant.name:31}  {failed[0] if failed else 'LIVES'}")
    assert killed >= AT_LEAST


def copy_project(target: Path) -> Path:
    """Copy what the tests need, times of the files kept."""
    ignored = shutil.ignore_patterns("__pycache__")
    target.mkdir()
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, target / name, ignore=ignored)
        else:
            shutil.copy2(ROOT / name, target / name)
    return target


@contextmanager
def applied(mutant: Mutant, copy: Path) -> Iterator[None]:
    """Put the fault into a copy, and afterwards the file as it was."""
    path = copy / mutant.file
    sound, stamp = path.read_text("utf-8"), path.stat()
    assert sound.count(mutant.old) == 1, mutant.name
    path.write_text(sound.replace(mutant.old, mutant.new), "utf-8")
    try:
        yield
    finally:
        path.write_text(sound, "utf-8")
        os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))


def failures(copy: Path, nodes: list[str], *, cache: Path) -> list[str]:
    """Run tests in a copy up to the first failure; return the assertions that failed."""
    run = subprocess.run(
        [
            *(sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"),
            *("-p", "tests.mutants.witness", *nodes),
        ],
        cwd=copy,
        env=os.environ
        | {
            "PYTHONPATH": str(copy),
            "PYTHONDONTWRITEBYTECODE": "1",
            "XDG_CACHE_HOME": str(cache),
        },
        capture_output=True,
        text=True,
        timeout=LONGEST_RUN,
        check=False,
    )
    assert run.returncode in (0, 1), run.stdout + run.stderr
    verdict = json.loads((copy / VERDICT).read_text("utf-8"))
    (copy / VERDICT).unlink()
    assert verdict["foreign"] == [], "modules from elsewhere were tested"
    assert verdict["broken"] == [], "failed, but not by an assertion"
    return list(verdict["asserted"])

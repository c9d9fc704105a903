"""A run stopped anywhere goes on to the same bytes."""

from __future__ import annotations

import os
import random
import signal
import time
from pathlib import Path

import pytest

from survey.crew.processes import Processes
from tests.faults.rehearsal import Rehearsal, Seam, kill

KILLS, FEW_KILLS = 100, 2
SOME = (1, 19, 43, 85, 126)


def moments(rehearsal: Rehearsal, folder: Path) -> int:
    """Return how many moments a whole run has."""
    seam = Seam(-1, kill)
    seam.install()
    try:
        rehearsal.fly(folder)
    finally:
        seam.remove()
    return seam.moments


def stopped_at(rehearsal: Rehearsal, folder: Path, moment: int) -> None:
    """Stop a run at a moment, and go on with it."""
    ended = rehearsal.ended(folder, trouble=Seam(moment, kill).install)
    assert ended == -signal.SIGKILL
    rehearsal.must_be_whole(folder)
    rehearsal.must_finish_alike(folder)


def test_a_run_stopped_at_some_writes_goes_on(rehearsal: Rehearsal, tmp_path: Path) -> None:
    """Half-way through manifest and first frame, in a later one, in the products."""
    for moment in SOME:
        stopped_at(rehearsal, tmp_path / f"at{moment}", moment)


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_a_run_stopped_before_and_after_every_write_fsync_and_rename_goes_on(
    rehearsal: Rehearsal, tmp_path: Path
) -> None:
    count = moments(rehearsal, tmp_path / "whole")
    assert count > 100
    for moment in range(count):
        stopped_at(rehearsal, tmp_path / f"at{moment}", moment)


def test_a_run_stopped_at_every_resume_ends_alike(rehearsal: Rehearsal, tmp_path: Path) -> None:
    """One step further each time: no stop is lost to the next."""
    for moment in (11, 23, 38):
        assert rehearsal.ended(tmp_path / "run", trouble=Seam(moment, kill).install) < 0
    rehearsal.must_finish_alike(tmp_path / "run")


def killed_at_random(rehearsal: Rehearsal, folder: Path, kills: int) -> None:
    """Kill pilots of two processes at random moments, each time going on at once."""
    chance, crew = random.Random(7), Processes(workers=2)
    start = time.monotonic()
    rehearsal.fly(folder / "whole", crew)
    lasts, hits = time.monotonic() - start, 0
    for number in range(kills):
        run = folder / f"run{number}"
        child = rehearsal.start(run, crew, trouble=lambda: None)
        time.sleep(chance.uniform(0.0, lasts))
        os.kill(child, signal.SIGKILL)
        hits += os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL
        rehearsal.must_be_whole(run)
        rehearsal.must_finish_alike(run)
    assert hits > kills // 2


def test_a_run_killed_at_random_ends_alike(rehearsal: Rehearsal, tmp_path: Path) -> None:
    killed_at_random(rehearsal, tmp_path, FEW_KILLS)


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_a_hundred_runs_killed_at_random_end_alike(rehearsal: Rehearsal, tmp_path: Path) -> None:
    killed_at_random(rehearsal, tmp_path, KILLS)

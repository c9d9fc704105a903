"""Crews: every frame once, whatever becomes of a worker; frames that fail are set aside."""

from __future__ import annotations

import faulthandler
import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from survey.crew.hire import cluster_of, cores, local_crew
from survey.crew.outcome import Crew, Done, Failed
from survey.crew.patience import patiently
from survey.crew.processes import Processes
from survey.crew.threads import Threads
from survey.errors import OtherRunError, UserError

CREWS = [Threads(workers=1), Threads(workers=3), Processes(workers=1), Processes(workers=3)]


def square(index: int) -> int:
    return index**2


def die(end: signal.Signals | None) -> None:
    """End this process by a signal, or without one with status 3."""
    faulthandler.disable()
    if end is None:
        os._exit(3)
    os.kill(os.getpid(), end)


@pytest.mark.parametrize("crew", CREWS, ids=lambda crew: crew.described)
def test_every_frame_comes_back_once(crew: Crew) -> None:
    found = [outcome for outcome in crew.fly(square, range(40)) if isinstance(outcome, Done)]
    assert {done.index: done.result for done in found} == {i: i**2 for i in range(40)}
    assert len(found) == 40
    assert list(crew.fly(square, ())) == []


@pytest.mark.parametrize("crew", CREWS, ids=lambda crew: crew.described)
def test_a_frame_that_fails_takes_no_other_with_it(crew: Crew) -> None:
    def work(index: int) -> int:
        if index == 7:
            raise ArithmeticError("not finite")
        return index

    outcomes = list(crew.fly(work, range(20)))
    (failed,) = [outcome for outcome in outcomes if isinstance(outcome, Failed)]
    assert failed.index == 7
    assert failed.reason.startswith("ArithmeticError: not finite (test_crew.py:")
    assert sorted(outcome.index for outcome in outcomes) == list(range(20))


@pytest.mark.parametrize("crew", CREWS, ids=lambda crew: crew.described)
def test_what_the_user_must_mend_ends_it_all(crew: Crew) -> None:
    def work(index: int) -> int:
        raise OtherRunError("other code")

    with pytest.raises(OtherRunError, match="other code"):
        list(crew.fly(work, range(9)))


@pytest.mark.parametrize(
    ("end", "reason"),
    [(signal.SIGSEGV, "SIGSEGV"), (signal.SIGKILL, "SIGKILL"), (None, "status 3")],
)
def test_a_worker_that_dies_fails_in_its_frame_alone(
    end: signal.Signals | None, reason: str
) -> None:
    def work(index: int) -> int:
        if index in (3, 4):
            die(end)
        return index

    outcomes = list(Processes(workers=2).fly(work, range(12)))
    assert sorted(outcome.index for outcome in outcomes) == list(range(12))
    failed = {outcome.index: outcome.reason for outcome in outcomes if isinstance(outcome, Failed)}
    assert set(failed) == {3, 4}
    assert all(words.endswith(reason) for words in failed.values())


def test_a_fault_that_passes_is_forgotten(tmp_path: Path) -> None:
    def work(index: int) -> int:
        mark = tmp_path / str(index)
        if index == 2 and not mark.exists():
            mark.touch()
            die(signal.SIGKILL)
        return index

    outcomes = list(patiently(Processes(workers=2), work, range(5)))
    assert sorted(outcome.index for outcome in outcomes if isinstance(outcome, Done)) == [*range(5)]


def test_a_frame_is_tried_three_times_the_last_two_alone(tmp_path: Path) -> None:
    def work(index: int) -> int:
        with (tmp_path / "tries").open("a") as tries:
            tries.write(f"{index}")
        if index in (1, 3):
            die(signal.SIGSEGV)
        return index

    outcomes = list(patiently(Processes(workers=1), work, range(5)))
    assert (tmp_path / "tries").read_text() == "01234" + "11" + "33"
    assert [o.index for o in outcomes if isinstance(o, Failed)] == [1, 3]


def test_forked_workers_see_what_is_prepared_without_a_copy() -> None:
    terrain = np.zeros(200_000_000 // 8)
    terrain[:] = 1.0

    def private_bytes(index: int) -> int:
        before = _private()
        assert terrain[:: 4096 // 8].sum() > 0.0
        return _private() - before

    for outcome in Processes(workers=2).fly(private_bytes, range(2)):
        assert isinstance(outcome, Done)
        assert outcome.result < 20_000_000


def _private() -> int:
    """Return this process's memory that it shares with nobody [bytes]."""
    lines = Path("/proc/self/smaps_rollup").read_text().splitlines()
    return sum(1024 * int(line.split()[1]) for line in lines if line.startswith("Private_Dirty"))


@pytest.mark.parametrize("crew", CREWS, ids=lambda crew: crew.described)
def test_a_pilot_that_stops_leaves_no_worker(crew: Crew) -> None:
    def work(index: int) -> int:
        time.sleep(0.01)
        return os.getpid()

    threads = threading.active_count()
    outcomes = crew.fly(work, range(1000))
    first = next(outcomes)
    assert isinstance(outcomes, Iterator)
    outcomes.close()  # type: ignore[attr-defined]
    assert isinstance(first, Done)
    if first.result != os.getpid():
        with pytest.raises(ProcessLookupError):
            os.kill(first.result, 0)
    assert threading.active_count() == threads


def test_few_frames_are_ahead_of_the_pilot(tmp_path: Path) -> None:
    """So that results do not pile up in memory while the pilot writes."""

    def work(index: int) -> int:
        (tmp_path / str(index)).touch()
        return index

    for crew in CREWS:
        for file in tmp_path.iterdir():
            file.unlink()
        outcomes = crew.fly(work, range(1000))
        next(outcomes)
        time.sleep(0.1)
        assert len(list(tmp_path.iterdir())) <= 6
        outcomes.close()  # type: ignore[attr-defined]


def test_cores_are_those_that_a_batch_system_gave(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {4, 5, 6})
    assert cores() == 3
    assert local_crew(0, "threads").described == "3 threads"


def test_the_environment_names_a_cluster_unless_workers_are_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("DASK_SCHEDULER_ADDRESS", "tcp://there:8786")
    assert cluster_of(None, workers=None, kind=None) == "tcp://there:8786"
    assert cluster_of("tcp://here:8786", workers=None, kind=None) == "tcp://here:8786"
    assert cluster_of(None, workers=2, kind=None) is None
    assert cluster_of(None, workers=None, kind="threads") is None
    with pytest.raises(UserError, match="Leave out --workers"):
        cluster_of("tcp://here:8786", workers=2, kind=None)

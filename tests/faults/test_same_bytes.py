"""The products of a mission are the same bytes, whoever flew it and in whatever order."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Timer
from typing import Any, ClassVar

import pytest

from survey.crew.cluster import ClusterError, connected
from survey.crew.outcome import Crew, Outcome, Result, Work
from survey.crew.patience import patiently
from survey.crew.processes import Processes
from survey.crew.threads import Threads
from tests.faults.rehearsal import Rehearsal, products

LOCAL = [kind(workers=workers) for kind in (Threads, Processes) for workers in (1, 2, 3)]
IN_HASTE = {"3 threads", "2 processes", "3 processes shuffled"}


@dataclass(frozen=True)
class Shuffled:
    """Another crew, to which the frames are given in another order."""

    crew: Crew
    shares_memory: ClassVar[bool] = True

    @property
    def described(self) -> str:
        """Who that is."""
        return f"{self.crew.described} shuffled"

    def fly(self, work: Work[Result], frames: Iterable[int]) -> Iterator[Outcome[Result]]:
        """Shuffle, and let the other fly."""
        return self.crew.fly(work, random.Random(5).sample(list(frames), len(list(frames))))


def local_crews() -> list[Any]:
    """Return nine, most of them for the slow tests; a cluster of one, two, three makes twelve."""
    crews = [*LOCAL, *(Shuffled(crew) for crew in LOCAL[1::2])]
    marks = {True: (), False: pytest.mark.slow}
    return [
        pytest.param(crew, id=crew.described, marks=marks[crew.described in IN_HASTE])
        for crew in crews
    ]


@pytest.mark.parametrize("crew", local_crews())
def test_the_products_do_not_depend_on_the_crew(
    rehearsal: Rehearsal, tmp_path: Path, crew: Crew
) -> None:
    rehearsal.fly(tmp_path / "run", crew)
    assert products(tmp_path / "run") == rehearsal.wanted


def dask(*arguments: str) -> subprocess.Popen[bytes]:
    """Start a part of a cluster on this machine."""
    command = [sys.executable, "-m", "dask", *arguments]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@contextmanager
def cluster(folder: Path, *, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Give the scheduler file of a real cluster on loopback, its scheduler and its workers."""
    file = folder / "scheduler.json"
    here = ("--host", "127.0.0.1")
    with ExitStack() as stack:

        def start(*arguments: str) -> subprocess.Popen[bytes]:
            process = stack.enter_context(dask(*arguments))
            stack.callback(process.kill)
            return process

        own = ("--port", "0", "--no-dashboard", "--scheduler-file", str(file))
        scheduler = start("scheduler", *here, *own)
        team = ("worker", *here, "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny")
        wait_for(file)
        yield str(file), [scheduler, *(start(*team, "--no-dashboard") for _ in range(workers))]


def wait_for(file: Path) -> None:
    """Wait until a file is there."""
    while not file.exists():
        time.sleep(0.05)


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("workers", [1, 2, 3])
def test_a_cluster_makes_the_same_products(
    rehearsal: Rehearsal, tmp_path: Path, workers: int
) -> None:
    pytest.importorskip("distributed")
    with cluster(tmp_path, workers=workers) as (file, _), connected(file) as crew:
        crew.client.wait_for_workers(workers)
        rehearsal.fly(tmp_path / "run", crew)
    assert products(tmp_path / "run") == rehearsal.wanted


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_a_cluster_that_loses_a_worker_makes_the_same_products(
    rehearsal: Rehearsal, tmp_path: Path
) -> None:
    """The worker is killed when the first frames are there, in the middle of another."""
    pytest.importorskip("distributed")
    with cluster(tmp_path, workers=2) as (file, (_, victim, _)), connected(file) as crew:
        crew.client.wait_for_workers(2)
        rehearsal.fly(tmp_path / "run", Killing(crew, victim))
        assert victim.wait(10.0) == -signal.SIGKILL
        assert len(crew.client.nthreads()) == 1
    assert products(tmp_path / "run") == rehearsal.wanted


@pytest.mark.slow
def test_a_cluster_that_loses_its_scheduler_ends_a_run_with_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("survey.crew.cluster.PATIENCE", "5s")
    with cluster(tmp_path, workers=0) as (file, (scheduler,)), connected(file) as crew:
        Timer(1.0, scheduler.kill).start()
        with pytest.raises(ClusterError, match=r"is gone\. The same command goes on"):
            list(patiently(crew, abs, range(9)))


@dataclass(frozen=True)
class Killing:
    """A cluster of which one worker is killed when the first frame is there."""

    crew: Crew
    victim: subprocess.Popen[bytes]
    shares_memory: ClassVar[bool] = False

    @property
    def described(self) -> str:
        """Who that is."""
        return self.crew.described

    def fly(self, work: Work[Result], frames: Iterable[int]) -> Iterator[Outcome[Result]]:
        """Let the others fly, and kill."""
        with closing(self.crew.fly(work, frames)) as outcomes:  # type: ignore[type-var]
            for outcome in outcomes:
                self.victim.kill()
                yield outcome


def test_a_place_without_a_scheduler_is_an_error_that_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("survey.crew.cluster.PATIENCE", "1s")
    with (
        pytest.raises(ClusterError, match=r"127.0.0.1:9: no dask scheduler answers"),
        connected("tcp://127.0.0.1:9"),
    ):
        pass
    with (
        pytest.raises(FileNotFoundError, match=r"no scheduler file. `dask scheduler"),
        connected(str(tmp_path / "scheduler.json")),
    ):
        pass

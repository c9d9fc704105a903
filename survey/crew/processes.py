"""Frames flown by processes of this machine, forked, so that they share what is prepared."""

from __future__ import annotations

import signal
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, ClassVar

from survey.crew.outcome import Failed, Outcome, Result, Work, attempt
from survey.errors import UserError

FORK = get_context("fork")
AHEAD = 2
PATIENCE = 10.0  # [s]


@dataclass(frozen=True, kw_only=True)
class Processes:
    """Forked processes see this one's memory without a copy; if one crashes, its frame has failed.

    Another process then takes the place of the one that crashed.
    """

    workers: int
    shares_memory: ClassVar[bool] = True

    @property
    def described(self) -> str:
        """Who that is, in words for the user."""
        return f"{self.workers} processes"

    def fly(self, work: Work[Result], frames: Iterable[int]) -> Iterator[Outcome[Result]]:
        """Yield what comes of every frame, in any order.

        Examples
        --------
        >>> crew = Processes(workers=2)
        >>> sorted(done.result for done in crew.fly(lambda index: index**2, range(4)))
        [0, 1, 4, 9]
        """
        left = deque(frames)
        team: dict[Connection, _Worker] = {}
        try:
            while True:
                while left and len(team) < self.workers:
                    worker = _Worker.forked(work, known=team)
                    team[worker.ours] = worker
                    worker.give(left.popleft())
                for worker in team.values():
                    while left and len(worker.frames) < AHEAD:
                        worker.give(left.popleft())
                busy = [end for end, worker in team.items() if worker.frames]
                if not busy:
                    return
                for end in wait(busy):
                    worker = team[end]  # type: ignore[index]
                    yield worker.outcome()
                    if worker.is_lost:
                        del team[worker.ours]
                        left.extendleft(reversed(worker.frames))
        finally:
            for worker in team.values():
                worker.dismiss()


@dataclass(kw_only=True)
class _Worker:
    """A forked process, our end of the pipe to it, and the frames that it was given, in order."""

    process: BaseProcess
    ours: Connection
    frames: deque[int] = field(default_factory=deque)
    is_lost: bool = False

    @classmethod
    def forked(cls, work: Work[Any], *, known: Iterable[Connection]) -> _Worker:
        """Start a process; it closes the ends that it inherits and that are not its own."""
        ours, theirs = FORK.Pipe()
        process = FORK.Process(
            target=_serve, args=(work, theirs, (ours, *known)), name="bathyflash worker"
        )
        process.start()
        theirs.close()
        return cls(process=process, ours=ours)

    def give(self, index: int) -> None:
        """Hand it a frame; that it is gone shows when its outcome is asked for."""
        self.frames.append(index)
        try:
            self.ours.send(index)
        except OSError:
            return

    def outcome(self) -> Outcome[Any]:
        """Return what came of its first frame; a process that died has failed in it."""
        try:
            sent: Outcome[Any] | UserError = self.ours.recv()
        except (EOFError, OSError):
            self.is_lost = True
            self.dismiss()
            return Failed(index=self.frames.popleft(), reason=_death(self.process.exitcode))
        if isinstance(sent, UserError):
            raise sent
        self.frames.popleft()
        return sent

    def dismiss(self) -> None:
        """End it, whatever it does."""
        self.ours.close()
        self.process.terminate()
        self.process.join(PATIENCE)
        if self.process.exitcode is None:
            self.process.kill()
            self.process.join()


def _serve(work: Work[Any], theirs: Connection, others: Iterable[Connection]) -> None:
    """Fly what comes through the pipe until it is closed; keys are the pilot's to heed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    for end in others:
        end.close()
    try:
        while True:
            theirs.send(_attempted(work, theirs.recv()))
    except (EOFError, OSError):
        return


def _attempted(work: Work[Any], index: int) -> Outcome[Any] | UserError:
    try:
        return attempt(work, index)
    except UserError as error:
        return error


def _death(status: int | None) -> str:
    """Return how a process ended, in words.

    Examples
    --------
    >>> _death(-11)
    'its worker was ended by SIGSEGV'
    >>> _death(3)
    'its worker ended with status 3'
    """
    if status is not None and status < 0:
        return f"its worker was ended by {signal.Signals(-status).name}"
    return f"its worker ended with status {status}"

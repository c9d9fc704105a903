"""A small mission that can be stopped, starved or killed anywhere, and then flown to its end."""

from __future__ import annotations

import errno
import os
import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import laspy

from survey import mission as flights
from survey.crew.outcome import Crew
from survey.crew.threads import Threads
from survey.exit_status import explain
from survey.preparation import Mission
from survey.scenario.scenario import Scenario
from tests.small_scenario import SLOPE, small_tables

TABLES = small_tables(
    **{
        "flight.frames_per_line": 4,
        "flight.speed_m_s": 20.0,
        "camera": {"rows": 6, "columns": 8},
        "seabed": SLOPE,
        "transport.walks_per_pixel": 16,
        "processing.correct_scattering": False,
    }
)
DIFFERS_BY_RUN = {"performance.json", "journal.jsonl", "log.txt"}
ONE = Threads(workers=1)


def products(folder: Path) -> dict[str, bytes]:
    """Return every file of a run but those that tell of times."""
    files = (path for path in folder.rglob("*") if path.is_file())
    found = {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}
    return {name: content for name, content in found.items() if name not in DIFFERS_BY_RUN}


def is_named(name: str) -> bool:
    """Tell files that have their name from those that are still written."""
    return not name.rsplit("/", 1)[-1].startswith(".")


@dataclass(frozen=True, kw_only=True)
class Rehearsal:
    """A mission, prepared once, and the products that it must lead to."""

    scenario: Scenario
    mission: Mission
    wanted: dict[str, bytes]

    def fly(self, folder: Path, crew: Crew = ONE) -> None:
        """Fly it, or go on with it, in this process."""
        flights.fly(self.scenario, folder, crew=crew)

    def start(self, folder: Path, crew: Crew = ONE, *, trouble: Callable[[], None]) -> int:
        """Fly it in a forked process that first gets into trouble; return the process's number.

        Its last words come into the file ``words`` beside the folder.
        """
        child = os.fork()
        if child:
            return child
        status, words = 0, ""
        pack_without_threads()
        try:
            trouble()
            self.fly(folder, crew)
        except BaseException as error:
            status, words = explain(error)
        _without_limits(lambda: folder.with_name("words").write_text(words))
        os._exit(status)

    def ended(self, folder: Path, crew: Crew = ONE, *, trouble: Callable[[], None]) -> int:
        """Return how such a process ended: its status, or minus the signal."""
        child = self.start(folder, crew, trouble=trouble)
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])

    def must_be_whole(self, folder: Path) -> None:
        """See that every file a first flight left, however it ended, is whole under its name."""
        found = {name: content for name, content in products(folder).items() if is_named(name)}
        assert [name for name in found if found[name] != self.wanted[name]] == []

    def must_finish_alike(self, folder: Path) -> None:
        """Go on with a flight that was stopped, and compare all products."""
        self.fly(folder)
        found = products(folder)
        assert sorted(found) == sorted(self.wanted)
        assert [name for name in found if found[name] != self.wanted[name]] == []


def pack_without_threads() -> None:
    """Let LAZ files be packed by one thread: lazrs waits for its pool, which no fork takes along.

    The bytes are the same; a run of its own forks only workers, and these pack nothing.
    """
    cast(Any, laspy.LazBackend).detect_available = classmethod(lambda cls: (cls.Lazrs,))


def _without_limits(write: Callable[[], object]) -> None:
    """Write although this process may be starved of files or of space: that is the trouble."""
    import resource

    for limit in (resource.RLIMIT_NOFILE, resource.RLIMIT_FSIZE, resource.RLIMIT_AS):
        hard = resource.getrlimit(limit)[1]
        resource.setrlimit(limit, (hard, hard))
    write()


class Seam:
    """Counts the moments before and after every write, fsync and rename, and acts at one of them.

    Whole files written at once are also stopped half-way. Files that libraries write end in an
    fsync, so that every state they leave behind is met before and after it.

    Parameters
    ----------
    at : int
        Which moment, from 0; -1 for none.
    act : callable
        Kills, or raises.
    again : bool
        Whether it acts at every moment from then on.
    """

    def __init__(self, at: int, act: Callable[[], None], *, again: bool = False) -> None:
        self.moments, self._at, self._act, self._again = 0, at, act, again
        self._plain = (os.fsync, Path.replace, Path.write_bytes)

    def install(self) -> None:
        """Take the place of the system's functions in this process."""
        fsync, replace, write = self._plain
        cast(Any, os).fsync = self._around(fsync)
        cast(Any, Path).replace = self._around(replace)
        cast(Any, Path).write_bytes = self._around(self._in_two_halves(write))

    def remove(self) -> None:
        """Give the functions back."""
        cast(Any, os).fsync, cast(Any, Path).replace, cast(Any, Path).write_bytes = self._plain

    def _around(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def counted(*arguments: Any) -> Any:
            self._moment()
            result = function(*arguments)
            self._moment()
            return result

        return counted

    def _in_two_halves(self, write: Callable[[Path, bytes], int]) -> Callable[[Path, bytes], int]:
        def torn(path: Path, content: bytes) -> int:
            write(path, content[: len(content) // 2])
            self._moment()
            return write(path, content)

        return torn

    def _moment(self) -> None:
        now, self.moments = self.moments, self.moments + 1
        if now == self._at or (self._again and now > self._at >= 0):
            self._act()


def kill() -> None:
    """End this process at once."""
    os.kill(os.getpid(), signal.SIGKILL)


def failing(number: int) -> Callable[[], None]:
    """Return what raises an error of the system, such as errno.ENOSPC."""

    def fail() -> None:
        raise OSError(number, os.strerror(number))

    return fail


DISK_FULL, DISK_BROKEN = failing(errno.ENOSPC), failing(errno.EIO)

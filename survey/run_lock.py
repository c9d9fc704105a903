"""One process at a time flies into a run folder."""

from __future__ import annotations

import fcntl
import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TextIO

from survey.errors import UserError

LOCK = ".lock"
HELD = set[TextIO]()
TRIES, BETWEEN_TRIES = 3, 0.05  # [s]


@dataclass(frozen=True, kw_only=True)
class Pilot:
    """The process that flies into a folder: its number and its machine."""

    process: int
    machine: str


class BusyRunError(UserError):
    """Another process flies into the run folder."""


@contextmanager
def sole_pilot(folder: Path) -> Iterator[None]:
    """Keep every other process out of a run folder; a killed process leaves nothing behind.

    The lock is the kernel's, on the file ``.lock``: it ends with the process that holds it.

    Raises
    ------
    BusyRunError
        At once, when another process holds it.
    """
    with (folder / LOCK).open("a+", encoding="utf-8") as file:
        if not _locked(file):
            raise _busy(folder, _named_in(folder))
        file.truncate(0)
        json.dump(asdict(Pilot(process=os.getpid(), machine=socket.gethostname())), file)
        file.flush()
        HELD.add(file)
        try:
            yield
        finally:
            HELD.discard(file)
        file.truncate(0)


def _let_go() -> None:
    """Let go of inherited locks: a worker that outlives its pilot must not keep the folder."""
    for file in HELD:
        file.close()
    HELD.clear()


os.register_at_fork(after_in_child=_let_go)


def pilot_of(folder: Path) -> Pilot | None:
    """Return who flies into a folder now; None when nobody does.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> with sole_pilot(folder):
    ...     flying = pilot_of(folder)
    >>> flying.process == os.getpid(), pilot_of(folder)
    (True, None)
    """
    if not (folder / LOCK).exists():
        return None
    with (folder / LOCK).open(encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return _named_in(folder) or Pilot(process=0, machine="")
    return None


def _locked(file: TextIO) -> bool:
    """Lock a file; a look by `pilot_of` may stand in the way for a moment."""
    for _ in range(TRIES):
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(BETWEEN_TRIES)
        else:
            return True
    return False


def _named_in(folder: Path) -> Pilot | None:
    try:
        return Pilot(**json.loads((folder / LOCK).read_text(encoding="utf-8")))
    except (ValueError, TypeError):
        return None


def require_free(folder: Path) -> None:
    """Raise `BusyRunError` when another process flies into a folder now."""
    pilot = pilot_of(folder)
    if pilot is not None:
        raise _busy(folder, pilot)


def _busy(folder: Path, pilot: Pilot | None) -> BusyRunError:
    known = pilot is not None and pilot.process
    words = f"process {pilot.process} on {pilot.machine}" if pilot and known else "another process"
    return BusyRunError(f"{folder}: {words} flies into this folder. Wait for it or choose another")

"""The user's door: the command line, with a watch on time and memory."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

LONGEST_SECONDS = 5.0
MOST_BYTES = 1 << 30
KNOWN = {0, 2, 3}
"""Exit status: done, bad input, file missing."""


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What the program says and what that cost.

    Parameters
    ----------
    status : int
        Exit status.
    out, err : str
    wrong : list of str
        What an accepted input cannot mean.
    processor_seconds : float
        Of the program with its readers; a clock would count what others do on the machine.
    bytes : int
        Largest resident memory of the program or a reader so far.
    """

    status: int
    out: str
    err: str
    wrong: list[str]
    processor_seconds: float
    bytes: int

    @property
    def lines(self) -> list[str]:
        """The lines of the message."""
        return self.err.splitlines()

    def faults(self, *files: str) -> list[str]:
        """Return what is not as it must be, whatever the input; a message names one of files."""
        faults = list(self.wrong)
        if self.status not in KNOWN or "Traceback" in self.err + self.out:
            faults.append(f"status {self.status}: {self.err[-500:]}")
        if self.processor_seconds > LONGEST_SECONDS:
            faults.append(f"{self.processor_seconds:.1f} s")
        if self.bytes > MOST_BYTES:
            faults.append(f"{self.bytes >> 20} MiB")
        if self.status and not (self.lines and all(any(f in s for f in files) for s in self.lines)):
            faults.append(f"does not name the file: {self.err[:500]!r}")
        if self.status and "sound" in self.out:
            faults.append(f"says both: {self.out[:500]!r}")
        return faults


class Door:
    """Ask the program about inputs in one warm process, see `tests.bad_input.nursery`."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._number = folder, 0
        self._nursery = self._started()

    def close(self) -> None:
        """End the process."""
        self._nursery.communicate()

    def folder(self) -> Path:
        """Return a new folder."""
        self._number += 1
        folder = self._folder / f"{self._number:05}"
        folder.mkdir()
        return folder

    def ask(self, *words: str | Path, means: str = "", path: Path = Path()) -> Answer:
        """Return the answer to a command; what is accepted must mean something (`meaning`)."""
        job = {"words": [str(word) for word in words], "means": means, "path": str(path)}
        assert self._nursery.stdin is not None
        assert self._nursery.stdout is not None
        print(json.dumps(job), file=self._nursery.stdin, flush=True)
        told = self._nursery.stdout.readline()
        if not told:
            ended = f"the process ended by {self._nursery.wait()}"
            self._nursery.communicate()
            self._nursery = self._started()
            return Answer(
                status=-1, out="", err=ended, wrong=[ended], processor_seconds=0.0, bytes=0
            )
        return Answer(**json.loads(told))

    def _started(self) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, "-m", "tests.bad_input.nursery"],
            cwd=Path(__file__).parents[2],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

"""What happened in a run folder, line by line, with the time: ``log.txt``."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path

from survey.products.writing import naming
from survey.progress import Watcher

LOG = "log.txt"


@contextmanager
def logged(folder: Path, watcher: Watcher) -> Iterator[Watcher]:
    """Give a watcher that writes a run folder's log, and note there what ends the block early."""
    log = Logged(folder, watcher)
    try:
        yield log
    except BaseException as error:
        log.failed(error)
        raise


class Logged:
    """A watcher that writes down what it is told and tells it on.

    Parameters
    ----------
    folder : Path
        Run folder; the log in it grows from run to run.
    watcher : Watcher
        Who else is told.
    """

    def __init__(self, folder: Path, watcher: Watcher) -> None:
        self._path, self._watcher = folder / LOG, watcher

    def started(self, total: int) -> None:
        """Note how many frames are to be flown."""
        self._write(f"{total} frames to fly")
        self._watcher.started(total)

    def noticed(self, text: str) -> None:
        """Note it."""
        self._write(text)
        self._watcher.noticed(text)

    def frame_done(self, index: int, seconds: float) -> None:
        """Note the frame and its time."""
        self._write(f"frame {index}: {seconds:.2f} s")
        self._watcher.frame_done(index, seconds)

    def writing(self, total: int) -> None:
        """Tell it on."""
        self._watcher.writing(total)

    def written(self, steps: int) -> None:
        """Tell it on."""
        self._watcher.written(steps)

    def finished(self, summary: str) -> None:
        """Note what came of it."""
        self._write(summary)
        self._watcher.finished(summary)

    def failed(self, error: BaseException) -> None:
        """Note what ended the run, if the disk still lets us."""
        with suppress(OSError):
            self._write(f"ended by {type(error).__name__}: {error}")

    def _write(self, text: str) -> None:
        now = datetime.now(UTC).isoformat(timespec="seconds")
        with naming(self._path), self._path.open("a", encoding="utf-8") as log:
            log.writelines(f"{now} {line}\n" for line in text.splitlines())

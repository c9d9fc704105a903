"""Progress of a mission as the user sees it: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

from survey.progress import Unwatched, Watcher

if TYPE_CHECKING:
    from rich.console import Console

SECONDS_BETWEEN_LINES = 5.0


@contextmanager
def watching(stream: TextIO, *, quiet: bool) -> Iterator[Watcher]:
    """Give nobody when quiet, a bar on a terminal, plain lines elsewhere."""
    if quiet:
        yield Unwatched()
    elif stream.isatty():
        from rich.console import Console

        bar = ProgressBar(Console(file=stream))
        try:
            yield bar
        finally:
            bar.close()
    else:
        yield PlainLines(stream)


class PlainLines:
    """Progress as lines of text: the first frame, the last, and one every few seconds between.

    Parameters
    ----------
    stream : TextIO
        Where the lines go.
    clock : callable
        Seconds on a clock that never goes back.
    """

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream, self._clock = stream, clock
        self._total = self._done = 0
        self._start = self._last_line = 0.0

    def started(self, total: int) -> None:
        """Say how many frames there are."""
        self._total, self._start = total, self._clock()
        self._say(f"{total} frames to fly")

    def noticed(self, text: str) -> None:
        """Say it."""
        self._say(text)

    def frame_done(self, index: int, seconds: float) -> None:
        """Say how far the mission is, not too often."""
        self._done += 1
        now = self._clock()
        due = now - self._last_line >= SECONDS_BETWEEN_LINES
        if due or self._done in (1, self._total):
            self._last_line = now
            self._say(progress_line(self._done, self._total, now - self._start))

    def finished(self, summary: str) -> None:
        """Say what came of it."""
        self._say(summary)

    def _say(self, line: str) -> None:
        print(line, file=self._stream, flush=True)


def progress_line(done: int, total: int, elapsed: float) -> str:
    """Return one line on how far a mission is.

    Examples
    --------
    >>> progress_line(8, 32, 16.0)
    '8/32 frames, 0.50 frames/s, 48 s left'
    """
    rate = done / elapsed if elapsed > 0.0 else float("inf")
    return f"{done}/{total} frames, {rate:.2f} frames/s, {(total - done) / rate:.0f} s left"


class ProgressBar:
    """Progress as a bar with rate and time left.

    Parameters
    ----------
    console : Console
        Where the bar is drawn.
    """

    def __init__(self, console: Console) -> None:
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeRemainingColumn,
        )

        self._console = console
        self._bar = Progress(
            TextColumn("flying"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            TextColumn("left"),
            console=self._console,
        )
        self._task = self._bar.add_task("flying", total=None, rate="")
        self._begun, self._done = time.monotonic(), 0

    def started(self, total: int) -> None:
        """Show the empty bar."""
        self._begun = time.monotonic()
        self._bar.update(self._task, total=total)
        self._bar.start()

    def noticed(self, text: str) -> None:
        """Say it above the bar."""
        self._console.print(text, highlight=False, markup=False)

    def frame_done(self, index: int, seconds: float) -> None:
        """Move the bar on."""
        self._done += 1
        rate = self._done / max(time.monotonic() - self._begun, 1e-9)
        self._bar.update(self._task, advance=1, rate=f"{rate:.2f} frames/s")

    def finished(self, summary: str) -> None:
        """Take the bar away and say what came of it."""
        self.close()
        self._console.print(summary, highlight=False, markup=False)

    def close(self) -> None:
        """Leave the terminal as it was."""
        self._bar.stop()

    @property
    def is_closed(self) -> bool:
        """Whether nothing is drawn any more."""
        return not self._bar.live.is_started

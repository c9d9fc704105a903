"""Progress of a mission as the user sees it: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

from survey.progress import Unwatched, Watcher

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import TaskID

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
    stream : TextIO, optional
        Where the lines go; standard output unless told.
    clock : callable
        Seconds on a clock that never goes back.
    """

    def __init__(
        self, stream: TextIO | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._stream, self._clock = stream or sys.stdout, clock
        self._total = self._done = self._steps = self._written = 0
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

    def writing(self, total: int) -> None:
        """Begin to count what is written."""
        if self._steps == 0:
            self._start = self._last_line = self._clock()
        self._steps = total

    def written(self, steps: int) -> None:
        """Say how far the products are, not too often."""
        self._written += steps
        now = self._clock()
        if now - self._last_line >= SECONDS_BETWEEN_LINES:
            self._last_line = now
            self._say(writing_line(self._written / self._steps, now - self._start))

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


def writing_line(done: float, elapsed: float) -> str:
    """Return one line on which share of the products is done.

    Examples
    --------
    >>> writing_line(0.25, 10.0)
    'products: 25 % done, 30 s left'
    """
    return f"products: {done:.0%} done, {elapsed * (1.0 / done - 1.0):.0f} s left".replace(
        "%", " %"
    )


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
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            TextColumn("left"),
            console=self._console,
        )
        self._task = self._bar.add_task("flying", total=None, rate="")
        self._products: TaskID | None = None
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

    def writing(self, total: int) -> None:
        """Turn to a bar of what is written."""
        if self._products is None:
            self._products = self._bar.add_task("writing products", rate="")
        self._bar.update(self._products, total=total)

    def written(self, steps: int) -> None:
        """Move that bar on."""
        if self._products is not None:
            self._bar.advance(self._products, steps)

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

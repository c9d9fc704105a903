"""Progress as users see it."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from survey.console import PlainLines, ProgressBar, watching


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_plain_lines_come_first_last_and_now_and_then() -> None:
    stream, clock = io.StringIO(), Clock()
    lines = PlainLines(stream, clock)
    lines.started(20)
    for index in range(20):
        clock.now += 0.5
        lines.frame_done(index, 1.0)
    lines.finished("done")
    assert stream.getvalue().splitlines() == [
        "20 frames to fly",
        "1/20 frames, 2.00 frames/s, 10 s left",
        "11/20 frames, 2.00 frames/s, 4 s left",
        "20/20 frames, 2.00 frames/s, 0 s left",
        "done",
    ]


def test_a_terminal_gets_a_bar_that_is_taken_away_after_trouble() -> None:
    def trouble() -> None:
        with watching(Terminal(), quiet=False) as watcher:
            assert isinstance(watcher, ProgressBar)
            watchers.append(watcher)
            watcher.started(3)
            watcher.frame_done(0, 1.0)
            raise KeyboardInterrupt

    watchers: list[ProgressBar] = []
    with pytest.raises(KeyboardInterrupt):
        trouble()
    assert watchers[0].is_closed


def test_the_bar_counts_frames_and_shows_the_summary() -> None:
    stream = io.StringIO()
    bar = ProgressBar(Console(file=stream, force_terminal=True, width=100))
    bar.started(2)
    bar.frame_done(1, 1.0)
    bar.frame_done(0, 1.0)
    bar.finished("2 frames [not markup]")
    assert "2/2" in stream.getvalue()
    assert "frames/s" in stream.getvalue()
    assert stream.getvalue().rstrip().endswith("2 frames [not markup]")

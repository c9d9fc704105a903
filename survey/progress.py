"""Who watches a mission while it runs."""

from __future__ import annotations

from typing import Protocol


class Watcher(Protocol):
    """What a mission tells of its progress.

    Methods are called from one thread, frames in any order.
    """

    def started(self, total: int) -> None:
        """So many frames are to be flown."""

    def noticed(self, text: str) -> None:
        """Something happened that the user should know of; it does not stop the mission."""

    def frame_done(self, index: int, seconds: float) -> None:
        """A frame is flown; it took so many seconds of one worker."""

    def writing(self, total: int) -> None:
        """The products are written, in so many steps; a later call tells it better."""

    def written(self, steps: int) -> None:
        """So many more of these steps are done."""

    def finished(self, summary: str) -> None:
        """All is written; the summary is one or more lines for the user."""


class Unwatched:
    """A watcher that does nothing.

    Examples
    --------
    >>> watcher: Watcher = Unwatched()
    >>> watcher.started(3)
    """

    def started(self, total: int) -> None:
        """Do nothing."""

    def noticed(self, text: str) -> None:
        """Do nothing."""

    def frame_done(self, index: int, seconds: float) -> None:
        """Do nothing."""

    def writing(self, total: int) -> None:
        """Do nothing."""

    def written(self, steps: int) -> None:
        """Do nothing."""

    def finished(self, summary: str) -> None:
        """Do nothing."""

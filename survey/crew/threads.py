"""Frames flown by threads of this process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import ClassVar

from survey.crew.outcome import Outcome, Result, Work
from survey.crew.pool import through


@dataclass(frozen=True, kw_only=True)
class Threads:
    """Threads share all memory, and a crash in one ends the process."""

    workers: int
    shares_memory: ClassVar[bool] = True

    @property
    def described(self) -> str:
        """Who that is, in words for the user."""
        return f"{self.workers} threads"

    def fly(self, work: Work[Result], frames: Iterable[int]) -> Iterator[Outcome[Result]]:
        """Yield what comes of every frame, in any order.

        Examples
        --------
        >>> crew = Threads(workers=2)
        >>> sorted(done.result for done in crew.fly(lambda index: index**2, range(4)))
        [0, 1, 4, 9]
        """
        with ThreadPoolExecutor(self.workers) as pool:
            yield from through(pool, work, frames, ahead=2 * self.workers)

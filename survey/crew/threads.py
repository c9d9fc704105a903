"""Frames flown by threads of this process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from typing import ClassVar

from survey.crew.outcome import Outcome, Result, Work, attempt

AHEAD = 2


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

        Frames that have not begun are taken back when the caller stops.

        Examples
        --------
        >>> crew = Threads(workers=2)
        >>> sorted(done.result for done in crew.fly(lambda index: index**2, range(4)))
        [0, 1, 4, 9]
        """
        left, flying = iter(frames), set[Future[Outcome[Result]]]()
        with ThreadPoolExecutor(self.workers) as pool:
            try:
                while True:
                    for index in islice(left, AHEAD * self.workers - len(flying)):
                        flying.add(pool.submit(attempt, work, index))
                    if not flying:
                        return
                    ended, flying = wait(flying, return_when=FIRST_COMPLETED)
                    for future in ended:
                        yield future.result()
            finally:
                for future in flying:
                    future.cancel()

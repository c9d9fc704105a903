"""Frames through a pool of the standard library's kind, a few ahead."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from itertools import islice

from survey.crew.outcome import Failed, Outcome, Result, Work, attempt, in_words
from survey.errors import UserError


def through(
    pool: Executor, work: Work[Result], frames: Iterable[int], *, ahead: int
) -> Iterator[Outcome[Result]]:
    """Yield what comes of every frame; at most ``ahead`` frames are in the pool at a time.

    So memory does not grow with the mission. Frames that have not begun are taken back when the
    caller stops.
    """
    left = iter(frames)
    flying: dict[Future[Outcome[Result]], int] = {}
    try:
        while True:
            for index in islice(left, ahead - len(flying)):
                flying[pool.submit(attempt, work, index)] = index
            if not flying:
                return
            done, _ = wait(flying, return_when=FIRST_COMPLETED)
            for future in done:
                yield _outcome(future, flying.pop(future))
    finally:
        for future in flying:
            future.cancel()


def _outcome(future: Future[Outcome[Result]], index: int) -> Outcome[Result]:
    """Return what a worker sent; a worker that was lost is the frame's failure."""
    try:
        return future.result()
    except UserError:
        raise
    except Exception as error:
        return Failed(index=index, reason=in_words(error))

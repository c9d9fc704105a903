"""Frames that fail are flown again, and in the end set aside."""

from __future__ import annotations

from collections.abc import Generator, Iterable

from survey.crew.outcome import Crew, Done, Failed, Outcome, Result, Work

TRIES = 3


def patiently(
    crew: Crew, work: Work[Result], frames: Iterable[int]
) -> Generator[Outcome[Result], None, None]:
    """Yield every frame once: done, or failed three times.

    Frames that fail are flown again when all others are done, one at a time: a frame that brings
    its worker down then takes no other with it, and one that lacked memory has all of it.

    Examples
    --------
    >>> from survey.crew.threads import Threads
    >>> tries = []
    >>> def work(index):
    ...     tries.append(index)
    ...     return 1 / index
    >>> *_, last = patiently(Threads(workers=1), work, range(3))
    >>> last.index, tries
    (0, [0, 1, 2, 0, 0])
    """
    failed = []
    for outcome in crew.fly(work, frames):
        if isinstance(outcome, Done):
            yield outcome
        else:
            failed.append(outcome)
    for failure in sorted(failed, key=lambda failure: failure.index):
        yield _alone(crew, work, failure)


def _alone(crew: Crew, work: Work[Result], failure: Failed) -> Outcome[Result]:
    """Return what comes of a frame that failed once, flown by itself."""
    outcome: Outcome[Result] = failure
    for _ in range(TRIES - 1):
        (outcome,) = crew.fly(work, (failure.index,))
        if isinstance(outcome, Done):
            break
    return outcome

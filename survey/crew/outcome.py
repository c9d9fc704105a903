"""What comes of one frame in the hands of a worker."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from traceback import extract_tb
from typing import Generic, Protocol, TypeVar

from survey.errors import UserError

Result = TypeVar("Result")
Work = Callable[[int], Result]


@dataclass(frozen=True, kw_only=True)
class Done(Generic[Result]):
    """A frame that is done.

    Parameters
    ----------
    index : int
        Number of the frame.
    result : object
        What the work returned.
    seconds : float
        That one worker took [s].
    """

    index: int
    result: Result
    seconds: float


@dataclass(frozen=True, kw_only=True)
class Failed:
    """A frame that failed, and why."""

    index: int
    reason: str


Outcome = Done[Result] | Failed


class Crew(Protocol):
    """Somebody who does the same work for many frames, several at once."""

    @property
    def described(self) -> str:
        """Who that is, in words for the user."""

    @property
    def shares_memory(self) -> bool:
        """Whether it sees what this process has prepared."""

    def fly(self, work: Work[Result], frames: Iterable[int]) -> Iterator[Outcome[Result]]:
        """Yield what comes of every frame, in any order.

        A frame may be begun more than once, so its result must not depend on that; it is yielded
        once.

        Raises
        ------
        UserError
            When the work says so: that is no fault of a frame.
        """


def attempt(work: Work[Result], index: int) -> Outcome[Result]:
    """Return what comes of a frame; an error of the user's making is raised.

    Examples
    --------
    >>> attempt(lambda index: 2 * index, 21).result
    42
    >>> attempt(lambda index: 1 // index, 0)
    Failed(index=0, reason='ZeroDivisionError: integer division or modulo by zero (<doctest ...:1)')
    """
    start = time.perf_counter()
    try:
        result = work(index)
    except UserError:
        raise
    except Exception as error:
        return Failed(index=index, reason=in_words(error))
    return Done(index=index, result=result, seconds=time.perf_counter() - start)


def in_words(error: BaseException) -> str:
    """Return an error in one line, with the place in the code where it was raised.

    Examples
    --------
    >>> in_words(ValueError("not\\nfinite"))
    'ValueError: not finite'
    """
    text = f"{type(error).__name__}: {' '.join(str(error).split())}".removesuffix(": ")
    steps = extract_tb(error.__traceback__)
    return f"{text} ({Path(steps[-1].filename).name}:{steps[-1].lineno})" if steps else text

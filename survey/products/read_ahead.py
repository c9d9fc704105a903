"""Frames read in other threads before they are needed."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice

from survey.products.frame_file import FrameResult

READERS, AHEAD = 2, 6


def read_ahead(read: Callable[[int], FrameResult], numbers: Iterable[int]) -> Iterator[FrameResult]:
    """Yield frames in the order of their numbers' sequence, a few of them read ahead."""
    waiting: deque[Future[FrameResult]] = deque()
    rest = iter(numbers)
    with ThreadPoolExecutor(READERS) as pool:
        waiting.extend(pool.submit(read, number) for number in islice(rest, AHEAD))
        while waiting:
            result = waiting.popleft().result()
            waiting.extend(pool.submit(read, number) for number in islice(rest, 1))
            yield result

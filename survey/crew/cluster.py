"""Frames flown by the workers of a dask cluster that is already there."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, ClassVar

from survey.crew.outcome import Failed, Outcome, Result, Work, attempt, in_words
from survey.errors import UserError

AHEAD = 512
PATIENCE = "20s"
BETWEEN_LOOKS = 0.02  # [s]


class ClusterError(UserError):
    """No cluster to fly on."""


@dataclass(frozen=True, kw_only=True)
class Cluster:
    """Workers that dask has started anywhere; they come and go as they like.

    Dask may fly a frame twice, or again elsewhere when a worker is lost.
    """

    client: Any
    shares_memory: ClassVar[bool] = False

    @property
    def described(self) -> str:
        """Who that is, in words for the user."""
        threads = self.client.nthreads()
        there = f"{len(threads)} workers with {sum(threads.values())} threads"
        waiting = there if threads else "no worker yet: waiting for the first"
        return f"the dask cluster at {self.client.scheduler.address}, {waiting}"

    def fly(self, work: Work[Result], frames: Iterable[int]) -> Iterator[Outcome[Result]]:
        """Yield what comes of every frame, in any order; the work is pickled.

        Raises
        ------
        ClusterError
            When the scheduler is gone.
        """
        left, flying = iter(frames), dict[Any, int]()
        try:
            while True:
                self._require_scheduler()
                for index in islice(left, AHEAD - len(flying)):
                    flying[self.client.submit(attempt, work, index, pure=False)] = index
                if not flying:
                    return
                for future in self._ended(flying):
                    yield _outcome(future, flying.pop(future))
        finally:
            if self.client.status == "running":
                self.client.cancel(list(flying))

    def _ended(self, flying: Iterable[Any]) -> Sequence[Any]:
        """Wait for the next futures that end; looked for, since a lost scheduler tells nobody."""
        while not (ended := [future for future in flying if future.status != "pending"]):
            self._require_scheduler()
            time.sleep(BETWEEN_LOOKS)
        return ended

    def _require_scheduler(self) -> None:
        if self.client.status in ("closing", "closed"):
            raise ClusterError("the dask scheduler is gone. The same command goes on from here")


def _outcome(future: Any, index: int) -> Outcome[Any]:
    """Return what a worker sent; a worker that was lost is the frame's failure."""
    if future.cancelled():
        return Failed(index=index, reason="lost by the cluster")
    try:
        outcome: Outcome[Any] = future.result()
    except UserError:
        raise
    except Exception as error:
        return Failed(index=index, reason=in_words(error))
    return outcome


@contextmanager
def connected(place: str) -> Iterator[Cluster]:
    """Give the cluster whose scheduler has an address, or wrote a file.

    Parameters
    ----------
    place : str
        Address such as ``tcp://10.0.0.1:8786``, or path of a scheduler file.

    Raises
    ------
    ClusterError
        When dask's scheduler is not installed, or nobody answers there.
    FileNotFoundError
        When there is no such file.
    """
    is_file = ":" not in place
    if is_file and not Path(place).exists():
        raise FileNotFoundError(
            f"{place}: no scheduler file. `dask scheduler --scheduler-file {place}` writes it"
        )
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise ClusterError(
            f"{place}: dask.distributed is not installed. Type: pip install bathyflash[cluster]"
        ) from None
    where = {"scheduler_file" if is_file else "address": place}
    try:
        client = Client(timeout=PATIENCE, set_as_default=False, **where)
    except (OSError, ValueError) as error:
        raise ClusterError(
            f"{place}: no dask scheduler answers ({error}). Give its address or scheduler file"
        ) from None
    with client:
        yield Cluster(client=client)

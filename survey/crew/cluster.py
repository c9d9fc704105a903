"""Frames flown by the workers of a dask cluster that is already there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from survey.crew.outcome import Outcome, Result, Work
from survey.crew.pool import through
from survey.errors import UserError

AHEAD = 512
PATIENCE = "20s"


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
        """Yield what comes of every frame, in any order; the work is pickled."""
        with self.client.get_executor(pure=False) as pool:
            yield from through(pool, work, frames, ahead=AHEAD)


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
    """
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise ClusterError(
            f"{place}: dask.distributed is not installed. Type: pip install bathyflash[cluster]"
        ) from None
    scheduler = {"scheduler_file": place} if Path(place).is_file() else {"address": place}
    try:
        client = Client(timeout=PATIENCE, set_as_default=False, **scheduler)
    except (OSError, ValueError) as error:
        raise ClusterError(
            f"{place}: no dask scheduler answers ({error}). Give its address or scheduler file"
        ) from None
    with client:
        yield Cluster(client=client)

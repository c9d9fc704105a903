"""Which crew flies."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Literal

from survey.crew.cluster import connected
from survey.crew.outcome import Crew
from survey.crew.processes import Processes
from survey.crew.threads import Threads
from survey.errors import UserError

Kind = Literal["threads", "processes"]
CREWS: Mapping[Kind, Callable[..., Crew]] = {"threads": Threads, "processes": Processes}


def local_crew(workers: int = 0, kind: Kind = "processes") -> Crew:
    """Return workers of this machine; 0 is one for each core that this process may use.

    Examples
    --------
    >>> local_crew(3).described
    '3 processes'
    """
    return CREWS[kind](workers=workers or cores())


@contextmanager
def hired(*, workers: int, kind: Kind, cluster: str | None) -> Iterator[Crew]:
    """Give the workers of a cluster if there is one, else those of this machine."""
    if cluster is None:
        yield local_crew(workers, kind)
    else:
        with connected(cluster) as crew:
            yield crew


def cluster_of(asked: str | None, *, workers: int | None, kind: Kind | None) -> str | None:
    """Return the cluster to fly on: the one asked for, or that of the environment.

    Whoever asks for workers of this machine gets these, whatever the environment says.

    Raises
    ------
    UserError
        When both are asked for.
    """
    local = workers is not None or kind is not None
    if asked and local:
        raise UserError("--cluster brings its own workers. Leave out --workers and --with")
    return asked if asked or local else os.environ.get("DASK_SCHEDULER_ADDRESS") or None


def cores() -> int:
    """Return how many cores this process may use: a batch system may have given it a few."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

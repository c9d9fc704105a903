"""A function in a process of its own, with one thread."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any, TypeVar

Result = TypeVar("Result")


def alone(function: Callable[..., Result], *arguments: Any, **named: Any) -> Result:
    """Return what a function returns in a child process; what it raises is raised here.

    open3d's parallel sums change from run to run, and its threads outlive a call.

    Examples
    --------
    >>> alone(abs, -2)
    2
    """
    with ProcessPoolExecutor(
        1, mp_context=get_context("spawn"), initializer=_with_one_thread
    ) as child:
        return child.submit(function, *arguments, **named).result()


def _with_one_thread() -> None:
    os.environ["OMP_NUM_THREADS"] = "1"

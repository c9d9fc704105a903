"""Readers that do what a damaged file makes a reader do; run in the child."""

from __future__ import annotations

import ctypes
import os
import time
from typing import Any

import numpy as np

from terrain.foreign.faults import ReaderError, readable


def double(path: str, *, numbers: list[float]) -> dict[str, Any]:
    """Return numbers times two, and the file's name."""
    return {"twice": 2.0 * np.array(numbers), "name": path}


def find_faults(path: str) -> dict[str, Any]:
    """Find two."""
    raise ReaderError("face 3: no area", "vertex 5: not finite")


def stumble(path: str) -> dict[str, Any]:
    """Raise what a library may raise."""
    with readable("mesh file"):
        raise KeyError("offset\n of chunk")


def forget(path: str) -> dict[str, Any]:
    """Raise what no reader expects."""
    raise RuntimeError("what is this?")


def spin(path: str) -> dict[str, Any]:
    """Never end."""
    while True:
        pass


def wait(path: str) -> dict[str, Any]:
    """Sleep for ever."""
    time.sleep(1e6)
    return {}


def swallow(path: str) -> dict[str, Any]:
    """Ask for 150 GiB."""
    return {"all": np.ones((150, 1 << 27))}


def abort(path: str) -> dict[str, Any]:
    """End as compiled code does that panics."""
    os.abort()


def overrun(path: str) -> dict[str, Any]:
    """Read where there is no memory."""
    return {"nothing": ctypes.string_at(0)}

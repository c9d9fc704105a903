"""What of this machine matters to a mission, and whether it is in order."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

LIBRARIES = ("numpy", "numba", "scipy", "trimesh", "pyvista", "vtk", "laspy", "rasterio", "pyproj")
LEAST_MEMORY_GIB = 2.0


@dataclass(frozen=True)
class Finding:
    """One thing examined."""

    what: str
    text: str
    good: bool = True


def examine(render: Callable[[], None]) -> list[Finding]:
    """Examine this machine.

    Parameters
    ----------
    render : callable
        Tries to render a picture; raises RuntimeError with what to do when it cannot.
    """
    return [*_versions(), _open3d(), _threads(), _memory(), _rendering(render)]


def _versions() -> list[Finding]:
    own = Finding("bathyflash", f"{_version('bathyflash') or 'not installed'}")
    python = Finding("python", f"{platform.python_version()} on {platform.platform()}")
    found = {name: _version(name) for name in LIBRARIES}
    return [own, python] + [
        Finding(name, number or "missing. Type: make venv", number is not None)
        for name, number in found.items()
    ]


def _open3d() -> Finding:
    found = {name: _version(name) for name in ("open3d", "open3d-cpu")}
    present = [f"{name} {number}" for name, number in found.items() if number]
    if len(present) == 1:
        return Finding("open3d", present[0])
    wrong = "both open3d and open3d-cpu; they overwrite each other" if present else "missing"
    return Finding("open3d", f"{wrong}. Type: rm -rf .venv && make venv", good=False)


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _threads() -> Finding:
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return Finding("threads", f"{usable} of {os.cpu_count()} cores may be used")


def _memory() -> Finding:
    table = Path("/proc/meminfo")
    if not table.is_file():
        return Finding("memory", "cannot be read on this system")
    rows = (line.split() for line in table.read_text(encoding="ascii").splitlines())
    gib = {row[0].rstrip(":"): int(row[1]) / 1024**2 for row in rows if len(row) > 1}
    free, total = gib["MemAvailable"], gib["MemTotal"]
    text = f"{free:.1f} GiB free of {total:.1f} GiB"
    if free < LEAST_MEMORY_GIB:
        return Finding("memory", f"{text}; a mission wants {LEAST_MEMORY_GIB:g} GiB", good=False)
    return Finding("memory", text)


def _rendering(render: Callable[[], None]) -> Finding:
    try:
        render()
    except RuntimeError as fault:
        return Finding("rendering", str(fault), good=False)
    return Finding("rendering", "draws off screen")

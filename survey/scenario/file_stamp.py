"""By what a file that was read once is known to be the same."""

from __future__ import annotations

from pathlib import Path


def stamp_of(path: Path) -> tuple[int, int]:
    """Return time of the last change [ns] and size [bytes] of a file."""
    status = path.stat()
    return status.st_mtime_ns, status.st_size

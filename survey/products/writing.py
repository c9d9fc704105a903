"""Files that are either whole or absent."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PARTIAL = ".partial"


class ProductError(ValueError):
    """A product that cannot be made from its inputs; the text says why and what to do."""


class ReadBackError(OSError):
    """A file that does not hold what was just written to it."""


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary name to write and read back, and rename it when the block succeeds.

    A writer killed half-way may leave a file that opens cleanly and is empty. So the block writes
    to the temporary name in the same folder and reads it back; then the file is flushed to
    the disk, renamed, and the folder is flushed. When the block raises, nothing is left.

    Parameters
    ----------
    path : Path
        The final name. The temporary one has the same suffix.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "note.txt"
    >>> with whole_file(path) as partial:
    ...     _ = partial.write_text("whole")
    >>> [file.name for file in path.parent.iterdir()], path.read_text()
    (['note.txt'], 'whole')
    """
    partial = path.with_name(f".{path.stem}{PARTIAL}{path.suffix}")
    try:
        yield partial
        flush(partial)
        partial.replace(path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise
    flush(path.parent)


def is_partial(path: Path) -> bool:
    """Tell whether a name is a temporary one of `whole_file`, left by a process that was killed.

    Examples
    --------
    >>> is_partial(Path(".bottom.partial.laz")), is_partial(Path("bottom.laz"))
    (True, False)
    """
    return path.name.startswith(".") and PARTIAL in path.name


def write_whole(path: Path, content: bytes) -> None:
    """Write bytes as one whole file.

    Raises
    ------
    ReadBackError
        If the file does not read back as written.
    """
    with whole_file(path) as partial:
        partial.write_bytes(content)
        require_read_back(path, "bytes", partial.read_bytes() == content)


def require_read_back(path: Path, what: str, is_equal: bool) -> None:
    """Raise `ReadBackError` unless what was read back equals what was written."""
    if not is_equal:
        raise ReadBackError(
            f"{path}: {what}: not read back as written. Check the disk and its free space"
        )


def flush(path: Path) -> None:
    """Flush a file, or the names in a folder, to the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)

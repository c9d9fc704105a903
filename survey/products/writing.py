"""Files that are either whole or absent."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
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
    with naming(path, partial):
        try:
            yield partial
            flush(partial)
            partial.replace(path)
        except BaseException:
            with suppress(OSError):
                partial.unlink(missing_ok=True)
            raise
        flush(path.parent)


@contextmanager
def naming(path: Path, partial: Path | None = None) -> Iterator[None]:
    """Let errors of the system that name no file, or its temporary name, name this one.

    Examples
    --------
    >>> with naming(Path("bottom.laz")):
    ...     raise OSError(28, "No space left on device")
    Traceback (most recent call last):
    OSError: [Errno 28] No space left on device: 'bottom.laz'
    """
    try:
        yield
    except OSError as error:
        if error.errno is None or error.filename not in (None, str(partial)):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


def is_partial(path: Path) -> bool:
    """Tell whether a name is a temporary one of `whole_file`, left by a process that was killed.

    Examples
    --------
    >>> is_partial(Path(".bottom.partial.laz")), is_partial(Path("bottom.laz"))
    (True, False)
    """
    return path.name.startswith(".") and PARTIAL in path.name


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Give a temporary name for a folder, and rename it when the block succeeds.

    As `whole_file`; the block makes the folder. One that stands at ``path`` is replaced, and what
    a killed writer left under the temporary name is taken away first.

    Parameters
    ----------
    path : Path
        The final name. The temporary one has the same suffix.
    """
    partial = path.with_name(f".{path.stem}.partial{path.suffix}")
    old = path.with_name(f".{path.stem}.old{path.suffix}")
    shutil.rmtree(partial, ignore_errors=True)
    try:
        yield partial
        for place in (*partial.rglob("*"), partial):
            flush(place)
        if path.exists():
            shutil.rmtree(old, ignore_errors=True)
            path.replace(old)
        partial.replace(path)
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        raise
    flush(path.parent)
    shutil.rmtree(old, ignore_errors=True)


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

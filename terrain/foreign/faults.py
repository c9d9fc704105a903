"""What a reader in the child says of a file, and what the parent makes of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

LONGEST_REASON = 200
NO_MEMORY = ("memory", "cannot allocate", "unable to allocate", "bad_alloc")


class ReaderError(ValueError):
    """What a reader found, raised in the child.

    Parameters
    ----------
    *faults : str
        ``place: what is wrong. what to do``, without the file's name.
    """

    def __init__(self, *faults: str) -> None:
        self.faults = faults
        super().__init__("\n".join(faults))


class ForeignFileError(ValueError):
    """A file that could not be read, raised in the parent; its text is a line a fault.

    Examples
    --------
    >>> print(ForeignFileError(Path("wreck.ply"), ["face 812: index 7, but there are 3 vertices"]))
    wreck.ply: face 812: index 7, but there are 3 vertices
    """

    def __init__(self, path: Path, faults: Sequence[str]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(f"{path}: {fault}" for fault in faults))


@contextmanager
def readable(what: str) -> Iterator[None]:
    """Turn whatever a library raises into the fault that a file is no readable ``what``."""
    try:
        yield
    except (ReaderError, MemoryError):
        raise
    except Exception as error:
        reason = _first_cause(error)
        if speaks_of_memory(reason):
            raise MemoryError(reason) from error
        raise ReaderError(f"not a readable {what}: fetch or export it again. {reason}") from error


def speaks_of_memory(words: str) -> bool:
    """Tell whether a library's words are about memory that it did not get.

    Examples
    --------
    >>> speaks_of_memory("gdalrasterblock.cpp, 1102: cannot allocate 1600000000 bytes")
    True
    """
    return any(phrase in words.lower() for phrase in NO_MEMORY)


def _first_cause(error: BaseException) -> str:
    """Return in one line what was raised first; libraries wrap it in "see previous"."""
    while error.__cause__ is not None:
        error = error.__cause__
    reason = " ".join(str(error).split()) or type(error).__name__
    return reason if len(reason) <= LONGEST_REASON else f"{reason[:LONGEST_REASON]}..."

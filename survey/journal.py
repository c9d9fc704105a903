"""The journal of a run: one line a whole frame, each with a checksum of its own."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from survey.products.writing import flush, naming


@dataclass(frozen=True, kw_only=True)
class Note:
    """That a frame is whole.

    Parameters
    ----------
    frame : int
        Its number.
    sha256 : str
        Of its file.
    done : float
        When it was written, seconds since 1970 [s].
    """

    frame: int
    sha256: str
    done: float


def write_note(path: Path, note: Note) -> None:
    """Add a line to a journal and flush it to the disk; a torn last line is ended first."""
    fresh = not path.exists()
    with naming(path):
        with path.open("ab+") as journal:
            journal.write(_line_break_after_torn(journal) + _line(note))
            journal.flush()
            os.fsync(journal.fileno())
        if fresh:
            flush(path.parent)


def read_notes(path: Path) -> Iterator[Note]:
    """Yield the notes whose checksum is right, in the order of writing; others are as if absent.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "journal.jsonl"
    >>> write_note(path, Note(frame=3, sha256="ab", done=0.0))
    >>> write_note(path, Note(frame=4, sha256="cd", done=1.0))
    >>> _ = path.write_text(path.read_text().replace("cd", "ce"))
    >>> [note.frame for note in read_notes(path)]
    [3]
    """
    if not path.exists():
        return
    for line in path.read_bytes().splitlines():
        try:
            values = json.loads(line)
            check = values.pop("crc32")
            note = Note(**values)
        except (ValueError, KeyError, TypeError, AttributeError):
            continue
        if check == _checksum(asdict(note)):
            yield note


def _line(note: Note) -> bytes:
    values = asdict(note)
    return json.dumps(values | {"crc32": _checksum(values)}).encode() + b"\n"


def _checksum(values: dict[str, Any]) -> str:
    return f"{zlib.crc32(json.dumps(values, sort_keys=True).encode()):08x}"


def _line_break_after_torn(journal: Any) -> bytes:
    if journal.seek(0, os.SEEK_END) == 0:
        return b""
    journal.seek(-1, os.SEEK_END)
    return b"" if journal.read(1) == b"\n" else b"\n"

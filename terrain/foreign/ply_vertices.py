"""The vertices of a PLY file with all their columns, exact: trimesh would make float32 of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from terrain.foreign.faults import ReaderError

LARGEST_HEADER = 65536  # [bytes]
TYPES = {
    **{"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2"},
    **{"ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4"},
    **{"float": "f4", "float32": "f4", "double": "f8", "float64": "f8"},
}
ORDERS: dict[str, Literal["<", ">"]] = {"binary_little_endian": "<", "binary_big_endian": ">"}


def read_vertices(path: Path) -> tuple[list[str], NDArray[np.void]]:
    """Return the comments of a PLY file and its vertices, a record each.

    Raises
    ------
    ReaderError
        When it is no PLY file, or does not hold the vertices that it announces.
    """
    content = path.read_bytes()
    header, body = _parted(content)
    words = [line.split() for line in header]
    comments = [" ".join(line[1:]) for line in words if line[:1] == ["comment"]]
    kind = next((line[1] for line in words if line[:1] == ["format"] and line[1:]), "")
    count, record = _vertex(words)
    if kind == "ascii":
        return comments, _from_text(body, count, record)
    if kind not in ORDERS:
        raise ReaderError(f"header: format {kind!r} is none of PLY. write ascii or binary")
    record = record.newbyteorder(ORDERS[kind])
    if len(body) < count * record.itemsize:
        raise ReaderError(
            f"vertices: {count} announced, {len(body) // record.itemsize} there. write it again"
        )
    return comments, np.frombuffer(body, dtype=record, count=count)


def _parted(content: bytes) -> tuple[list[str], bytes]:
    start = content[:LARGEST_HEADER]
    mark = start.find(b"end_header")
    line_end = start.find(b"\n", mark)
    if not start.startswith(b"ply") or mark < 0 or line_end < 0:
        raise ReaderError("header: not that of a PLY file")
    return start[:mark].decode("ascii", "replace").splitlines(), content[line_end + 1 :]


def _vertex(words: Sequence[Sequence[str]]) -> tuple[int, np.dtype[Any]]:
    elements = [line for line in words if line[:1] == ["element"]]
    if not elements or len(elements[0]) != 3 or elements[0][1] != "vertex":
        raise ReaderError("header: vertices must come first. export a point cloud")
    if not elements[0][2].isdigit():
        raise ReaderError(f"header: {elements[0][2]!r} vertices")
    first = words.index(elements[0]) + 1
    columns = []
    for line in words[first:]:
        if line[:1] == ["element"]:
            break
        if line[:1] == ["property"]:
            if len(line) != 3 or line[1] not in TYPES:
                raise ReaderError(f"header: {' '.join(line)!r} is no plain column")
            columns.append((line[2], TYPES[line[1]]))
    if len({name for name, _ in columns}) < len(columns):
        raise ReaderError("header: two columns have one name")
    return int(elements[0][2]), np.dtype(columns)


def _from_text(body: bytes, count: int, record: np.dtype[Any]) -> NDArray[np.void]:
    rows = body.decode("ascii", "replace").splitlines()[:count]
    if len(rows) < count:
        raise ReaderError(f"vertices: {count} announced, {len(rows)} there. write it again")
    if count == 0:
        return np.empty(0, dtype=record)
    try:
        table = np.loadtxt(rows, ndmin=2, comments=None)
    except ValueError as fault:
        raise ReaderError(f"vertices: {fault}") from None
    names = record.names or ()
    if table.shape[1] != len(names):
        raise ReaderError(f"vertices: {table.shape[1]} columns, but {len(names)} announced")
    vertices = np.empty(count, dtype=[(name, "f8") for name in names])
    for number, name in enumerate(names):
        vertices[name] = table[:, number]
    return vertices

"""Classified point clouds of others, read in the child: LAS, LAZ, PLY, CSV.

Each reader returns ``points`` (n, 3) as the file has them, ``classification`` (n,), empty where the
file has none, and ``crs``, as WKT or ``EPSG:number``, empty where the file names none.
"""

from __future__ import annotations

import re
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from terrain.foreign.faults import ReaderError, readable
from terrain.foreign.las_header import require_plausible_header
from terrain.foreign.las_reader import POINTS_AT_ONCE
from terrain.foreign.ply_vertices import read_vertices
from terrain.foreign.text_table import few, is_number

NAMES = {
    "x": ("x", "easting_m", "easting", "east", "e", "x_m"),
    "y": ("y", "northing_m", "northing", "north", "n", "y_m"),
    "z": ("z", "elevation_m", "elevation", "up_m", "up", "height_m", "height", "z_m"),
    "classification": ("classification", "class", "scalar_classification", "label"),
}
"""Names of columns that are known, in small letters."""
SEPARATORS = (",", ";", "\t", None)
Cloud = dict[str, Any]


def read_las(path: str) -> Cloud:
    """Return the cloud of a LAS or LAZ file.

    Raises
    ------
    ReaderError
        When it is no readable file.
    """
    import laspy

    require_plausible_header(Path(path))
    places, classes = [np.empty((0, 3))], [np.empty(0, dtype=np.uint8)]
    with readable("LAS or LAZ file"), laspy.open(path) as source:
        crs = source.header.parse_crs()
        for chunk in source.chunk_iterator(POINTS_AT_ONCE):
            places.append(np.column_stack([chunk.x, chunk.y, chunk.z]))
            classes.append(np.asarray(chunk.classification, dtype=np.uint8))
    return {
        "points": np.concatenate(places),
        "classification": np.concatenate(classes),
        "crs": crs.to_wkt() if crs else "",
    }


def read_ply(path: str) -> Cloud:
    """Return the cloud of the vertices of a PLY file, ASCII or binary.

    A comment ``epsg 25832`` in its header names the coordinate system.

    Raises
    ------
    ReaderError
        When it is no PLY file, is cut short or lacks coordinates.
    """
    comments, vertices = read_vertices(Path(path))
    chosen = _chosen(list(vertices.dtype.names or ()), "header")
    epsg = [words[1] for words in map(str.split, comments) if words[:1] == ["epsg"] and words[1:]]
    return _cloud(
        [np.asarray(vertices[chosen[axis]], dtype=np.float64) for axis in "xyz"],
        vertices[chosen["classification"]] if "classification" in chosen else None,
        crs=f"EPSG:{epsg[0]}" if epsg else "",
    )


def read_csv(path: str) -> Cloud:
    """Return the cloud of a table with a header: commas, semicolons, tabs or spaces.

    Raises
    ------
    ReaderError
        With every fault: no header, columns that are missing, rows that are no numbers.
    """
    text = Path(path).read_bytes()
    try:
        rows = text.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as fault:
        raise ReaderError(f"byte {fault.start}: not UTF-8 text. export it as UTF-8") from None
    header = rows[0] if rows else ""
    separator = next((mark for mark in SEPARATORS if mark is None or mark in header), None)
    names = [name.strip().strip('"').lstrip("#/").strip() for name in header.split(separator)]
    if names and all(re.fullmatch(r"[-+]?[\d.]+([eE][-+]?\d+)?", name) for name in names):
        raise ReaderError(
            "line 1: numbers, but no header. write one: easting_m,northing_m,elevation_m,"
            "classification"
        )
    chosen = _chosen(names, "line 1")
    columns = [names.index(name) for name in chosen.values()]
    table = _numbers(rows[1:], columns, list(chosen.values()), separator)
    return _cloud([table[:, i] for i in range(3)], table[:, 3] if len(columns) == 4 else None)


def _numbers(
    rows: list[str], columns: list[int], names: list[str], separator: str | None
) -> NDArray[np.float64]:
    filled = [row for row in rows if row.strip()]
    if not filled:
        return np.empty((0, len(columns)))
    try:
        return np.loadtxt(filled, delimiter=separator, usecols=columns, ndmin=2, comments=None)
    except ValueError:
        faults: list[str] = []
        for line, row in enumerate(rows, start=2):
            words = row.split(separator)
            for name, column in zip(names, columns, strict=True):
                if row.strip() and not (column < len(words) and is_number(words[column])):
                    shown = repr(words[column].strip()) if column < len(words) else "missing"
                    faults.append(f"line {line}: {name}: {shown} is no number")
        raise ReaderError(*few(faults)) from None


def _chosen(names: list[str], place: str) -> dict[str, str]:
    """Return the file's name of each column that is known: x, y, z and perhaps classification."""
    small = {name.lower(): name for name in reversed(names)}
    chosen = {
        column: next(small[name] for name in known if name in small)
        for column, known in NAMES.items()
        if any(name in small for name in known)
    }
    missing = [column for column in "xyz" if column not in chosen]
    if missing:
        strangers = [name for name in names if name not in chosen.values()]
        raise ReaderError(*(_missing(column, place, strangers) for column in missing))
    return chosen


def _missing(column: str, place: str, strangers: list[str]) -> str:
    near = get_close_matches(NAMES[column][1], [name.lower() for name in strangers], n=1)
    hint = f" did you mean {NAMES[column][1]!r} by {near[0]!r}?" if near else ""
    listed = ", ".join(repr(name) for name in strangers[:8]) or "none"
    return (
        f"{place}: no column {column}. call it {' or '.join(NAMES[column][:2])}.{hint} "
        f"columns not known: {listed}"
    )


def _cloud(axes: list[Any], classes: Any, *, crs: str = "") -> Cloud:
    points = np.column_stack(axes)
    if classes is None:
        return {"points": points, "classification": np.empty(0, dtype=np.uint8), "crs": crs}
    classes = np.asarray(classes, dtype=np.float64)
    wrong = np.flatnonzero(~((classes >= 0) & (classes <= 255) & (classes == np.floor(classes))))
    if wrong.size:
        raise ReaderError(
            f"point {wrong[0]}: class {classes[wrong[0]]:g}, but LAS classes are 0 to 255"
        )
    return {"points": points, "classification": classes.astype(np.uint8), "crs": crs}

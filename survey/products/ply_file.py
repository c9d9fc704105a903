"""Point clouds as PLY files: every column, exact."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import SEEK_END
from pathlib import Path
from typing import Any, BinaryIO
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from survey.products.writing import ProductError, require_read_back, whole_file, write_whole
from terrain.map_frame import MapFrame

PLY_RECORD = np.dtype(
    [
        *((name, "<f8") for name in ("x", "y", "z")),
        *((f"uncorrected_{axis}", "<f8") for axis in "xyz"),
        *((f"true_{axis}", "<f8") for axis in "xyz"),
        ("true_elevation", "<f8"),
        *((f"true_surface_{axis}", "<f8") for axis in "xyz"),
        *((f"true_normal_{axis}", "<f4") for axis in "xyz"),
        ("true_water_path", "<f4"),
        ("total_tvu", "<f4"),
        ("total_thu", "<f4"),
        ("surface_z", "<f8"),
        ("reflectance", "<f4"),
        ("true_reflectance", "<f4"),
        ("time_s", "<f8"),
        ("depth_m", "<f8"),
        ("counts", "<f4"),
        ("snr", "<f4"),
        ("frame", "<u4"),
        ("line", "<u2"),
        ("pixel_row", "<u2"),
        ("pixel_column", "<u2"),
        ("classification", "u1"),
        ("true_class", "u1"),
        ("substrate", "u1"),
        ("cause", "u1"),
    ]
)
COUNT_DIGITS = 20
HEADER_BYTES, BYTES_AT_ONCE = 1 << 14, 1 << 24
PLY_TYPES = {"<f8": "double", "<f4": "float", "<u4": "uint", "<u2": "ushort", "|u1": "uchar"}
COLUMNS = {
    "true_elevation": "true_elevation",
    "water_path": "true_water_path",
    "tvu": "total_tvu",
    "thu": "total_thu",
    "surface_elevation": "surface_z",
    "reflectance": "reflectance",
    "true_reflectance": "true_reflectance",
    "time": "time_s",
    "depth": "depth_m",
    "counts": "counts",
    "snr": "snr",
    "frame": "frame",
    "line": "line",
    "row": "pixel_row",
    "column": "pixel_column",
    "classification": "classification",
    "true_classification": "true_class",
    "substrate": "substrate",
    "cause": "cause",
}
"""Names in the file of the scalar columns of a cloud."""

STANDARD_COLUMNS = ("x", "y", "z", "time_s", "line", "classification")
"""What a copy without our own columns keeps."""

TRIPLES = {
    "position": "",
    "uncorrected": "uncorrected_",
    "truth": "true_",
    "true_surface": "true_surface_",
}
"""Prefixes in the file of the columns of a cloud that are places."""

NORMALS = {"true_normal": "true_normal_"}
"""And of those that are directions."""


def require_points(path: Path, count: int) -> None:
    """Raise `ProductError` if a cloud has no points."""
    if count == 0:
        raise ProductError(
            f"{path.name}: points: the cloud is empty. "
            "See the outcomes of the pixels for the reason (depth, water, gate or gaps)"
        )


def require_finite(path: Path, cloud: PointCloud, names: Sequence[str] = ("position",)) -> None:
    """Raise `ProductError` if places in some columns of a cloud are not finite."""
    for name in names:
        places = getattr(cloud, name)
        if np.isfinite(places).all():
            continue
        bad = np.flatnonzero(~np.isfinite(places).all(axis=1))[0]
        raise ProductError(
            f"{path.name}: point {bad}: {name.replace('_', ' ')} {places[bad].tolist()} is not "
            "finite. Leave such points out of the cloud"
        )


def write_ply(path: Path, cloud: PointCloud, map_frame: MapFrame) -> None:
    """Write a cloud as binary PLY in map coordinates, with all its columns, as float64.

    The map frame stands in the header's comments, so that `read_ply` needs nothing else.

    Parameters
    ----------
    path : Path
        File to write, replaced if it exists.
    cloud : PointCloud
        Points in the scene's local frame.
    map_frame : MapFrame
        Where that frame lies on the map.

    Raises
    ------
    ProductError
        If the cloud is empty or a position is not finite.
    ReadBackError
        If the file does not read back as written.
    """
    with ply_file(path, map_frame) as add:
        add(cloud)


@contextmanager
def ply_file(path: Path, map_frame: MapFrame) -> Iterator[Callable[[PointCloud], None]]:
    """Give a function that adds points to a PLY file; see `write_ply`."""
    count = checksum = 0
    with whole_file(path) as partial:
        with partial.open("wb") as file:
            file.write(_header(count, _comments(map_frame), PLY_RECORD))

            def add(cloud: PointCloud) -> None:
                nonlocal count, checksum
                require_finite(path, cloud)
                content = _records(cloud, map_frame).tobytes()
                file.write(content)
                count, checksum = count + len(cloud), crc32(content, checksum)

            yield add
            require_points(path, count)
            file.seek(0)
            file.write(_header(count, _comments(map_frame), PLY_RECORD))
        require_read_back(path, "points", _count_and_checksum(partial) == (count, checksum))


def copy_ply(source: Path, path: Path, *, standard_only: bool) -> None:
    """Write a PLY of ours anew, whole or with `STANDARD_COLUMNS` alone.

    Raises
    ------
    ProductError
        If the source is another kind of PLY, is cut short or has no points.
    ReadBackError
        If the file does not read back as written.
    """
    comments, records = _read(source)
    if len(records) == 0:
        raise ProductError(f"{source}: no points in the file. Run the mission again")
    if standard_only:
        records = _columns(records, STANDARD_COLUMNS)
    text = _header(len(records), comments, records.dtype)
    write_whole(path, text + records.tobytes())


def read_ply(path: Path) -> tuple[PointCloud, MapFrame]:
    """Read a cloud that `write_ply` wrote, in the local frame, and its map frame.

    Raises
    ------
    ProductError
        If the file is another kind of PLY or is cut short.
    """
    records, map_frame = read_records(path)
    places: dict[str, Any] = {
        name: map_frame.to_local(_triple(records, prefix)) for name, prefix in TRIPLES.items()
    }
    normals: dict[str, Any] = {name: _triple(records, prefix) for name, prefix in NORMALS.items()}
    scalars = {name: records[column].copy() for name, column in COLUMNS.items()}
    return PointCloud(**places, **normals, **scalars), map_frame


def read_records(path: Path) -> tuple[NDArray[np.void], MapFrame]:
    """Read the points of a PLY of ours as they stand in it, `PLY_RECORD`, and its map frame.

    Raises
    ------
    ProductError
        If the file is another kind of PLY or is cut short.
    """
    comments, records = _read(path)
    try:
        map_frame = MapFrame(
            easting=float(comments["origin_easting"]),
            northing=float(comments["origin_northing"]),
            epsg=int(comments["epsg"]),
            vertical_epsg=int(comments["vertical_epsg"]),
        )
    except KeyError as missing:
        raise ProductError(f"{path}: header: no comment {missing}. Use a bathyflash PLY") from None
    return records, map_frame


def _records(cloud: PointCloud, map_frame: MapFrame) -> NDArray[np.void]:
    records = np.zeros(len(cloud), dtype=PLY_RECORD)
    columns = cloud.columns()
    triples = {prefix: map_frame.to_map(columns[name]) for name, prefix in TRIPLES.items()}
    triples |= {prefix: columns[name] for name, prefix in NORMALS.items()}
    for prefix, triple in triples.items():
        for index, axis in enumerate("xyz"):
            records[f"{prefix}{axis}"] = triple[:, index]
    for name, column in COLUMNS.items():
        records[column] = columns[name]
    return records


def _columns(records: NDArray[np.void], names: Sequence[str]) -> NDArray[np.void]:
    """Return some columns alone, packed as PLY has them."""
    chosen = np.zeros(len(records), np.dtype([(name, records.dtype[name]) for name in names]))
    for name in names:
        chosen[name] = records[name]
    return chosen


def _triple(records: NDArray[np.void], prefix: str) -> NDArray[np.float64]:
    return np.stack([records[f"{prefix}{axis}"] for axis in "xyz"], axis=1)


def _comments(map_frame: MapFrame) -> dict[str, str]:
    return {
        "epsg": str(map_frame.epsg),
        "vertical_epsg": str(map_frame.vertical_epsg),
        "origin_easting": repr(map_frame.easting),
        "origin_northing": repr(map_frame.northing),
    }


def _header(count: int, comments: Mapping[str, str], columns: np.dtype[np.void]) -> bytes:
    """Return a header that is equally long for any count."""
    properties = (f"property {PLY_TYPES[columns[name].str]} {name}" for name in columns.names or ())
    lines = (
        "ply",
        "format binary_little_endian 1.0",
        *(f"comment {name} {text}" for name, text in comments.items()),
        "comment ".ljust(COUNT_DIGITS + len("comment ") - len(str(count)), "-"),
        f"element vertex {count}",
        *properties,
        "end_header",
    )
    return ("\n".join(lines) + "\n").encode("ascii")


def _count_and_checksum(path: Path) -> tuple[int, int]:
    checksum = 0
    with path.open("rb") as file:
        _, count = _read_header(path, file)
        while content := file.read(BYTES_AT_ONCE):
            checksum = crc32(content, checksum)
    return count, checksum


def _read(path: Path) -> tuple[dict[str, str], NDArray[np.void]]:
    with path.open("rb") as file:
        comments, _ = _read_header(path, file)
        return comments, np.fromfile(file, dtype=PLY_RECORD)


def _read_header(path: Path, file: BinaryIO) -> tuple[dict[str, str], int]:
    """Return comments and count, and leave the file at the first point."""
    text, mark, _ = file.read(HEADER_BYTES).partition(b"end_header\n")
    lines = [line.split() for line in text.decode("ascii", "replace").splitlines()]
    comments = {line[1]: line[2] for line in lines if line[:1] == ["comment"] and len(line) == 3}
    names = tuple(line[2] for line in lines if line[:1] == ["property"] and len(line) == 3)
    counts = [int(line[2]) for line in lines if line[:2] == ["element", "vertex"]]
    if not mark or names != PLY_RECORD.names or len(counts) != 1:
        raise ProductError(f"{path}: header: not that of a bathyflash PLY. Use bathyflash run")
    start = file.seek(len(text) + len(mark))
    points = (file.seek(0, SEEK_END) - start) / PLY_RECORD.itemsize
    if points != counts[0]:
        raise ProductError(
            f"{path}: points: {counts[0]} announced, {points:.1f} there. Write the file again"
        )
    file.seek(start)
    return comments, counts[0]

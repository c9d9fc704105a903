"""Point clouds as PLY files: every column, exact."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from survey.products.writing import ProductError, require_read_back, whole_file
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
PLY_TYPES = {"<f8": "double", "<f4": "float", "<u4": "uint", "<u2": "ushort", "|u1": "uchar"}
COLUMNS = {
    "true_elevation": "true_elevation",
    "water_path": "true_water_path",
    "tvu": "total_tvu",
    "thu": "total_thu",
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

TRIPLES = {
    "position": "",
    "uncorrected": "uncorrected_",
    "truth": "true_",
    "true_surface": "true_surface_",
}
"""Prefixes in the file of the columns of a cloud that are places."""

NORMALS = {"true_normal": "true_normal_"}
"""And of those that are directions."""


def require_points(path: Path, cloud: PointCloud) -> None:
    """Raise `ProductError` if a cloud has no points or a position that is not finite."""
    if len(cloud) == 0:
        raise ProductError(
            f"{path.name}: points: the cloud is empty. "
            "See the outcomes of the pixels for the reason (depth, water, gate or gaps)"
        )
    bad = np.flatnonzero(~np.isfinite(cloud.position).all(axis=1))
    if bad.size:
        raise ProductError(
            f"{path.name}: point {bad[0]}: position {cloud.position[bad[0]].tolist()} is not "
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
    require_points(path, cloud)
    records = _records(cloud, map_frame)
    with whole_file(path) as partial:
        with partial.open("wb") as file:
            file.write(_header(len(cloud), map_frame).encode("ascii"))
            records.tofile(file)
        require_read_back(path, "points", _read(partial)[1].tobytes() == records.tobytes())


def read_ply(path: Path) -> tuple[PointCloud, MapFrame]:
    """Read a cloud that `write_ply` wrote, in the local frame, and its map frame.

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
    places: dict[str, Any] = {
        name: map_frame.to_local(_triple(records, prefix)) for name, prefix in TRIPLES.items()
    }
    normals: dict[str, Any] = {name: _triple(records, prefix) for name, prefix in NORMALS.items()}
    scalars = {name: records[column].copy() for name, column in COLUMNS.items()}
    return PointCloud(**places, **normals, **scalars), map_frame


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


def _triple(records: NDArray[np.void], prefix: str) -> NDArray[np.float64]:
    return np.stack([records[f"{prefix}{axis}"] for axis in "xyz"], axis=1)


def _header(count: int, map_frame: MapFrame) -> str:
    properties = (
        f"property {PLY_TYPES[PLY_RECORD[name].str]} {name}" for name in PLY_RECORD.names or ()
    )
    lines = (
        "ply",
        "format binary_little_endian 1.0",
        f"comment epsg {map_frame.epsg}",
        f"comment vertical_epsg {map_frame.vertical_epsg}",
        f"comment origin_easting {map_frame.easting!r}",
        f"comment origin_northing {map_frame.northing!r}",
        f"element vertex {count}",
        *properties,
        "end_header",
    )
    return "\n".join(lines) + "\n"


def _read(path: Path) -> tuple[dict[str, str], NDArray[np.void]]:
    content = path.read_bytes()
    text, mark, body = content.partition(b"end_header\n")
    lines = [line.split() for line in text.decode("ascii", "replace").splitlines()]
    comments = {line[1]: line[2] for line in lines if line[:1] == ["comment"] and len(line) == 3}
    names = tuple(line[2] for line in lines if line[:1] == ["property"] and len(line) == 3)
    counts = [int(line[2]) for line in lines if line[:2] == ["element", "vertex"]]
    if not mark or names != PLY_RECORD.names or len(counts) != 1:
        raise ProductError(f"{path}: header: not that of a bathyflash PLY. Use bathyflash run")
    if len(body) != counts[0] * PLY_RECORD.itemsize:
        raise ProductError(
            f"{path}: points: {counts[0]} announced, {len(body) / PLY_RECORD.itemsize:.1f} there. "
            "Write the file again"
        )
    return comments, np.frombuffer(body, dtype=PLY_RECORD)

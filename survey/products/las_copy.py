"""LAS files made from a run's LAZ: the same points, with or without their extra bytes."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from survey.products.grids import SOLID_CLASSES
from survey.products.writing import ProductError, require_read_back, whole_file

if TYPE_CHECKING:
    import laspy

FloatArray = NDArray[np.float64]
CHUNK = 1_000_000


def open_points(path: Path) -> laspy.LasReader:
    """Open a LAS or LAZ file of ours that has points.

    Raises
    ------
    ProductError
        If the file cannot be read or is empty, as a killed writer may leave it.
    """
    import laspy
    import lazrs

    try:
        reader = laspy.open(str(path))
    except (laspy.errors.LaspyException, lazrs.LazrsError, ValueError) as fault:
        raise ProductError(f"{path}: no whole LAS file ({fault}). Run the mission again") from None
    if reader.header.point_count == 0:
        reader.close()
        raise ProductError(f"{path}: no points in the file. Run the mission again")
    return reader


def standard_points(las: laspy.LasData) -> laspy.LasData:
    """Return the points without their extra bytes: what a real survey's processor would hold."""
    names = list(las.point_format.extra_dimension_names)
    if names:
        las.remove_extra_dims(names)
    return las


def read_points(path: Path, *, standard_only: bool) -> laspy.LasData:
    """Read all points of a file of ours."""
    with open_points(path) as reader:
        las = reader.read()
    return standard_points(las) if standard_only else las


def solid_points(path: Path) -> tuple[FloatArray, FloatArray]:
    """Read places (n, 3) on the map and vertical uncertainties (n,) of seabed, objects and land.

    Raises
    ------
    ProductError
        If the file is not whole, has no points or tells no uncertainty.
    """
    places, uncertain = [np.zeros((0, 3))], [np.zeros(0)]
    with open_points(path) as reader:
        if "total_tvu" not in reader.header.point_format.extra_dimension_names:
            raise ProductError(f"{path}: no extra bytes 'total_tvu'. Use the run's own bottom.laz")
        for points in reader.chunk_iterator(CHUNK):
            solid = np.isin(points.classification, SOLID_CLASSES)
            axes = (np.asarray(axis)[solid] for axis in (points.x, points.y, points.z))
            places.append(np.stack(list(axes), axis=1))
            uncertain.append(np.asarray(points.total_tvu, dtype=np.float64)[solid])
    return np.concatenate(places), np.concatenate(uncertain)


def copy_las(source: Path, path: Path, *, standard_only: bool) -> None:
    """Write the points of a LAS or LAZ file as the other, a million at a time.

    Parameters
    ----------
    source : Path
        Of `survey.products.las_file.write_laz`.
    path : Path
        File to write, ending in ``.laz`` or ``.las``.
    standard_only : bool
        Leave out the extra bytes, the truth among them.

    Raises
    ------
    ProductError
        If the source is not whole or has no points.
    ReadBackError
        If the file does not read back as written.
    """
    import laspy

    with open_points(source) as reader, whole_file(path) as partial:
        header = deepcopy(reader.header)
        if standard_only:
            header.remove_extra_dims(list(header.point_format.extra_dimension_names))
        compressed = path.suffix == ".laz"
        with laspy.open(str(partial), mode="w", header=header, do_compress=compressed) as writer:
            for points in reader.chunk_iterator(CHUNK):
                writer.write_points(_chosen(points, header))
        require_read_back(path, "points", _alike(source, partial, header))


def _chosen(
    points: laspy.ScaleAwarePointRecord, header: laspy.LasHeader
) -> laspy.PackedPointRecord:
    """Return the points in the format of a header."""
    import laspy

    if points.point_format == header.point_format:
        return points
    chosen = laspy.ScaleAwarePointRecord.zeros(len(points), header=header)
    for name in header.point_format.dimension_names:
        chosen[name] = points[name]
    return chosen


def _alike(source: Path, copy: Path, header: laspy.LasHeader) -> bool:
    """Tell whether a copy holds the same points as its source, in the copy's format."""
    with open_points(source) as first, open_points(copy) as second:
        if first.header.point_count != second.header.point_count:
            return False
        pairs = zip(first.chunk_iterator(CHUNK), second.chunk_iterator(CHUNK), strict=True)
        return all(_chosen(a, header).array.tobytes() == b.array.tobytes() for a, b in pairs)

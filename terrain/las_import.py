"""A seabed from classified points of a LAS or LAZ file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS

from terrain.extent import HIGHEST
from terrain.file_faults import SeabedFileError, existing, frame_near, parsed, require_crs
from terrain.foreign.limits import limits_for_whole
from terrain.seabed import Seabed, uniform_seabed

FloatArray = NDArray[np.float64]


def from_las(
    path: str | Path,
    *,
    epsg: int,
    vertical_epsg: int,
    reflectance: float,
    classes: Sequence[int],
    cell: float,
    longest_edge: float | None = None,
    outline: FloatArray | None = None,
    margin: float = 0.0,
) -> Seabed:
    """Return the seabed through the points of some classes.

    One point stands for each square cell (mean place, median elevation); the points are joined by
    Delaunay triangles, of which those with a longer edge are left out, so that gaps stay gaps.

    Parameters
    ----------
    epsg, vertical_epsg : int
        The scenario's CRS and vertical datum; the first must be the file's.
    classes : sequence of int
        LAS classes that are seabed or ground.
    cell : float
        Side of the cells [m].
    longest_edge : float, optional
        Longest edge in plan of a triangle [m]; 4 cells without it.
    outline : array (corners, 2), optional
        Map coordinates; points beyond its bounding box, ``margin`` [m] wider, are left out.

    Raises
    ------
    FileNotFoundError
        When there is no such file.
    SeabedFileError
        When it is not readable, has another CRS, elevations that no ground has, or too few points
        of the classes.
    """
    path = existing(path)
    points = _read(path, epsg=epsg, classes=classes, outline=outline, margin=margin)
    if len(points) < 3:
        raise SeabedFileError(
            f"{path}: {len(points)} points of classes {_listed(classes)} where they are needed. "
            "choose other classes or another file"
        )
    beyond = np.flatnonzero(~(np.abs(points[:, 2]) <= HIGHEST))
    if beyond.size:
        raise SeabedFileError(
            f"{path}: {beyond.size} points beyond {HIGHEST:g} m of elevation, such as "
            f"{points[beyond[0], 2]:g}. leave them out or correct the scale"
        )
    middle = points[:, :2].mean(axis=0)
    frame = frame_near(
        east=float(middle[0]), north=float(middle[1]), epsg=epsg, vertical_epsg=vertical_epsg
    )
    thinned = _one_per_cell(frame.to_local(points), cell)
    vertices, faces = _triangles(thinned, 4.0 * cell if longest_edge is None else longest_edge)
    if len(faces) == 0:
        raise SeabedFileError(f"{path}: the points are too far apart for cells of {cell} m")
    import trimesh

    return uniform_seabed(
        trimesh.Trimesh(vertices, faces, process=False),
        reflectance=reflectance,
        map_frame=frame,
        source=f"Points of classes {_listed(classes)} of {path.name}, one in {cell:g} m cells.",
    )


def _listed(classes: Sequence[int]) -> str:
    return ", ".join(str(c) for c in classes)


def _read(
    path: Path, *, epsg: int, classes: Sequence[int], outline: FloatArray | None, margin: float
) -> FloatArray:
    """Return map coordinates (n, 3) of the wanted points."""
    box = None
    if outline is not None:
        box = [(outline.min(axis=0) - margin).tolist(), (outline.max(axis=0) + margin).tolist()]
    found = parsed(
        "terrain.foreign.las_reader:read_points",
        path,
        limits=limits_for_whole(path),
        classes=list(classes),
        box=box,
    )
    text = str(found["crs"])
    require_crs(CRS.from_wkt(text) if text else None, epsg=epsg, path=path)
    return found["points"]


def _one_per_cell(points: FloatArray, cell: float) -> FloatArray:
    """Return mean place and median elevation of the points in every cell."""
    keys = np.floor(points[:, :2] / cell).astype(np.int64)
    number = np.unique(keys, axis=0, return_inverse=True)[1].reshape(-1)
    order = np.lexsort((points[:, 2], number))
    count = np.bincount(number)
    first = np.cumsum(count) - count
    z = points[order, 2]
    median = 0.5 * (z[first + (count - 1) // 2] + z[first + count // 2])
    mean = [np.bincount(number, weights=points[:, i]) / count for i in range(2)]
    return np.column_stack([*mean, median])


def _triangles(points: FloatArray, longest: float) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return used points and faces of the Delaunay triangles with no longer edge in plan."""
    from scipy.spatial import Delaunay, QhullError

    try:
        faces = Delaunay(points[:, :2]).simplices.astype(np.int64)
    except (QhullError, ValueError):
        return points, np.empty((0, 3), dtype=np.int64)
    a, b, c = (points[faces[:, i], :2] for i in range(3))
    edges = np.stack([b - a, c - b, a - c])
    turn = (edges[0, :, 0] * -edges[2, :, 1]) - (edges[0, :, 1] * -edges[2, :, 0])
    short = (np.hypot(edges[..., 0], edges[..., 1]) <= longest).all(axis=0)
    faces = np.where(turn[:, None] < 0.0, faces[:, ::-1], faces)[short & (turn != 0.0)]
    used, faces = np.unique(faces, return_inverse=True)
    return points[used], faces.reshape(-1, 3)

"""A seabed or a body from a mesh file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from terrain.extent import FARTHEST, HIGHEST
from terrain.file_faults import SeabedFileError, existing, frame_near, parsed
from terrain.foreign.limits import limits_for_whole
from terrain.seabed import Seabed, uniform_seabed

if TYPE_CHECKING:
    import trimesh

FloatArray = NDArray[np.float64]

SHOWN = 5


def read_mesh(path: str | Path) -> trimesh.Trimesh:
    """Return the triangles of a mesh file as they are; faces without area are left out.

    Raises
    ------
    FileNotFoundError
        When there is no such file.
    SeabedFileError
        When it is not readable, has no faces, a vertex that is not finite or too far away, or a
        face that names a vertex there is not; one line a fault.
    """
    import trimesh

    path = existing(path)
    found = parsed(
        "terrain.foreign.mesh_reader:read_triangles", path, limits=limits_for_whole(path)
    )
    vertices, faces = found["vertices"], found["faces"]
    faults = _faults(vertices, faces)
    if faults:
        raise SeabedFileError("\n".join(f"{path}: {fault}" for fault in faults))
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return trimesh.Trimesh(vertices, faces[(normal != 0.0).any(axis=1)], process=False)


def _faults(vertices: FloatArray, faces: NDArray[np.int64]) -> list[str]:
    """Return what is wrong, the first few of each kind."""
    bad = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
    faults = [f"vertex {i}: a coordinate is not a finite number" for i in bad[:SHOWN]]
    faults += _beyond(vertices, (FARTHEST, FARTHEST, FARTHEST))
    outside = (faces < 0) | (faces >= len(vertices))
    for face in np.flatnonzero(outside.any(axis=1))[:SHOWN]:
        index = faces[face][outside[face]][0]
        faults.append(f"face {face}: index {index}, but there are {len(vertices)} vertices")
    return faults


def _beyond(vertices: FloatArray, limits: tuple[float, float, float]) -> list[str]:
    """Return the first vertices (n, 3) that lie beyond limits [m] along x, y, z."""
    beyond = np.isfinite(vertices) & (np.abs(vertices) > limits)
    return [
        f"vertex {i}: {'xyz'[axis]} is {vertices[i, axis]:g} m, beyond {limits[axis]:g}. "
        "give metres, and what is on the map in offset_easting_m, _northing_m and _up_m"
        for i, axis in np.argwhere(beyond)[:SHOWN]
    ]


def from_mesh_file(
    path: str | Path,
    *,
    epsg: int,
    vertical_epsg: int,
    reflectance: float,
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Seabed:
    """Return the seabed of a mesh file whose vertices, plus ``offset`` [m], are map coordinates.

    A mesh file names no CRS: the scenario's is taken. A file in single precision should hold small
    coordinates and an offset, or it is 0.25 m off at the coordinates of a map.

    Raises
    ------
    FileNotFoundError, SeabedFileError
        As read_mesh, and when a vertex lies where there is no ground or no face has an area.
    """
    mesh = read_mesh(path)
    faults = _beyond(mesh.vertices + offset, (FARTHEST, FARTHEST, HIGHEST))
    if faults:
        raise SeabedFileError("\n".join(f"{path}: {fault}" for fault in faults))
    middle = mesh.bounds.mean(axis=0) + offset
    frame = frame_near(
        east=float(middle[0]), north=float(middle[1]), epsg=epsg, vertical_epsg=vertical_epsg
    )
    mesh.apply_translation(np.asarray(offset) - frame.origin)
    try:
        return uniform_seabed(
            mesh,
            reflectance=reflectance,
            map_frame=frame,
            source=f"Mesh file {Path(path).name}.",
        )
    except ValueError as fault:
        raise SeabedFileError(f"{path}: {fault}") from fault

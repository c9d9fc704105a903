"""Triangles of a mesh file, read in the child."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from terrain.foreign.faults import ReaderError, readable
from terrain.foreign.mesh_text import require_whole_text


def read_triangles(path: str) -> dict[str, Any]:
    """Return ``vertices`` (n, 3) and ``faces`` (m, 3) of a mesh file, unchecked.

    Raises
    ------
    ReaderError
        When it is no readable file, or one with rows that would be left out.
    """
    import trimesh

    require_whole_text(Path(path))
    with readable("mesh file"):
        mesh = trimesh.load_mesh(path, process=False)
    vertices = np.asarray(getattr(mesh, "vertices", np.empty((0, 3))), dtype=np.float64)
    faces = np.asarray(getattr(mesh, "faces", np.empty((0, 3))), dtype=np.int64)
    if faces.size == 0:
        raise ReaderError("no faces could be read. it may be cut short, or a cloud of points")
    if vertices.shape[1:] != (3,) or faces.shape[1:] != (3,):
        raise ReaderError("not a readable mesh file. vertices need three coordinates, x, y, z")
    return {"vertices": vertices, "faces": faces}

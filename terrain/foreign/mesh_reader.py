"""Triangles of a mesh file, read in the child."""

from __future__ import annotations

from typing import Any

import numpy as np

from terrain.foreign.faults import readable


def read_triangles(path: str) -> dict[str, Any]:
    """Return ``vertices`` (n, 3) and ``faces`` (m, 3) of a mesh file, unchecked.

    Raises
    ------
    ReaderError
        When it is no readable file.
    """
    import trimesh

    with readable("mesh file"):
        mesh = trimesh.load_mesh(path, process=False)
    return {
        "vertices": np.asarray(getattr(mesh, "vertices", np.empty((0, 3))), dtype=np.float64),
        "faces": np.asarray(getattr(mesh, "faces", np.empty((0, 3))), dtype=np.int64),
    }

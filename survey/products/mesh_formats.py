"""The gridded bathymetry as a mesh for other programs: PLY, OBJ, STL."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.products.grids import ElevationGrid
from survey.products.json_file import write_json
from survey.products.mesh_files import grid_mesh, place_on_map
from survey.products.writing import require_read_back, whole_file
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]
TOLERANCE = 1e-4
"""OBJ has eight decimals; PLY and STL keep float32, 0.03 mm at 500 m from the origin."""


def write_bathymetry_mesh(
    path: Path, grid: ElevationGrid, map_frame: MapFrame, *, water_level: float
) -> None:
    """Write the grid as a mesh, x east, y north, z up, in metres from an origin on the map.

    Such files keep float32 or know no CRS, hence local coordinates: add the origin, which stands
    in ``<name>.offset.json`` beside the mesh. PLY and OBJ are coloured by depth, STL has no colour.

    Parameters
    ----------
    path : Path
        File to write, ending in ``.ply``, ``.obj`` or ``.stl``.
    grid : ElevationGrid
    map_frame : MapFrame
        Where the local frame lies on the map.
    water_level : float
        For the colours [m].

    Raises
    ------
    ProductError
        If no three neighbouring cells are filled.
    ReadBackError
        If the file does not read back as written.
    """
    import trimesh

    mesh = grid_mesh(grid, map_frame, water_level=water_level)
    content = _WRITERS[path.suffix](mesh)
    with whole_file(path) as partial:
        partial.write_bytes(content)
        again: Any = trimesh.load_mesh(str(partial), process=False)
        require_read_back(path, "triangles", _same_triangles(again.triangles, mesh.triangles))
    beside = place_on_map(map_frame, water_level) | {"axes": "x east, y north, z up; metres"}
    write_json(path.with_name(f"{path.stem}.offset.json"), beside)


def _same_triangles(found: FloatArray, written: FloatArray) -> bool:
    return found.shape == written.shape and bool(np.abs(found - written).max() <= TOLERANCE)


def _ply(mesh: Any) -> bytes:
    return bytes(mesh.export(file_type="ply"))


def _obj(mesh: Any) -> bytes:
    return str(mesh.export(file_type="obj", header="bathyflash simulation, local metres")).encode()


def _stl(mesh: Any) -> bytes:
    return bytes(mesh.export(file_type="stl"))


_WRITERS: dict[str, Callable[[Any], bytes]] = {".ply": _ply, ".obj": _obj, ".stl": _stl}

"""The gridded bathymetry as a coloured mesh: GLB."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.products.depth_colours import depth_colours
from survey.products.grids import ElevationMap
from survey.products.writing import ProductError, require_read_back, whole_file
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    import trimesh

FloatArray = NDArray[np.float64]


def grid_surface(grid: ElevationMap, map_frame: MapFrame) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return vertices (n, 3) in the local frame and triangles (m, 3) between filled cells.

    Vertices are the centres of the filled cells. Four filled neighbours make two triangles,
    three make one; triangles count counter-clockwise seen from above.

    Raises
    ------
    ProductError
        If no three neighbouring cells are filled.
    """
    filled = np.isfinite(grid.elevation)
    square = _squares(filled)
    known = (square >= 0).sum(axis=1)
    whole = square[known == 4]
    three = square[known == 3]
    three = three[three >= 0].reshape(-1, 3)
    faces = np.concatenate([whole[:, [0, 1, 2]], whole[:, [0, 2, 3]], three]).astype(np.int64)
    if faces.shape[0] == 0:
        raise ProductError(
            f"mesh: no three neighbouring cells of {grid.cells.cell_size:g} m hold points. "
            "Use larger cells"
        )
    centres = grid.cells.centres()[filled]
    on_map = np.column_stack([centres, grid.elevation[filled]])
    return map_frame.to_local(on_map), faces


def grid_mesh(grid: ElevationMap, map_frame: MapFrame, *, water_level: float) -> trimesh.Trimesh:
    """Return the grid as a mesh coloured by depth, in the local frame, z up [m].

    Raises
    ------
    ProductError
        If no three neighbouring cells are filled.
    """
    import trimesh

    vertices, faces = grid_surface(grid, map_frame)
    colours = depth_colours(water_level - vertices[:, 2])
    return trimesh.Trimesh(vertices, faces, vertex_colors=colours, process=False)


def has_triangles(grid: ElevationMap) -> bool:
    """Tell whether any three neighbouring cells are filled."""
    return bool(((_squares(np.isfinite(grid.elevation)) >= 0).sum(axis=1) >= 3).any())


def _squares(filled: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return each four neighbouring cells by their place among the filled ones, -1 if empty."""
    number = np.where(filled, np.cumsum(filled).reshape(filled.shape) - 1, -1)
    corners = [number[1:, :-1], number[1:, 1:], number[:-1, 1:], number[:-1, :-1]]
    return np.stack(corners, axis=-1).reshape(-1, 4)


def write_bathymetry_glb(
    path: Path, grid: ElevationMap, map_frame: MapFrame, *, water_level: float
) -> None:
    """Write the grid as a mesh coloured by depth, in metres, y up as glTF has it.

    glTF keeps float32, hence local coordinates: x is east, y up, z south. The extras of the
    scene hold the origin and the CRS: easting = origin_easting + x, northing = origin_northing
    - z, elevation = y.

    Raises
    ------
    ProductError
        If no three neighbouring cells are filled.
    ReadBackError
        If the file does not read back as written.
    """
    import trimesh

    vertices, faces = grid_surface(grid, map_frame)
    mesh = trimesh.Trimesh(
        vertices=vertices[:, [0, 2, 1]] * [1.0, 1.0, -1.0],
        faces=faces,
        vertex_colors=depth_colours(water_level - vertices[:, 2]),
        process=False,
    )
    scene: Any = trimesh.Scene()
    scene.add_geometry(mesh, geom_name="bathymetry", node_name="bathymetry")
    scene.metadata.update(place_on_map(map_frame, water_level))
    content = scene.export(file_type="glb")
    with whole_file(path) as partial:
        partial.write_bytes(content)
        again = trimesh.load_scene(BytesIO(partial.read_bytes()), file_type="glb")
        same = np.array_equal(again.triangles, mesh.triangles.astype(np.float32))
        require_read_back(path, "triangles", same)


def place_on_map(map_frame: MapFrame, water_level: float) -> dict[str, float | int | str]:
    """Return what turns a mesh's coordinates into those of the map, as plain values."""
    return {
        "axes": "x east, y up, z south; metres",
        "origin_easting": map_frame.easting,
        "origin_northing": map_frame.northing,
        "epsg": map_frame.epsg,
        "vertical_epsg": map_frame.vertical_epsg,
        "water_level_m": water_level,
    }

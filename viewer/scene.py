"""From clouds and flight lines to pyvista data sets; no window here.

All coordinates are local metres, with heights above the water level stretched by an exaggeration:
z = level + exaggeration x (height - level).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from survey.products.grids import SOLID_CLASSES, grid_elevation
from survey.products.mesh_files import grid_surface
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    import pyvista
    import trimesh

FloatArray = NDArray[np.float64]
DEPTH = "depth below water level [m]"
CELLS_PER_SPACING = 1.7
NEIGHBOURS = 4
MOST_NODES = 40_000
SMOOTHING_STEPS = 60
SMOOTHING_PASS_BAND = 0.01


def stretched(places: FloatArray, *, water_level: float, exaggeration: float) -> FloatArray:
    """Return places (n, 3) with their heights above the water level multiplied [m].

    Examples
    --------
    >>> stretched(np.array([[1.0, 2.0, -3.0]]), water_level=1.0, exaggeration=5.0)
    array([[  1.,   2., -19.]])
    """
    height = places[:, 2] - water_level
    return np.column_stack([places[:, :2], water_level + exaggeration * height])


def solid_positions(cloud: PointCloud) -> FloatArray:
    """Return the places (n, 3) of seabed, objects and dry ground [m]."""
    return np.asarray(cloud.position[np.isin(cloud.classification, SOLID_CLASSES)])


def median_spacing(places: FloatArray) -> float:
    """Return the median distance of places (n, 2) to their fourth neighbours [m]; 1 if n < 5.

    Examples
    --------
    >>> grid = np.stack(np.meshgrid(np.arange(9.0), np.arange(9.0)), axis=-1)
    >>> median_spacing(0.5 * grid.reshape(-1, 2))
    0.5
    """
    from scipy.spatial import cKDTree

    if len(places) <= NEIGHBOURS:
        return 1.0
    distances, _ = cKDTree(places).query(places, k=[NEIGHBOURS + 1])
    return max(float(np.median(distances)), 1e-3)


def bottom_points(
    cloud: PointCloud, *, water_level: float, exaggeration: float
) -> pyvista.PolyData:
    """Return the points of seabed, objects and ground with their depth; land is negative."""
    solid = solid_positions(cloud)
    return _with_depth(_points(solid, water_level, exaggeration), solid, water_level)


def bottom_surface(
    cloud: PointCloud,
    map_frame: MapFrame,
    *,
    water_level: float,
    exaggeration: float,
    cell_size: float | None = None,
) -> pyvista.PolyData:
    """Return the gridded bottom as a mesh with its depth.

    Unless a cell size is given [m], it is 1.7 times the median distance of a point to its fourth
    neighbour, so that nearly all cells of a surveyed place hold a point and gaps stay gaps.

    Raises
    ------
    ProductError
        If there is no such point or no mesh can be made of them.
    """
    if cell_size is None:
        cell_size = CELLS_PER_SPACING * median_spacing(solid_positions(cloud)[:, :2])
    grid = grid_elevation(cloud, map_frame, cell_size=cell_size)
    vertices, faces = grid_surface(grid, map_frame)
    return _mesh(vertices, faces, water_level, exaggeration)


def depth_contours(
    bottom: pyvista.PolyData, *, step: float, water_level: float, exaggeration: float
) -> pyvista.PolyData:
    """Return smooth lines of equal depth of a mesh with depths, every so many metres from 0 down.

    Depths are averaged over neighbours first (Taubin), or lines would trace the noise of level
    ground; the lines lie on the averaged surface.
    """
    import pyvista

    smooth = bottom.smooth_taubin(n_iter=SMOOTHING_STEPS, pass_band=SMOOTHING_PASS_BAND)
    smooth[DEPTH] = (water_level - np.asarray(smooth.points)[:, 2]) / exaggeration
    depths = np.arange(0.0, max(float(smooth[DEPTH].max()), step), step)
    return pyvista.PolyData(smooth.contour(depths.tolist(), scalars=DEPTH))


def true_seabed(
    mesh: trimesh.Trimesh, *, water_level: float, exaggeration: float
) -> pyvista.PolyData:
    """Return the true seabed as a mesh with its depth."""
    return _mesh(np.asarray(mesh.vertices), np.asarray(mesh.faces), water_level, exaggeration)


def surface_points(
    cloud: PointCloud, *, water_level: float, exaggeration: float, at_most: int
) -> pyvista.PolyData:
    """Return at most so many points of the sea surface, drawn by lot: a stride shows patterns."""
    lot = np.random.default_rng(0).permutation(len(cloud))[:at_most]
    return _points(cloud.position[np.sort(lot)], water_level, exaggeration)


def flight_lines(positions: FloatArray, line: NDArray[np.intp]) -> pyvista.PolyData:
    """Return one polyline a survey line through the sensor's places (frames, 3), true to scale."""
    import pyvista

    members = [np.flatnonzero(line == number) for number in np.unique(line)]
    cells = np.concatenate([np.append(member.size, member) for member in members])
    return pyvista.PolyData(positions, lines=cells)


def footprint(cloud: PointCloud, frame: int) -> FloatArray:
    """Return where the outermost pixels of a frame see (4, 3) [m, local], in ring order.

    Empty, (0, 3), when the cloud has no point of the frame.
    """
    of_frame = cloud.frame == frame
    if not of_frame.any():
        return np.zeros((0, 3))
    corners = outermost(cloud.row[of_frame], cloud.column[of_frame])
    return np.asarray(cloud.position[of_frame][corners])


def outermost(row: NDArray[np.uint16], column: NDArray[np.uint16]) -> NDArray[np.intp]:
    """Return which of some pixels (n,) lie nearest the corners of the camera, in ring order.

    Examples
    --------
    >>> outermost(np.array([0, 0, 1, 1], np.uint16), np.array([0, 1, 0, 1], np.uint16))
    array([0, 1, 3, 2])
    """
    down, right = row.astype(np.int64), column.astype(np.int64)
    sides = (-down - right, right - down, down + right, down - right)
    return np.array([np.argmax(side) for side in sides])


def outlines(corners: FloatArray) -> pyvista.PolyData:
    """Return the closed outlines of footprints (n, 4, 3)."""
    import pyvista

    rings = np.arange(4 * len(corners)).reshape(-1, 4)
    cells = np.column_stack([np.full(len(rings), 5), rings, rings[:, 0]])
    return pyvista.PolyData(corners.reshape(-1, 3), lines=cells.ravel())


def light_cone(sensor: FloatArray, corners: FloatArray) -> pyvista.PolyData:
    """Return the pyramid from the sensor (3,) to the corners (4, 3) of a footprint."""
    import pyvista

    sides = [[3, 0, number, number % 4 + 1] for number in range(1, 5)]
    return pyvista.PolyData(np.vstack([sensor, corners]), faces=np.concatenate(sides))


def aircraft(sensor: FloatArray, heading: float, *, length: float) -> pyvista.PolyData:
    """Return a small aeroplane at (3,), its nose along the heading [rad], so many metres long."""
    import pyvista

    forward = np.array([np.sin(heading), np.cos(heading), 0.0])
    right = np.array([forward[1], -forward[0], 0.0])
    outline = np.array(
        [
            *([0.5, 0.0], [0.22, 0.05], [-0.08, 0.6], [-0.2, 0.6], [-0.06, 0.05]),
            *([-0.38, 0.04], [-0.5, 0.22], [-0.56, 0.22], [-0.5, 0.0]),
        ]
    )
    left = outline[-2:0:-1] * [1.0, -1.0]
    flat = np.vstack([outline, left])
    places = sensor + length * (flat[:, :1] * forward + flat[:, 1:] * right)
    face = np.append(len(places), np.arange(len(places)))
    return pyvista.PolyData(pyvista.PolyData(places, faces=face).triangulate())


def sea_sheet(cloud: PointCloud, *, water_level: float) -> pyvista.PolyData:
    """Return the level polygon that the points of the sea surface span; empty below three."""
    import pyvista
    from scipy.spatial import ConvexHull

    if len(cloud) < 3:
        return pyvista.PolyData()
    hull = cloud.position[ConvexHull(cloud.position[:, :2]).vertices]
    places = np.column_stack([hull[:, :2], np.full(len(hull), water_level)])
    return pyvista.PolyData(places, faces=np.append(len(hull), np.arange(len(hull))))


def cell_for(extent: FloatArray) -> float:
    """Return the cell, a multiple of 0.5 m, with which a grid has at most 40,000 nodes or so.

    Examples
    --------
    >>> cell_for(np.array([800.0, 200.0])), cell_for(np.array([3.0, 1.0]))
    (2.0, 0.5)
    """
    width, height = np.maximum(extent, 1.0)
    return float(max(np.ceil(2.0 * np.sqrt(width * height / MOST_NODES)) / 2.0, 0.5))


def _points(places: FloatArray, water_level: float, exaggeration: float) -> pyvista.PolyData:
    import pyvista

    return pyvista.PolyData(stretched(places, water_level=water_level, exaggeration=exaggeration))


def _mesh(
    vertices: FloatArray, faces: NDArray[np.int64], water_level: float, exaggeration: float
) -> pyvista.PolyData:
    import pyvista

    places = stretched(vertices, water_level=water_level, exaggeration=exaggeration)
    regular: NDArray[Any] = faces
    mesh = pyvista.PolyData.from_regular_faces(places, regular)
    return _with_depth(mesh, vertices, water_level)


def _with_depth(data: pyvista.PolyData, places: FloatArray, water_level: float) -> pyvista.PolyData:
    data[DEPTH] = water_level - places[:, 2]
    return data

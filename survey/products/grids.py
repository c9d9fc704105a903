"""Gridded bathymetry."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud
from survey.products.cells import CellGrid
from survey.products.writing import ProductError
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]
SOLID_CLASSES = (PointClass.GROUND, PointClass.BATHYMETRIC, PointClass.SUBMERGED_OBJECT)
BANDS = (
    ("elevation", "m"),
    ("density", "1/m2"),
    ("standard_deviation", "m"),
    ("uncertainty_95", "m"),
)
MOST_OVERVIEW_CELLS = 500_000


@dataclass(frozen=True, kw_only=True)
class ElevationMap:
    """Seabed and land by cells, row 0 in the north.

    Parameters
    ----------
    cells : CellGrid
        Where the cells lie on the map.
    elevation : array (rows, columns)
        Median elevation of the points in a cell [m], nan where there is none.
    """

    cells: CellGrid
    elevation: FloatArray


@dataclass(frozen=True, kw_only=True)
class ElevationGrid(ElevationMap):
    """The same with what the points in the cells tell beside.

    Parameters
    ----------
    density : array (rows, columns)
        Points a square metre [1/m2].
    deviation : array (rows, columns)
        Standard deviation of their elevations, n - 1 [m], nan below two points.
    uncertainty : array (rows, columns)
        Root mean square of their total vertical uncertainties, 95 % [m]: not smaller for many
        points, since those of a flash err together; nan where none is known.
    """

    density: FloatArray
    deviation: FloatArray
    uncertainty: FloatArray

    def bands(self) -> NDArray[np.float32]:
        """Return what stands in files (4, rows, columns), in the order of `BANDS`."""
        bands = (self.elevation, self.density, self.deviation, self.uncertainty)
        return np.stack(bands).astype(np.float32)


def grid_elevation(cloud: PointCloud, map_frame: MapFrame, *, cell_size: float) -> ElevationGrid:
    """Grid the points of seabed, objects and dry ground (classes 40, 43 and 2).

    Parameters
    ----------
    cloud : PointCloud
        Bottom cloud in the scene's local frame.
    map_frame : MapFrame
        Where that frame lies on the map.
    cell_size : float
        Side of a cell [m].

    Raises
    ------
    ProductError
        If the cloud has no such point, or the raster would be too large.
    """
    on_map, tvu = solid_places(cloud, map_frame), solid_tvu(cloud)
    if on_map.shape[0] == 0:
        raise ProductError(
            f"grid: none of the {len(cloud)} points is seabed, object or ground. "
            "See the outcomes of the pixels for why"
        )
    return gridded(on_map, CellGrid.covering(on_map, cell_size=cell_size), tvu)


def solid_places(cloud: PointCloud, map_frame: MapFrame) -> FloatArray:
    """Return the points of seabed, objects and dry ground (n, 3) [m, map]."""
    return map_frame.to_map(cloud.position[np.isin(cloud.classification, SOLID_CLASSES)])


def solid_tvu(cloud: PointCloud) -> FloatArray:
    """Return the vertical uncertainties of these points (n,) [m]."""
    return cloud.tvu[np.isin(cloud.classification, SOLID_CLASSES)].astype(np.float64)


def error_places(
    cloud: PointCloud, map_frame: MapFrame, cells: CellGrid
) -> tuple[FloatArray, CellGrid, FloatArray]:
    """Return what `gridded` needs for a map of errors, which stand in the place of elevations."""
    solid = np.isin(cloud.classification, SOLID_CLASSES) & np.isfinite(cloud.true_elevation)
    chosen = np.flatnonzero(solid)
    position = cloud.position.take(chosen, axis=0)
    places = map_frame.to_map(position)
    places[:, 2] = position[:, 2] - cloud.true_elevation[chosen]
    return places, cells, cloud.tvu[chosen].astype(np.float64)


def gridded(on_map: FloatArray, cells: CellGrid, tvu: FloatArray) -> ElevationGrid:
    """Return places (n, 3), all inside, with their uncertainties (n,) by cells [m, map]."""
    index, z = cells.index_of(on_map), on_map[:, 2]
    order = _by_cell_and_height(index, z)
    first = np.flatnonzero(np.diff(index[order], prepend=-1))
    filled, count = index[order[first]], np.diff(first, append=len(order))
    owner = np.empty_like(order)
    owner[order] = np.repeat(np.arange(len(filled)), count)
    median, deviation = _cell_statistics(z[order], first, count)

    def spread(values: FloatArray, empty: float) -> FloatArray:
        everywhere = np.full(cells.shape, empty)
        everywhere.ravel()[filled] = values
        return everywhere

    return ElevationGrid(
        cells=cells,
        elevation=spread(median, np.nan),
        density=spread(count / cells.cell_size**2, 0.0),
        deviation=spread(deviation, np.nan),
        uncertainty=spread(_root_mean_square(tvu, owner, len(filled)), np.nan),
    )


def _by_cell_and_height(index: NDArray[np.intp], z: FloatArray) -> NDArray[np.intp]:
    """Return the order of `np.lexsort`, which takes three times as long.

    Numpy sorts numbers of 16 bits by counting.
    """
    order = np.argsort(z)
    for shift in (0, 16):
        digits = (index >> shift).astype(np.uint16)
        order = order[np.argsort(digits[order], kind="stable")]
    return order


def _root_mean_square(values: FloatArray, owner: NDArray[np.intp], size: int) -> FloatArray:
    """Return it by owner (size,), nan where none has a value."""
    known = np.isfinite(values)
    count = np.bincount(owner[known], minlength=size)
    squares = np.bincount(owner[known], values[known] ** 2, size)
    mean = np.divide(squares, count, out=np.full(size, np.nan), where=count > 0)
    return np.asarray(np.sqrt(mean))


class Overview:
    """A grid of half a million cells at most, for pictures and meshes, from parts of a larger one.

    So many cells are taken together as are needed; of several the mean of the medians is taken.
    """

    def __init__(self, cells: CellGrid) -> None:
        factor = int(np.ceil(np.sqrt(cells.rows * cells.columns / MOST_OVERVIEW_CELLS)))
        self._fine, self._factor = cells, factor
        self._cells = replace(
            cells,
            cell_size=cells.cell_size * factor,
            rows=-(-cells.rows // factor),
            columns=-(-cells.columns // factor),
        )
        self._sum, self._count = np.zeros((2, *self._cells.shape))

    def add(self, grid: ElevationGrid) -> None:
        """Add a part; what lies outside is left out."""
        rows, columns = self._fine.window(grid.cells)
        elevation = grid.elevation[grid.cells.window(self._fine)]
        row, column = np.nonzero(np.isfinite(elevation))
        place = (rows.start + row) // self._factor, (columns.start + column) // self._factor
        np.add.at(self._sum, place, elevation[row, column])
        np.add.at(self._count, place, 1.0)

    def map(self) -> ElevationMap:
        """Return it."""
        empty = self._count == 0.0
        elevation = np.where(empty, np.nan, self._sum / np.where(empty, 1.0, self._count))
        return ElevationMap(cells=self._cells, elevation=elevation)


def _cell_statistics(
    z: FloatArray, first: NDArray[np.intp], count: NDArray[np.intp]
) -> tuple[FloatArray, FloatArray]:
    """Return median and deviation of elevations sorted by cell and, within it, by height."""
    median = 0.5 * (z[first + (count - 1) // 2] + z[first + count // 2])
    from_median = z - np.repeat(median, count)
    owner = np.repeat(np.arange(count.size), count)
    total = np.bincount(owner, from_median, count.size)
    squares = np.bincount(owner, from_median**2, count.size)
    several = count > 1
    deviation = np.full(count.size, np.nan)
    variance = (squares[several] - total[several] ** 2 / count[several]) / (count[several] - 1)
    deviation[several] = np.sqrt(np.maximum(variance, 0.0))
    return median, deviation

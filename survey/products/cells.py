"""Square cells on the map, shared by grids and coverage."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from survey.products.writing import ProductError

if TYPE_CHECKING:
    from affine import Affine

FloatArray = NDArray[np.float64]
MAX_CELLS = 100_000_000


@dataclass(frozen=True, kw_only=True)
class CellGrid:
    """A north-up raster whose edges are whole multiples of the cell size; row 0 is in the north.

    Parameters
    ----------
    west, north : float
        Outer corner on the map [m].
    cell_size : float
        Side of a cell [m].
    rows, columns : int
        Number of cells southward and eastward.

    Examples
    --------
    >>> cells = CellGrid.covering(np.array([[500001.0, 11.0], [500007.0, 19.0]]), cell_size=4.0)
    >>> cells.west, cells.north, cells.shape
    (500000.0, 20.0, (3, 2))
    >>> cells.index_of(np.array([[500001.0, 19.0], [500007.0, 8.5]]))
    array([0, 5])
    """

    west: float
    north: float
    cell_size: float
    rows: int
    columns: int

    @classmethod
    def covering(cls, on_map: FloatArray, *, cell_size: float) -> CellGrid:
        """Return the smallest such raster that holds the places (n, 2 or 3) [m].

        Raises
        ------
        ProductError
            If there are no places or the raster would have more than 1e8 cells.
        """
        if on_map.shape[0] == 0:
            raise ProductError("grid: no points to grid. See the outcomes of the pixels for why")
        west, south = np.floor(on_map[:, :2].min(axis=0) / cell_size)
        east, north = np.floor(on_map[:, :2].max(axis=0) / cell_size) + 1
        if not (north - south) * (east - west) <= MAX_CELLS:
            raise ProductError(
                f"grid: {north - south:.0f} x {east - west:.0f} cells. Use larger cells than "
                f"{cell_size:g} m, or leave out points that lie far off"
            )
        return cls(
            west=float(west * cell_size),
            north=float(north * cell_size),
            cell_size=cell_size,
            rows=int(north - south),
            columns=int(east - west),
        )

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.rows, self.columns

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """West, east, south, north [m]."""
        east = self.west + self.columns * self.cell_size
        south = self.north - self.rows * self.cell_size
        return self.west, east, south, self.north

    @property
    def transform(self) -> Affine:
        """From (column, row) to the map, as rasterio has it."""
        from affine import Affine

        return Affine(self.cell_size, 0.0, self.west, 0.0, -self.cell_size, self.north)

    def window(self, other: CellGrid) -> tuple[slice, slice]:
        """Return rows and columns of these cells that lie in another part of the same lattice."""
        row = round((self.north - other.north) / self.cell_size)
        column = round((other.west - self.west) / self.cell_size)
        rows = slice(max(row, 0), max(min(row + other.rows, self.rows), 0))
        return rows, slice(max(column, 0), max(min(column + other.columns, self.columns), 0))

    def window_over(self, on_map: FloatArray, *, margin: float) -> tuple[slice, slice]:
        """Return rows and columns of the cells around places (n, 2), with a margin [m].

        Examples
        --------
        >>> cells = CellGrid(west=0.0, north=40.0, cell_size=4.0, rows=10, columns=10)
        >>> cells.window_over(np.array([[-8.0, 21.0], [3.0, 27.0]]), margin=2.0)
        (slice(2, 6, None), slice(0, 2, None))
        """
        west, south = on_map.min(axis=0) - margin
        east, north = on_map.max(axis=0) + margin
        rows = np.array([self.north - north, self.north - south]) / self.cell_size
        columns = np.array([west - self.west, east - self.west]) / self.cell_size
        return _whole(rows, self.rows), _whole(columns, self.columns)

    def part(self, window: tuple[slice, slice]) -> CellGrid:
        """Return the cells of a window as a raster of its own."""
        rows, columns = window
        return replace(
            self,
            west=self.west + columns.start * self.cell_size,
            north=self.north - rows.start * self.cell_size,
            rows=max(rows.stop - rows.start, 0),
            columns=max(columns.stop - columns.start, 0),
        )

    def index_of(self, on_map: FloatArray) -> NDArray[np.intp]:
        """Return the flat index, row by row, of the cell of each place inside (n,)."""
        column = np.floor((on_map[:, 0] - self.west) / self.cell_size).astype(np.intp)
        up = np.floor((on_map[:, 1] - self.extent[2]) / self.cell_size).astype(np.intp)
        column, up = np.clip(column, 0, self.columns - 1), np.clip(up, 0, self.rows - 1)
        return np.asarray((self.rows - 1 - up) * self.columns + column)

    def contains(self, on_map: FloatArray) -> NDArray[np.bool_]:
        """Return which of the places (n, 2 or 3) lie inside (n,)."""
        west, east, south, north = self.extent
        x, y = on_map[:, 0], on_map[:, 1]
        return np.asarray((x >= west) & (x < east) & (y >= south) & (y < north))

    def centres(self) -> FloatArray:
        """Return the map coordinates of the cells' centres (rows, columns, 2) [m]."""
        x = self.west + (np.arange(self.columns) + 0.5) * self.cell_size
        y = self.north - (np.arange(self.rows) + 0.5) * self.cell_size
        return np.stack(np.meshgrid(x, y), axis=-1)

    def centres_of(self, index: NDArray[np.intp]) -> FloatArray:
        """Return the centres of the cells that flat indices name (n, 2) [m]."""
        return self.centres_at(*np.divmod(index, self.columns))

    def centres_at(self, row: NDArray[np.intp], column: NDArray[np.intp]) -> FloatArray:
        """Return the centres of cells by rows and columns (n, 2) [m]."""
        x = self.west + (column + 0.5) * self.cell_size
        return np.stack([x, self.north - (row + 0.5) * self.cell_size], axis=-1)


def _whole(edges: FloatArray, number: int) -> slice:
    """Return the cells that lie between two edges, in whole or in part."""
    first, last = np.clip([np.floor(edges[0]), np.ceil(edges[1])], 0, number)
    return slice(int(first), int(last))


def inside_ring(cells: CellGrid, ring: FloatArray) -> NDArray[np.bool_]:
    """Return the cells (rows, columns) whose centre lies in the ring of corners (n, 2) [m]."""
    from rasterio.features import geometry_mask

    corners = [*ring.tolist(), ring[0].tolist()]
    polygon = {"type": "Polygon", "coordinates": [corners]}
    inside = geometry_mask([polygon], cells.shape, cells.transform, invert=True)
    return np.asarray(inside, dtype=np.bool_)

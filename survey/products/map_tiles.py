"""The map cut into squares that each hold few enough points to be worked on at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.products.cells import CellGrid

FloatArray = NDArray[np.float64]

BLOCK = 256
"""Cells along the side of a block of the GeoTIFF; tiles are 2^n of it, or a 2^n-th."""

POINTS_OF_A_TILE, SIDE_OF_A_TILE = 300_000, 4 * BLOCK


@dataclass(frozen=True, kw_only=True)
class MapTile:
    """A square of the map.

    Parameters
    ----------
    cells : CellGrid
        Its cells, of the lattice of the gridded bathymetry.
    west, south, east, north : float
        Its borders, of which the western and the southern belong to it [m]: those of neighbours are
        equal to the last bit.
    margin : float
        What it needs to know of its surroundings [m].
    frames : array (m,)
        Which frames, by their place in the order given, may reach it or its margin.
    """

    cells: CellGrid
    west: float
    south: float
    east: float
    north: float
    margin: float
    frames: NDArray[np.intp]

    def contains(self, on_map: FloatArray) -> NDArray[np.bool_]:
        """Return which places (n, 2 or 3) lie in the tile."""
        return self._within(on_map, 0.0)

    def reaches(self, on_map: FloatArray) -> NDArray[np.bool_]:
        """Return which places (n, 2 or 3) lie in the tile or its margin."""
        return self._within(on_map, self.margin)

    def _within(self, on_map: FloatArray, margin: float) -> NDArray[np.bool_]:
        x, y = on_map[:, 0], on_map[:, 1]
        across = (x >= self.west - margin) & (x < self.east + margin)
        along = (y >= self.south - margin) & (y < self.north + margin)
        return np.asarray(across & along)


def map_tiles(
    *,
    extents: FloatArray,
    points: NDArray[np.int64],
    lattice: CellGrid,
    margin: float,
    most: int = POINTS_OF_A_TILE,
) -> Iterator[MapTile]:
    """Yield the tiles that frames reach: a square over all is quartered until few points remain.

    Quarters come in the order north-west, north-east, south-west, south-east. How many points a
    square holds is estimated as if each frame were spread evenly over its extent.

    Parameters
    ----------
    extents : array (frames, 4)
        West, south, east, north of what each frame holds [m]; nan where it holds nothing.
    points : array (frames,)
        How many points.
    lattice : CellGrid
        Cells that no border cuts; its north-west corner is one of a block.
    margin : float
        Of each tile [m].
    most : int
        Points that a tile should not exceed.

    Examples
    --------
    >>> lattice = CellGrid(west=0.0, north=512.0, cell_size=2.0, rows=256, columns=256)
    >>> extents = np.array([[9.0, 9.0, 99.0, 99.0], [300.0, 300.0, 400.0, 400.0]])
    >>> tiles = map_tiles(extents=extents, points=np.array([900, 900]), lattice=lattice,
    ...                   margin=1.0, most=1000)
    >>> [(tile.west, tile.south, tile.cells.rows, tile.frames.tolist()) for tile in tiles]
    [(256.0, 256.0, 128, [1]), (0.0, 0.0, 128, [0])]
    """
    known = np.flatnonzero(np.isfinite(extents).all(axis=1))
    if known.size == 0:
        return
    west, south, east, north = extents[known].T
    along = max(lattice.north - south.min(), north.max() - lattice.north)
    across = max(lattice.west - west.min(), east.max() - lattice.west)
    blocks = int((max(along, across) + margin) / (BLOCK * lattice.cell_size)) + 1
    half = BLOCK << (blocks - 1).bit_length()
    quarters = _Quarters(extents=extents, points=points, lattice=lattice, margin=margin, most=most)
    yield from quarters.within(-half, -half, 2 * half, known)


@dataclass(frozen=True, kw_only=True)
class _Quarters:
    extents: FloatArray
    points: NDArray[np.int64]
    lattice: CellGrid
    margin: float
    most: int

    def within(
        self, row: int, column: int, side: int, frames: NDArray[np.intp]
    ) -> Iterator[MapTile]:
        """Yield the tiles of a square of cells, counted from the corner of the lattice."""
        tile = self._tile(row, column, side, frames)
        if tile.frames.size == 0:
            return
        few = side <= SIDE_OF_A_TILE and self._expected_points(tile) <= self.most
        if side == 1 or few:
            yield tile
            return
        half = side // 2
        for down, right in ((0, 0), (0, half), (half, 0), (half, half)):
            yield from self.within(row + down, column + right, half, tile.frames)

    def _tile(self, row: int, column: int, side: int, frames: NDArray[np.intp]) -> MapTile:
        size = self.lattice.cell_size
        first_row = round(self.lattice.north / size) - row
        first_column = round(self.lattice.west / size) + column
        left, right = first_column * size, (first_column + side) * size
        low, high = (first_row - side) * size, first_row * size
        west, south, east, north = self.extents[frames].T
        reaches = (west <= right + self.margin) & (east >= left - self.margin)
        reaches &= (south <= high + self.margin) & (north >= low - self.margin)
        return MapTile(
            cells=CellGrid(west=left, north=high, cell_size=size, rows=side, columns=side),
            **{"west": left, "south": low, "east": right, "north": high},
            margin=self.margin,
            frames=frames[reaches],
        )

    def _expected_points(self, tile: MapTile) -> float:
        west, south, east, north = self.extents[tile.frames].T
        across = _share_between(tile.west, tile.east, west, east)
        along = _share_between(tile.south, tile.north, south, north)
        return float(np.sum(self.points[tile.frames] * across * along))


def _share_between(low: float, high: float, first: FloatArray, last: FloatArray) -> FloatArray:
    """Return which share of each interval from ``first`` to ``last`` lies between two borders."""
    inside = np.clip(last, low, high) - np.clip(first, low, high)
    length = last - first
    return np.where(length > 0.0, inside / np.where(length > 0.0, length, 1.0), 1.0)

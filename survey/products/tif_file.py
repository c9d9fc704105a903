"""The gridded bathymetry as a GeoTIFF, written part by part."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from survey.products.cells import CellGrid
from survey.products.grids import ElevationGrid
from survey.products.map_tiles import BLOCK
from survey.products.writing import require_read_back, whole_file
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    from rasterio import DatasetReader
    from rasterio.io import DatasetWriter

BANDS = (("elevation", "m"), ("density", "1/m2"), ("standard_deviation", "m"))
EMPTY = np.array([np.nan, 0.0, np.nan], np.float32)[:, None, None]
CACHE_BYTES = 1 << 26
Window = tuple[tuple[int, int], tuple[int, int]]


def write_bathymetry_tif(path: Path, grid: ElevationGrid, map_frame: MapFrame) -> None:
    """Write a whole grid; see `bathymetry_tif`."""
    with bathymetry_tif(path, grid.cells, map_frame) as add:
        add(grid)


@contextmanager
def bathymetry_tif(
    path: Path, cells: CellGrid, map_frame: MapFrame
) -> Iterator[Callable[[ElevationGrid], None]]:
    """Give a function that adds parts of a grid to a tiled GeoTIFF of float32.

    Its bands are elevation, density and standard deviation. North is up, edges are whole multiples
    of the cell size, the CRS is compound, empty cells are nan (in the density band 0).

    Parts do not overlap, and lie on whole blocks or, one after another, inside one.

    Raises
    ------
    ReadBackError
        If the file does not read back as written.
    """
    import rasterio

    profile = {
        **{"driver": "GTiff", "dtype": "float32", "count": len(BANDS), "nodata": np.nan},
        **{"height": cells.rows, "width": cells.columns},
        **{"crs": rasterio.CRS.from_wkt(map_frame.crs.to_wkt())},
        **{"transform": cells.transform, "compress": "deflate", "predictor": 3},
        **{"tiled": True, "blockxsize": BLOCK, "blockysize": BLOCK, "num_threads": 1},
    }
    with whole_file(path) as partial, rasterio.Env(GDAL_CACHEMAX=CACHE_BYTES):
        with rasterio.open(partial, "w", **profile) as file:
            file.descriptions = tuple(name for name, _ in BANDS)
            file.units = tuple(unit for _, unit in BANDS)
            blocks = _Blocks(file, cells)
            yield blocks.add
            blocks.fill()
        with rasterio.open(partial) as file:
            require_read_back(path, "cells", blocks.are_in(file))


class _Blocks:
    """Writes parts, knows which blocks hold none, and remembers what was written where."""

    def __init__(self, file: DatasetWriter, cells: CellGrid) -> None:
        self._file, self._cells = file, cells
        self._untouched = {place for place, _ in file.block_windows()}
        self._written: list[tuple[Window, int]] = []

    def add(self, grid: ElevationGrid) -> None:
        """Write a part of the grid; what lies outside the raster is left out."""
        rows, columns = self._cells.window(grid.cells)
        inside = grid.cells.window(self._cells)
        bands = np.stack([grid.elevation, grid.density, grid.deviation])[:, *inside]
        if bands.size == 0:
            return
        touched = product(_blocks_along(rows), _blocks_along(columns))
        for place in self._untouched.intersection(touched):
            self._clear(place)
        window = ((rows.start, rows.stop), (columns.start, columns.stop))
        self._file.write(bands.astype(np.float32), window=window)
        self._written.append((window, _checksum(bands)))

    def fill(self) -> None:
        """Write the blocks that hold no part."""
        for place in sorted(self._untouched):
            self._clear(place)

    def are_in(self, file: DatasetReader) -> bool:
        """Tell whether a file holds all parts."""
        return all(
            _checksum(file.read(window=window)) == checksum for window, checksum in self._written
        )

    def _clear(self, place: tuple[int, int]) -> None:
        """Write an empty block, or GDAL would take nan for the density around a part."""
        window = self._file.block_window(1, *place)
        shape = (len(BANDS), window.height, window.width)
        self._file.write(np.broadcast_to(EMPTY, shape), window=window)
        self._untouched.discard(place)


def _blocks_along(cells: slice) -> range:
    return range(cells.start // BLOCK, (cells.stop - 1) // BLOCK + 1)


def _checksum(bands: NDArray[Any]) -> int:
    return crc32(bands.astype(np.float32).tobytes())

"""Gridded bathymetry: GeoTIFF, plain or cloud-optimised."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud
from survey.products.cells import CellGrid
from survey.products.writing import ProductError, require_read_back, whole_file
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]
SOLID_CLASSES = (PointClass.GROUND, PointClass.BATHYMETRIC, PointClass.SUBMERGED_OBJECT)
BANDS = (("elevation", "m"), ("density", "1/m2"), ("standard_deviation", "m"))
TILE = 256


@dataclass(frozen=True, kw_only=True)
class ElevationGrid:
    """Seabed and land by cells, row 0 in the north.

    Parameters
    ----------
    cells : CellGrid
        Where the cells lie on the map.
    elevation : array (rows, columns)
        Median elevation of the points in a cell [m], nan where there is none.
    density : array (rows, columns)
        Points a square metre [1/m2].
    deviation : array (rows, columns)
        Standard deviation of their elevations, n - 1 [m], nan below two points.
    """

    cells: CellGrid
    elevation: FloatArray
    density: FloatArray
    deviation: FloatArray


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
    on_map = map_frame.to_map(cloud.position[np.isin(cloud.classification, SOLID_CLASSES)])
    if on_map.shape[0] == 0:
        raise ProductError(
            f"grid: none of the {len(cloud)} points is seabed, object or ground. "
            "See the outcomes of the pixels for why"
        )
    cells = CellGrid.covering(on_map, cell_size=cell_size)
    index = cells.index_of(on_map)
    order = np.lexsort((on_map[:, 2], index))
    count = np.bincount(index, minlength=cells.rows * cells.columns)
    elevation, deviation = _cell_statistics(on_map[order, 2], count)
    return ElevationGrid(
        cells=cells,
        elevation=elevation.reshape(cells.shape),
        density=count.reshape(cells.shape) / cell_size**2,
        deviation=deviation.reshape(cells.shape),
    )


def _cell_statistics(z: FloatArray, count: NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
    """Return median and deviation of elevations sorted by cell and, within it, by height."""
    first = np.cumsum(count) - count
    median, deviation = np.full((2, count.size), np.nan)
    filled = np.flatnonzero(count)
    low, high = (count[filled] - 1) // 2, count[filled] // 2
    median[filled] = 0.5 * (z[first[filled] + low] + z[first[filled] + high])
    from_median = z - np.repeat(median, count)
    owner = np.repeat(np.arange(count.size), count)
    total = np.bincount(owner, from_median, count.size)
    squares = np.bincount(owner, from_median**2, count.size)
    several = count > 1
    variance = (squares[several] - total[several] ** 2 / count[several]) / (count[several] - 1)
    deviation[several] = np.sqrt(np.maximum(variance, 0.0))
    return median, deviation


def write_bathymetry_tif(path: Path, grid: ElevationGrid, map_frame: MapFrame) -> None:
    """Write the grid as a tiled GeoTIFF: elevation, density, standard deviation, float32.

    North is up, edges are whole multiples of the cell size, the CRS is compound, empty cells
    are nan (in the density band 0).

    Raises
    ------
    ReadBackError
        If the file does not read back as written.
    """
    tiles = {"driver": "GTiff", "tiled": True, "blockxsize": TILE, "blockysize": TILE}
    _write_bands(path, grid, map_frame, {**tiles, "predictor": 3})


def write_bathymetry_cog(path: Path, grid: ElevationGrid, map_frame: MapFrame) -> None:
    """Write the same bands as cloud-optimised GeoTIFF (COG) with overviews.

    Overviews are averages over the filled cells under them.

    Raises
    ------
    ReadBackError
        If the file does not read back as written.
    """
    layout = {"driver": "COG", "blocksize": TILE, "predictor": "FLOATING_POINT"}
    overviews = {"overviews": "IGNORE_EXISTING", "overview_resampling": "average"}
    _write_bands(path, grid, map_frame, {**layout, **overviews})


def _write_bands(
    path: Path, grid: ElevationGrid, map_frame: MapFrame, layout: dict[str, Any]
) -> None:
    import rasterio

    bands = np.stack([grid.elevation, grid.density, grid.deviation]).astype(np.float32)
    profile = {
        **{"dtype": "float32", "count": len(BANDS), "nodata": np.nan},
        **{"height": grid.cells.rows, "width": grid.cells.columns},
        **{"crs": rasterio.CRS.from_wkt(map_frame.crs.to_wkt())},
        **{"transform": grid.cells.transform, "compress": "deflate", "num_threads": 1},
        **layout,
    }
    with whole_file(path) as partial:
        with rasterio.open(partial, "w", **profile) as file:
            file.write(bands)
            file.descriptions = tuple(name for name, _ in BANDS)
            file.units = tuple(unit for _, unit in BANDS)
        with rasterio.open(partial) as file:
            require_read_back(path, "cells", np.array_equal(file.read(), bands, equal_nan=True))


def read_bathymetry_tif(path: Path) -> ElevationGrid:
    """Read a grid that `write_bathymetry_tif` wrote.

    Raises
    ------
    ProductError
        If the file has other bands.
    """
    import rasterio

    with rasterio.open(path) as file:
        if file.descriptions != tuple(name for name, _ in BANDS):
            raise ProductError(f"{path}: not the bands of a bathyflash grid. Run the mission again")
        elevation, density, deviation = file.read().astype(np.float64)
        cells = CellGrid(
            west=file.transform.c,
            north=file.transform.f,
            cell_size=file.transform.a,
            rows=file.height,
            columns=file.width,
        )
    return ElevationGrid(cells=cells, elevation=elevation, density=density, deviation=deviation)

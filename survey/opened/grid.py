"""The gridded bathymetry as an xarray data set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from survey.products.grids import BANDS, ElevationGrid
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    import xarray

DIMS = ("northing", "easting")


def grid_dataset(grid: ElevationGrid, map_frame: MapFrame) -> xarray.Dataset:
    """Return a grid by the centres of its cells on the map [m], row 0 in the north.

    Its variables are the bands of bathymetry.tif; ``crs`` tells the coordinate system, after CF.
    """
    import xarray

    cells, half = grid.cells, 0.5 * grid.cells.cell_size
    places = {
        "northing": cells.north - half - cells.cell_size * np.arange(cells.rows),
        "easting": cells.west + half + cells.cell_size * np.arange(cells.columns),
    }
    units = {"units": "m"}
    bands = {
        name: (DIMS, band, {"units": unit, "grid_mapping": "crs"})
        for (name, unit), band in zip(BANDS, grid.bands(), strict=True)
    }
    found = xarray.Dataset(bands, {name: (name, place, units) for name, place in places.items()})
    found["crs"] = ((), np.int32(0), map_frame.crs.to_cf())
    return found

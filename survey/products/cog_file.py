"""The gridded bathymetry as cloud-optimised GeoTIFF (COG)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from survey.products.grids import BANDS, ElevationGrid
from survey.products.writing import require_read_back, whole_file
from terrain.map_frame import MapFrame

BLOCK = 256


def write_bathymetry_cog(path: Path, grid: ElevationGrid, map_frame: MapFrame) -> None:
    """Write the bands of `survey.products.grids.BANDS` with overviews, all directories in front.

    Overviews are averages over the filled cells under them. The grid is in memory at once.

    Raises
    ------
    ReadBackError
        If the file does not read back as written.
    """
    import rasterio

    bands = grid.bands()
    profile = {
        **{"driver": "COG", "dtype": "float32", "count": len(BANDS), "nodata": np.nan},
        **{"height": grid.cells.rows, "width": grid.cells.columns},
        **{"crs": rasterio.CRS.from_wkt(map_frame.crs.to_wkt())},
        **{"transform": grid.cells.transform, "compress": "deflate", "num_threads": 1},
        **{"blocksize": BLOCK, "predictor": "FLOATING_POINT"},
        **{"overviews": "IGNORE_EXISTING", "overview_resampling": "average"},
    }
    with whole_file(path) as partial:
        with rasterio.open(partial, "w", **profile) as file:
            file.write(bands)
            file.descriptions = tuple(name for name, _ in BANDS)
            file.units = tuple(unit for _, unit in BANDS)
        with rasterio.open(partial) as file:
            require_read_back(path, "cells", np.array_equal(file.read(), bands, equal_nan=True))

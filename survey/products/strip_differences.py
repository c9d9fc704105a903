"""Differences of overlapping lines: figures of every pair, and a raster."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.overlaps import LineCells, Overlap
from survey.products.cells import CellGrid
from survey.products.writing import require_read_back, whole_file
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]
DECIMALS = 4
BANDS = (("difference", "m"), ("lines", "1"))


def overlap_metrics(found: Sequence[Overlap]) -> list[dict[str, Any]]:
    """Return the figures of every overlap as plain values.

    ======================  ====================================================================
    lines                   the earlier and the later line, from 0
    cells, area_m2          cells that hold points of both, and their area
    mean_difference_m       mean of the later less the earlier line's mean elevation in a cell
    rms_difference_m        root mean square of these
    p95_abs_difference_m    95 % of the cells differ by less
    ======================  ====================================================================
    """
    return [
        {
            "lines": list(overlap.lines),
            "cells": len(overlap.differences),
            "area_m2": round(overlap.area, DECIMALS),
            "mean_difference_m": round(float(np.mean(overlap.differences)), DECIMALS),
            "rms_difference_m": round(float(np.sqrt(np.mean(overlap.differences**2))), DECIMALS),
            "p95_abs_difference_m": round(
                float(np.percentile(np.abs(overlap.differences), 95.0)), DECIMALS
            ),
        }
        for overlap in found
    ]


def difference_raster(found: LineCells) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return the last less the first line's mean elevation [m], and the lines, of every cell.

    Both (rows, columns), row 0 in the north, over the smallest box of cells; the difference is nan
    below two lines.
    """
    low = found.cell.min(axis=0)
    columns, rows = found.cell.max(axis=0) - low + 1
    column, up = (found.cell - low).T
    index = (rows - 1 - up) * columns + column
    order = np.lexsort((found.line, index))
    last, first = np.full((2, rows * columns), np.nan)
    last[index[order]] = found.elevation[order]
    first[index[order[::-1]]] = found.elevation[order[::-1]]
    count = np.bincount(index, minlength=rows * columns)
    difference = np.where(count > 1, last - first, np.nan)
    return difference.reshape(rows, columns), count.reshape(rows, columns)


def cell_grid(found: LineCells, map_frame: MapFrame) -> CellGrid:
    """Return where the raster of `difference_raster` lies on the map."""
    low = found.cell.min(axis=0)
    columns, rows = found.cell.max(axis=0) - low + 1
    west, north = map_frame.origin[:2] + np.array([low[0], low[1] + rows]) * found.cell_size
    return CellGrid(
        west=float(west),
        north=float(north),
        cell_size=found.cell_size,
        rows=int(rows),
        columns=int(columns),
    )


def write_strip_differences(path: Path, found: LineCells, map_frame: MapFrame) -> None:
    """Write a GeoTIFF, float32: last less first line's mean elevation, and how many lines.

    Raises
    ------
    ReadBackError
        If the file does not read back as written.
    """
    import rasterio

    grid = cell_grid(found, map_frame)
    bands = np.stack(difference_raster(found)).astype(np.float32)
    profile = {
        **{"driver": "GTiff", "dtype": "float32", "count": len(BANDS), "nodata": np.nan},
        **{"height": grid.rows, "width": grid.columns, "transform": grid.transform},
        **{"crs": rasterio.CRS.from_wkt(map_frame.crs.to_wkt())},
        **{"compress": "deflate", "predictor": 3, "num_threads": 1},
    }
    with whole_file(path) as partial:
        with rasterio.open(partial, "w", **profile) as file:
            file.write(bands)
            file.descriptions = tuple(name for name, _ in BANDS)
            file.units = tuple(unit for _, unit in BANDS)
        with rasterio.open(partial) as file:
            require_read_back(path, "cells", np.array_equal(file.read(), bands, equal_nan=True))

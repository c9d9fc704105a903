"""Differences of overlapping lines: figures of every pair, and a raster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.overlaps import LineCells, Overlap
from survey.products.cells import CellGrid
from survey.products.tif_file import banded_tif
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]
DECIMALS = 4
DIFFERENCES = "strip_differences.tif"
BANDS = (("difference", "m"), ("lines", "1"))
EMPTY = (np.nan, 0.0)


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


def difference_bands(cells: CellGrid, found: LineCells) -> FloatArray:
    """Return the last less the first line's mean elevation [m], and the lines, of every cell.

    Two bands (2, rows, columns), row 0 in the north; the difference is nan below two lines.
    """
    centre = np.asarray((found.cell + 0.5) * found.cell_size, dtype=np.float64)
    index = cells.index_of(centre)
    size = cells.rows * cells.columns
    order = np.lexsort((found.line, index))
    last, first = np.full((2, size), np.nan)
    last[index[order]] = found.elevation[order]
    first[index[order[::-1]]] = found.elevation[order[::-1]]
    count = np.bincount(index, minlength=size)
    bands = np.stack([np.where(count > 1, last - first, np.nan), count])
    return bands.reshape(2, *cells.shape)


@contextmanager
def strip_differences_tif(
    path: Path, cells: CellGrid, map_frame: MapFrame
) -> Iterator[Callable[[CellGrid, LineCells], None]]:
    """Give a function that adds the lines of parts of the map; see `banded_tif`."""
    with banded_tif(path, cells, map_frame, bands=BANDS, empty=EMPTY) as add:
        yield lambda part, lines: add(part, difference_bands(part, lines))

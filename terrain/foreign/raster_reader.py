"""Cells of a raster about a place, read in the child: no more of the file than that."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from terrain.foreign.faults import ReaderError, readable

if TYPE_CHECKING:
    from rasterio.io import DatasetReader

    Window = tuple[int, int, int, int]


def read_cells(
    path: str,
    *,
    band: int,
    box: Sequence[Sequence[float]] | None,
    most_cells: int,
    nodata: float | None,
) -> dict[str, Any]:
    """Return the cells of a band about a box.

    Parameters
    ----------
    path : str
    band : int
        From 1.
    box : ((west, south), (east, north)), optional
        In the raster's coordinates; all cells without it.
    most_cells : int
        More are not read.
    nodata : float, optional
        Value of cells without data, where the file is not to say it.

    Returns
    -------
    dict
        ``values`` (rows, cols) as stored and ``valid``, which cells have data, both empty where
        the window is too small or too large; ``window`` first row, first column, rows, columns;
        ``shape`` of the raster, ``transform`` from column and row to its coordinates (6,);
        ``crs`` WKT and ``unit``, empty where there is none; ``scale`` (scale, offset);
        ``tells_nodata`` whether the file or ``nodata`` tells which cells have none.

    Raises
    ------
    ReaderError
        When it is no raster or has no such band.
    """
    import rasterio

    with readable("raster"), rasterio.open(path) as source:
        if not 1 <= band <= source.count:
            raise ReaderError(f"band {band}: the raster has {source.count}. choose one")
        window = _window(source, box)
        _, _, rows, cols = window
        fits = min(rows, cols) >= 2 and rows * cols <= most_cells
        values, valid = _cells(source, band, window if fits else (0, 0, 0, 0), nodata)
        return {
            "values": values,
            "valid": valid,
            "window": np.array(window),
            "shape": np.array(source.shape),
            "transform": np.array(tuple(source.transform)[:6]),
            "crs": source.crs.to_wkt() if source.crs else "",
            "unit": source.units[band - 1] or "",
            "scale": np.array([source.scales[band - 1], source.offsets[band - 1]]),
            "tells_nodata": nodata is not None or _has_mask(source, band),
        }


def _window(source: DatasetReader, box: Sequence[Sequence[float]] | None) -> Window:
    """Return the cells about a box: first row, first column, rows, columns."""
    rows, cols = source.shape
    if box is None:
        return 0, 0, rows, cols
    (west, south), (east, north) = box
    corners = [(west, south), (east, south), (east, north), (west, north)]
    col, row = np.transpose([~source.transform * corner for corner in corners])
    first = np.floor([row.min(), col.min()]).astype(np.int64) - 1
    last = np.ceil([row.max(), col.max()]).astype(np.int64) + 1
    first, last = np.clip(first, 0, [rows, cols]), np.clip(last, 0, [rows, cols])
    return int(first[0]), int(first[1]), int(last[0] - first[0]), int(last[1] - first[1])


def _cells(
    source: DatasetReader, band: int, window: Window, nodata: float | None
) -> tuple[Any, Any]:
    from rasterio.windows import Window as Part

    row, col, rows, cols = window
    if rows * cols == 0:
        return np.empty((0, 0)), np.empty((0, 0), dtype=np.bool_)
    part = Part(col, row, cols, rows)
    values = source.read(band, window=part)
    if nodata is not None:
        return values, values != nodata
    return values, source.read_masks(band, window=part) != 0


def _has_mask(source: DatasetReader, band: int) -> bool:
    from rasterio.enums import MaskFlags

    return MaskFlags.all_valid not in source.mask_flag_enums[band - 1]

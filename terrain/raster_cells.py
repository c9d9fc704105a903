"""The cells of a raster about a place on the map, checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pyproj import CRS

from terrain.extent import MOST_CELLS
from terrain.file_faults import SeabedFileError, existing, parsed, require_crs
from terrain.foreign.limits import limits_for_window

FloatArray = NDArray[np.float64]
Nodata = float | Literal["none"] | None


@dataclass(frozen=True, kw_only=True)
class RasterCells:
    """A window of a raster's band.

    Parameters
    ----------
    values : array (rows, cols)
        As stored.
    valid : array (rows, cols)
        Which cells have data.
    scale : (float, float)
        Factor and offset from stored values to their unit.
    unit : str
        As the file names it, empty where it does not.
    first : (int, int)
        Row and column of the first cell in the raster.
    transform : array (6,)
        From column and row to easting and northing [m], as in GDAL's affine transform.
    """

    values: NDArray[Any]
    valid: NDArray[np.bool_]
    scale: tuple[float, float]
    unit: str
    first: tuple[int, int]
    transform: FloatArray

    @property
    def side(self) -> float:
        """Side of a cell along its row [m]."""
        return float(np.hypot(self.transform[0], self.transform[3]))

    def place(self, row: ArrayLike, col: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return easting and northing of rows and columns in the window; 0 is a first centre."""
        a, b, c, d, e, f = self.transform
        x, y = np.asarray(col) + self.first[1] + 0.5, np.asarray(row) + self.first[0] + 0.5
        return a * x + b * y + c, d * x + e * y + f

    def row_col(self, east: FloatArray, north: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return rows and columns in the window of places on the map, as `place` counts them."""
        a, b, c, d, e, f = self.transform
        x, y = np.linalg.solve([[a, b], [d, e]], np.stack([east - c, north - f]).reshape(2, -1))
        return (
            y.reshape(east.shape) - self.first[0] - 0.5,
            x.reshape(east.shape) - self.first[1] - 0.5,
        )


def raster_cells(
    path: str | Path,
    *,
    epsg: int,
    band: int = 1,
    nodata: Nodata = None,
    outline: FloatArray | None = None,
    margin: float = 0.0,
) -> RasterCells:
    """Return the cells about an outline, read in a child process; no others are read.

    Parameters
    ----------
    epsg : int
        The scenario's CRS, which must be the raster's.
    band : int
        From 1.
    nodata : float or "none", optional
        Value of cells without data, or that there are none, where the file does not tell.
    outline : array (corners, 2), optional
        Map coordinates; its bounding box, ``margin`` [m] wider, is read, all cells without it.

    Raises
    ------
    FileNotFoundError
        When there is no such file.
    SeabedFileError
        When it is no raster, or its CRS, cells without data, band, extent or size is not usable.
    """
    path = existing(path)
    box = None
    if outline is not None:
        box = [(outline.min(axis=0) - margin).tolist(), (outline.max(axis=0) + margin).tolist()]
    found = parsed(
        "terrain.foreign.raster_reader:read_cells",
        path,
        limits=limits_for_window(),
        band=band,
        box=box,
        most_cells=MOST_CELLS,
        nodata=nodata if isinstance(nodata, float) else None,
    )
    _require_told(found, path=path, epsg=epsg, nodata=nodata)
    _require_size(found, path, box)
    row, col, _, _ = found["window"].tolist()
    return RasterCells(
        values=found["values"],
        valid=found["valid"],
        scale=(float(found["scale"][0]), float(found["scale"][1])),
        unit=str(found["unit"]),
        first=(row, col),
        transform=found["transform"],
    )


def _require_told(found: dict[str, NDArray[Any]], *, path: Path, epsg: int, nodata: Nodata) -> None:
    """Refuse a raster that does not tell its CRS, or which cells have no data."""
    faults = []
    text = str(found["crs"])
    try:
        require_crs(CRS.from_wkt(text) if text else None, epsg=epsg, path=path)
    except SeabedFileError as fault:
        faults.append(str(fault))
    if nodata is None and not found["tells_nodata"]:
        faults.append(
            f"{path}: nodata: the file does not say which cells have no data. declare it in the "
            'file, or say nodata = -9999.0 (its value) or nodata = "none" (every cell has data)'
        )
    if faults:
        raise SeabedFileError("\n".join(faults))


def _require_size(
    found: dict[str, NDArray[Any]], path: Path, box: Sequence[Sequence[float]] | None
) -> None:
    _, _, rows, cols = found["window"].tolist()
    if box is not None and min(rows, cols) < 2:
        (west, south), (east, north) = box
        a, b, c, d, e, f = found["transform"]
        height, width = found["shape"]
        x = c + a * np.array([0, width, 0, width]) + b * np.array([0, 0, height, height])
        y = f + d * np.array([0, width, 0, width]) + e * np.array([0, 0, height, height])
        raise SeabedFileError(
            f"{path}: extent: easting {x.min():.0f} to {x.max():.0f}, northing {y.min():.0f} to "
            f"{y.max():.0f} does not reach the flight at {west:.0f} to {east:.0f}, "
            f"{south:.0f} to {north:.0f}"
        )
    if min(rows, cols) < 2 or rows * cols > MOST_CELLS:
        raise SeabedFileError(
            f"{path}: size: {rows} x {cols} cells, 2 x 2 to {MOST_CELLS:,} can be used. cut the "
            "raster or coarsen it"
        )

"""A seabed from a raster of elevations."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS

from terrain.file_faults import SeabedFileError, existing, frame_near, require_crs
from terrain.height_field import refine, triangulate
from terrain.roughness import Roughness
from terrain.seabed import Seabed, uniform_seabed

if TYPE_CHECKING:
    from affine import Affine
    from rasterio.io import DatasetReader
    from rasterio.windows import Window

FloatArray = NDArray[np.float64]

MOST_CELLS = 20_000_000
METRES = {None, "", "m", "metre", "meter", "metres", "meters"}


def from_raster(
    path: str | Path,
    *,
    epsg: int,
    vertical_epsg: int,
    reflectance: float,
    band: int = 1,
    outline: FloatArray | None = None,
    margin: float = 0.0,
    spacing: float | None = None,
    roughness: Roughness | None = None,
) -> Seabed:
    """Return the seabed of a raster whose cells hold elevations [m], positive up.

    Cells without data leave holes. Vertices are the centres of the cells.

    Parameters
    ----------
    epsg, vertical_epsg : int
        The scenario's CRS and vertical datum; the first must be the raster's.
    outline : array (corners, 2), optional
        Map coordinates; only the cells about its bounding box, ``margin`` [m] wider, are read.
    spacing : float, optional
        Cells are refined by a whole number to at most this side [m], smoothly.
    roughness : Roughness, optional
        Synthetic relief added on top.

    Raises
    ------
    FileNotFoundError
        When there is no such file.
    SeabedFileError
        When it is no raster, or its CRS, unit, band, extent or size is not usable.
    """
    import rasterio
    from rasterio.errors import RasterioError

    path = existing(path)
    try:
        with rasterio.open(path) as source:
            _check(source, path=path, epsg=epsg, band=band)
            window = _window(source, outline, margin, path)
            z, x, y = _cells(source, band, window, spacing, path)
    except RasterioError as error:
        raise SeabedFileError(f"{path}: not a readable raster. {_one_line(error)}") from error
    sentence = f"Raster {path.name}, band {band}."
    if roughness is not None:
        side = float(np.hypot(x[0, 1] - x[0, 0], y[0, 1] - y[0, 0]))
        z = z + roughness.field((z.shape[0], z.shape[1]), spacing=side)
        sentence = f"{sentence} {roughness.sentence()}"
    frame = frame_near(
        east=float(x.mean()), north=float(y.mean()), epsg=epsg, vertical_epsg=vertical_epsg
    )
    try:
        mesh = triangulate(x - frame.easting, y - frame.northing, z)
    except ValueError as error:
        raise SeabedFileError(f"{path}: band {band}: {error}") from error
    return uniform_seabed(mesh, reflectance=reflectance, map_frame=frame, source=sentence)


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())


def _check(source: DatasetReader, *, path: Path, epsg: int, band: int) -> None:
    if not 1 <= band <= source.count:
        raise SeabedFileError(f"{path}: band {band}: the raster has {source.count}. choose one")
    crs = CRS.from_user_input(source.crs.to_wkt()) if source.crs else None
    require_crs(crs, epsg=epsg, path=path)
    unit = source.units[band - 1]
    if unit is not None and unit.lower() not in METRES:
        raise SeabedFileError(f"{path}: band {band}: elevations in {unit}. convert them to metres")


def _window(source: DatasetReader, outline: FloatArray | None, margin: float, path: Path) -> Window:
    """Return the cells about an outline, all of them without one."""
    from rasterio.windows import Window

    rows, cols = source.height, source.width
    if outline is not None:
        low, high = outline.min(axis=0) - margin, outline.max(axis=0) + margin
        xs, ys = np.array([low[0], high[0], high[0], low[0]]), np.repeat([low[1], high[1]], 2)
        col, row = _apply(~source.transform, xs, ys)
        first = np.floor([min(row), min(col)]).astype(int) - 1
        last = np.ceil([max(row), max(col)]).astype(int) + 1
        first, last = np.maximum(first, 0), np.minimum(last, [rows, cols])
        if (last - first < 2).any():
            raise SeabedFileError(
                f"{path}: extent: easting {source.bounds.left:.0f} to {source.bounds.right:.0f}, "
                f"northing {source.bounds.bottom:.0f} to {source.bounds.top:.0f} does not reach "
                f"the flight at {low[0]:.0f} to {high[0]:.0f}, {low[1]:.0f} to {high[1]:.0f}"
            )
        window = Window(first[1], first[0], last[1] - first[1], last[0] - first[0])
    else:
        window = Window(0, 0, cols, rows)
    if window.width * window.height > MOST_CELLS or min(rows, cols) < 2:
        raise SeabedFileError(
            f"{path}: size: {window.height} x {window.width} cells, 2 x 2 to "
            f"{MOST_CELLS:,} can be meshed. cut the raster or coarsen it"
        )
    return window


def _cells(
    source: DatasetReader, band: int, window: Window, spacing: float | None, path: Path
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return elevation, easting and northing of the cells, refined."""
    raw: Any = source.read(band, window=window, masked=True)
    z = np.ma.filled(raw.astype(np.float64), np.nan)
    z = z * source.scales[band - 1] + source.offsets[band - 1]
    z[~np.isfinite(z)] = np.nan
    factor = 1
    if spacing is not None:
        side = float(np.hypot(source.transform.a, source.transform.d))
        factor = max(1, int(np.ceil(side / spacing - 1e-9)))
        if z.size * factor**2 > MOST_CELLS:
            raise SeabedFileError(f"{path}: spacing: {spacing} m makes too many cells. widen it")
        z = refine(z, factor)
    rows, cols = np.indices(z.shape) / factor
    x, y = _apply(source.transform, cols + window.col_off + 0.5, rows + window.row_off + 0.5)
    return z, x, y


def _apply(transform: Affine, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    t = transform
    return t.a * x + t.b * y + t.c, t.d * x + t.e * y + t.f

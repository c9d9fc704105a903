"""A seabed from a raster of elevations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from terrain.extent import HIGHEST, MOST_CELLS
from terrain.file_faults import SeabedFileError, frame_near
from terrain.height_field import refine, triangulate
from terrain.raster_cells import Nodata, RasterCells, raster_cells
from terrain.roughness import Roughness
from terrain.seabed import Seabed, uniform_seabed

FloatArray = NDArray[np.float64]

METRES = {"", "m", "metre", "meter", "metres", "meters"}


def from_raster(
    path: str | Path,
    *,
    epsg: int,
    vertical_epsg: int,
    reflectance: float,
    band: int = 1,
    nodata: Nodata = None,
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
    band, nodata, outline, margin
        What is read, see `terrain.raster_cells.raster_cells`.
    spacing : float, optional
        Cells are refined by a whole number to at most this side [m], smoothly.
    roughness : Roughness, optional
        Synthetic relief added on top.

    Raises
    ------
    FileNotFoundError
        When there is no such file.
    SeabedFileError
        When it is no raster, or what it holds is not usable; a line a fault.
    """
    path = Path(path)
    cells = raster_cells(path, epsg=epsg, band=band, nodata=nodata, outline=outline, margin=margin)
    if cells.unit.lower() not in METRES:
        raise SeabedFileError(
            f"{path}: band {band}: elevations in {cells.unit}. convert them to metres"
        )
    z, x, y = _lattice(cells, spacing, path)
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


def _lattice(
    cells: RasterCells, spacing: float | None, path: Path
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return elevation, easting and northing of the cells, refined."""
    z = np.where(cells.valid, cells.values.astype(np.float64), np.nan)
    z = z * cells.scale[0] + cells.scale[1]
    z[~np.isfinite(z)] = np.nan
    _require_ground(z, cells, path)
    factor = 1
    if spacing is not None:
        factor = max(1, int(np.ceil(cells.side / spacing - 1e-9)))
        if z.size * factor**2 > MOST_CELLS:
            raise SeabedFileError(f"{path}: spacing: {spacing} m makes too many cells. widen it")
        z = refine(z, factor)
    rows, cols = np.indices(z.shape) / factor
    return z, *cells.place(rows, cols)


def _require_ground(z: FloatArray, cells: RasterCells, path: Path) -> None:
    """Refuse elevations that no ground has."""
    beyond = np.argwhere(np.abs(z) > HIGHEST)
    if len(beyond):
        row, col = beyond[0] + cells.first
        raise SeabedFileError(
            f"{path}: row {row}, column {col}: elevation {z[tuple(beyond[0])]:g} m, beyond "
            f"{HIGHEST:g}, like {len(beyond) - 1} more. If it marks cells without data, say so "
            "with nodata"
        )

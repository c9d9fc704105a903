"""What the bottom is made of, from a raster."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from terrain.file_faults import SeabedFileError
from terrain.raster_cells import Nodata, RasterCells, raster_cells
from terrain.substrate import UNLABELLED, Substrate

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

SHOWN = 5


@dataclass(frozen=True, kw_only=True)
class Cover:
    """A raster of materials.

    Parameters
    ----------
    cells : RasterCells
        Where the raster lies.
    kind : array (rows, cols) of int
        Which kind of bottom, -1 where the raster says nothing.
    reflectance : array (kinds,)
        Of every kind.
    code : array (kinds,) of uint8
        Code of the substrate of every kind; 0 leaves the label that was there.
    names : mapping
        Name of every code.
    sentence : str
        Where it comes from.
    """

    cells: RasterCells
    kind: IntArray
    reflectance: FloatArray
    code: NDArray[np.uint8]
    names: Mapping[int, str]
    sentence: str


def substrate_cover(
    path: str | Path, *, classes: Mapping[int, Substrate], epsg: int, **window: Any
) -> Cover:
    """Return the cover of a raster whose cells hold class numbers.

    Parameters
    ----------
    classes : mapping
        Substrate of every number that occurs.
    epsg, **window
        Which cells, see `terrain.raster_cells.raster_cells`.

    Raises
    ------
    FileNotFoundError, SeabedFileError
        As `raster_cells`, and when a class has no substrate.
    """
    cells = raster_cells(path, epsg=epsg, **window)
    _require_some(cells.valid, path)
    found = np.unique(cells.values[cells.valid])
    unknown = [f"{number:g}" for number in found.tolist() if number not in classes]
    if unknown:
        more = "" if len(unknown) <= SHOWN else f" and {len(unknown) - SHOWN} more"
        raise SeabedFileError(
            f"{path}: class {', '.join(unknown[:SHOWN])}{more}: no substrate is given. "
            "add it to the classes of the map"
        )
    kind = np.full(cells.valid.shape, -1, dtype=np.int32)
    for index, number in enumerate(classes):
        kind[cells.valid & (cells.values == number)] = index
    return Cover(
        cells=cells,
        kind=kind,
        reflectance=np.array([substrate.reflectance for substrate in classes.values()]),
        code=np.array([substrate.code for substrate in classes.values()], dtype=np.uint8),
        names={substrate.code: substrate.name for substrate in classes.values()},
        sentence=f"Bottom cover from {Path(path).name}.",
    )


def reflectance_cover(
    path: str | Path, *, epsg: int, nodata: Nodata = None, **window: Any
) -> Cover:
    """Return the cover of a raster whose cells hold reflectances, 0 to 1.

    Raises
    ------
    FileNotFoundError, SeabedFileError
        As `raster_cells`, and when a reflectance is outside 0 to 1.
    """
    cells = raster_cells(path, epsg=epsg, nodata=nodata, **window)
    given = cells.values.astype(np.float64) * cells.scale[0] + cells.scale[1]
    valid = cells.valid & np.isfinite(given)
    _require_some(valid, path)
    wrong = valid & ~((given >= 0.0) & (given <= 1.0))
    if wrong.any():
        row, col = np.argwhere(wrong)[0] + cells.first
        raise SeabedFileError(
            f"{path}: row {row}, column {col}: reflectance {given[wrong][0]:g} is not within 0 to "
            f"1, nor in {int(wrong.sum()) - 1} other cells"
        )
    values, numbers = np.unique(given[valid], return_inverse=True)
    kind = np.full(given.shape, -1, dtype=np.int32)
    kind[valid] = numbers
    return Cover(
        cells=cells,
        kind=kind,
        reflectance=values,
        code=np.full(len(values), UNLABELLED, dtype=np.uint8),
        names={},
        sentence=f"Bottom reflectance from {Path(path).name}.",
    )


def _require_some(valid: NDArray[np.bool_], path: str | Path) -> None:
    if not valid.any():
        raise SeabedFileError(f"{path}: no cell has data where it is flown. take another map")

"""What is wrong with a seabed file, and the checks that every importer shares."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS

from terrain.foreign.faults import ForeignFileError
from terrain.foreign.limits import Limits
from terrain.foreign.reading import read_foreign
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]

FRAME_STEP = 100.0  # [m] to which the origin of a local frame is rounded


class SeabedFileError(ValueError):
    """A seabed file that cannot be used: `file: place: what is wrong. what to do`."""


def existing(path: str | Path) -> Path:
    """Return the path of a file; FileNotFoundError when there is none."""
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    return path


def parsed(reader: str, path: Path, *, limits: Limits, **arguments: Any) -> dict[str, NDArray[Any]]:
    """Return what a reader in a child process makes of a file, see `read_foreign`.

    Raises
    ------
    SeabedFileError
        A line for each fault of the file.
    """
    try:
        return read_foreign(reader, path, limits=limits, **arguments)
    except ForeignFileError as error:
        raise SeabedFileError(str(error)) from None


def require_crs(crs: CRS | None, *, epsg: int, path: Path) -> None:
    """Refuse a horizontal CRS other than the scenario's, or one not in metres.

    Raises
    ------
    SeabedFileError
        Saying what the file has and what was expected.
    """
    wanted = CRS.from_epsg(epsg)
    if not wanted.is_projected or any(a.unit_conversion_factor != 1 for a in wanted.axis_info):
        raise SeabedFileError(f"{path}: EPSG:{epsg} is not a projected CRS in metres. choose one")
    if crs is None:
        raise SeabedFileError(
            f"{path}: crs: none in the file. give it one, EPSG:{epsg} is expected"
        )
    flat = crs.sub_crs_list[0] if crs.is_compound else crs
    flat = flat.to_2d()
    if not flat.is_projected:
        raise SeabedFileError(
            f"{path}: crs: {flat.name} is not projected. reproject the file to EPSG:{epsg}"
        )
    unit = flat.axis_info[0].unit_name
    if flat.axis_info[0].unit_conversion_factor != 1:
        raise SeabedFileError(
            f"{path}: crs: {flat.name} counts in {unit}. reproject the file to EPSG:{epsg}"
        )
    if flat.to_epsg(min_confidence=20) != epsg and not flat.equals(wanted, ignore_axis_order=True):
        raise SeabedFileError(
            f"{path}: crs: {flat.name}, but the scenario says EPSG:{epsg} ({wanted.name}). "
            "reproject the file or change the scenario"
        )


def frame_near(*, east: float, north: float, epsg: int, vertical_epsg: int) -> MapFrame:
    """Return a local frame whose origin is a map point rounded to 100 m.

    Examples
    --------
    >>> frame_near(east=902133.0, north=274871.0, epsg=32119, vertical_epsg=5703).easting
    902100.0
    """
    return MapFrame(
        easting=round(east / FRAME_STEP) * FRAME_STEP,
        northing=round(north / FRAME_STEP) * FRAME_STEP,
        epsg=epsg,
        vertical_epsg=vertical_epsg,
    )

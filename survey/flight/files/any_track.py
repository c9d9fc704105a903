"""Trajectories of every known format, read in a child process."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS

from survey.flight.files.cblue_file import read_cblue
from survey.flight.files.csv_file import read_csv_track
from survey.flight.files.faults import FlightFileError
from survey.flight.files.sbet_file import read_sbet
from survey.flight.track import Track
from terrain.foreign.faults import ForeignFileError, ReaderError
from terrain.foreign.limits import limits_for_whole
from terrain.foreign.reading import read_foreign


def read_track(path: Path, *, kind: str, epsg: int, prefix: str = "") -> Track:
    """Return the track of a file on a map.

    Parameters
    ----------
    path : Path
    kind : str
        Its format: csv, cblue or sbet.
    epsg : int
        Of the map.
    prefix : str
        Of the names of places and angles in a CSV file.

    Raises
    ------
    pyproj.exceptions.CRSError
        When there is no such map.
    FlightFileError
        With every fault of the file.
    """
    CRS.from_epsg(epsg)
    try:
        columns = read_foreign(
            "survey.flight.files.any_track:track_columns",
            path,
            limits=limits_for_whole(path),
            kind=kind,
            epsg=epsg,
            prefix=prefix,
        )
    except ForeignFileError as error:
        raise FlightFileError(path, list(error.faults)) from None
    return Track(**columns)


def track_columns(
    path: str, *, kind: str, epsg: int, prefix: str
) -> dict[str, NDArray[np.float64]]:
    """Return the columns of a track, in the child.

    Raises
    ------
    ReaderError
        With every fault of the file.
    """
    try:
        if kind == "csv":
            return asdict(read_csv_track(Path(path), epsg=epsg, prefix=prefix))
        reader = {"cblue": read_cblue, "sbet": read_sbet}[kind]
        return asdict(reader(Path(path), epsg=epsg))
    except FlightFileError as error:
        raise ReaderError(*error.faults) from error

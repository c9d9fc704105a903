"""Trajectories and areas of every known format, read in a child process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS

from survey.flight.files import geojson_file
from survey.flight.files.cblue_file import read_cblue
from survey.flight.files.csv_file import read_csv_track
from survey.flight.files.faults import FlightFileError
from survey.flight.files.sbet_file import read_sbet
from survey.flight.track import Track
from terrain.foreign.faults import ForeignFileError, ReaderError
from terrain.foreign.limits import limits_for_whole
from terrain.foreign.reading import read_foreign
from terrain.foreign.text_table import few

FloatArray = NDArray[np.float64]

FASTEST = 1000.0  # [m/s]


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
    return Track(**_from_child("track_columns", path, kind=kind, epsg=epsg, prefix=prefix))


def read_area(path: Path, *, epsg: int) -> FloatArray:
    """Return the corners (n, 2) of the polygon in a GeoJSON file on a map [m].

    Raises as `read_track`.
    """
    return _from_child("area_corners", path, epsg=epsg)["corners"]


def _from_child(reader: str, path: Path, *, epsg: int, **arguments: Any) -> dict[str, FloatArray]:
    CRS.from_epsg(epsg)
    limits = limits_for_whole(path)
    try:
        return read_foreign(f"{__name__}:{reader}", path, limits=limits, epsg=epsg, **arguments)
    except ForeignFileError as error:
        raise FlightFileError(path, list(error.faults)) from None


def track_columns(path: str, *, kind: str, epsg: int, prefix: str) -> dict[str, FloatArray]:
    """Return the columns of a track, in the child.

    Raises
    ------
    ReaderError
        With every fault of the file.
    """
    with _told_to_the_parent():
        if kind == "csv":
            track = read_csv_track(Path(path), epsg=epsg, prefix=prefix)
        else:
            track = {"cblue": read_cblue, "sbet": read_sbet}[kind](Path(path), epsg=epsg)
        if faults := _jumps(track):
            raise FlightFileError(Path(path), few(faults))
        return asdict(track)


def _jumps(track: Track) -> list[str]:
    """Return where a track goes faster than any aircraft."""
    way = np.linalg.norm(np.diff(track.position, axis=0), axis=1)
    apart = np.diff(track.time)
    return [
        f"at {track.time[i + 1]:.12g} s it jumps by {way[i]:.3g} m in {apart[i]:.3g} s. "
        "Leave out false places, or correct the longitude"
        for i in np.flatnonzero(np.isfinite(way) & (way > FASTEST * apart))
    ]


def area_corners(path: str, *, epsg: int) -> dict[str, FloatArray]:
    """Return the corners of an area, in the child; raises as `track_columns`."""
    with _told_to_the_parent():
        return {"corners": geojson_file.read_area(Path(path), epsg=epsg)}


@contextmanager
def _told_to_the_parent() -> Iterator[None]:
    try:
        yield
    except FlightFileError as error:
        raise ReaderError(*error.faults) from error

"""The trajectory text that cBLUE reads: 15 columns without a header, apart by spaces.

Time [s], longitude, latitude [deg], x, y, z [m], roll, pitch, heading [deg], and the standard
deviations of x, y, z [m], roll, pitch, heading [deg]. cBLUE (cBLUE-dev-team, LGPL-2.1) takes times
up to 604800 for seconds of the GPS week of the day that the file's name begins with, others for
adjusted standard GPS time. The heading counts from true north.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.flight.files.faults import FlightFileError, text_of, track_faults
from survey.flight.track import Track
from terrain.foreign.text_table import numbers

FloatArray = NDArray[np.float64]

NAMES = (
    *("time", "lon", "lat", "x", "y", "z", "roll", "pitch", "heading"),
    *("std_x", "std_y", "std_z", "std_roll", "std_pitch", "std_heading"),
)
NEEDED = ("time", "lon", "lat", "z", "roll", "pitch", "heading")
LIMITS = {"lon": 360.0, "lat": 90.0, "z": 1e5, "roll": 180.0, "pitch": 90.0, "heading": 720.0}
FORMATS = ("%.6f", "%.10f", "%.10f", *["%.4f"] * 3, *["%.6f"] * 3, *["%.4f"] * 3, *["%.6f"] * 3)


def read_cblue(path: Path, *, epsg: int) -> Track:
    """Return the track of a cBLUE trajectory on a map.

    The place is that of longitude and latitude: on which map x and y lie the file does not say.

    Raises
    ------
    FlightFileError
        With every kind of fault: columns, numbers that are none, time that runs back.
    """
    rows = text_of(path).splitlines()
    try:
        table = numbers(rows, names=NAMES, separator=None, first_line=1)
    except ValueError as error:
        raise FlightFileError(path, str(error).splitlines()) from error
    columns = {name: table[:, NAMES.index(name)] for name in NEEDED}
    lines = [number for number, row in enumerate(rows, start=1) if row.strip()]
    faults = track_faults(columns, place=lambda i: f"line {lines[i]}", limits=LIMITS)
    if faults:
        raise FlightFileError(path, faults)
    return Track.from_geographic(
        time=columns["time"],
        longitude=np.radians(columns["lon"]),
        latitude=np.radians(columns["lat"]),
        height=columns["z"],
        roll=np.radians(columns["roll"]),
        pitch=np.radians(columns["pitch"]),
        true_heading=np.radians(columns["heading"]),
        epsg=epsg,
    )


def cblue_text(track: Track, *, epsg: int, deviations: tuple[float, ...]) -> str:
    """Return a track on a map as the text of a cBLUE trajectory.

    Parameters
    ----------
    track : Track
    epsg : int
        Of the map: x and y are its easting and northing, z the track's height.
    deviations : tuple of float
        Standard deviations of x, y, z [m], roll, pitch, heading [rad].
    """
    longitude, latitude, heading = track.geographic(epsg=epsg)
    angles = np.degrees(np.column_stack([track.roll, track.pitch, heading]))
    spread = [*deviations[:3], *np.degrees(deviations[3:])]
    table = np.column_stack(
        [
            track.time,
            np.degrees(longitude),
            np.degrees(latitude),
            track.position,
            angles,
            np.tile(spread, (len(track.time), 1)),
        ]
    )
    row = " ".join(FORMATS)
    return "".join(f"{row % tuple(values)}\n" for values in table)

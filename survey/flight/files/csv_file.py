"""Trajectories as CSV with named columns, in any order; other columns are left alone.

``time_s``; ``easting_m``, ``northing_m``, ``up_m`` on the map, or ``lon_deg``, ``lat_deg``,
``alt_m``; ``roll_deg``, ``pitch_deg``, ``heading_deg``, or the unit quaternion ``qw``, ``qx``,
``qy``, ``qz`` that turns (forward, right, down) into (north, east, down). With easting and northing
north is grid north, with longitude and latitude it is true north.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.flight.files.faults import FlightFileError, text_of, track_faults
from survey.flight.track import Track
from terrain.extent import FARTHEST
from terrain.foreign.text_table import doubled, few, numbers

FloatArray = NDArray[np.float64]

TIME = "time_s"
ON_MAP = ("easting_m", "northing_m", "up_m")
GEOGRAPHIC = ("lon_deg", "lat_deg", "alt_m")
ANGLES = ("roll_deg", "pitch_deg", "heading_deg")
QUATERNION = ("qw", "qx", "qy", "qz")
LIMITS = {
    **{"easting_m": FARTHEST, "northing_m": FARTHEST},
    **{"lon_deg": 360.0, "lat_deg": 90.0, "alt_m": 1e5, "up_m": 1e5},
    **{"roll_deg": 180.0, "pitch_deg": 90.0, "heading_deg": 720.0},
}
UNIT_TOLERANCE = 1e-3


def read_csv_track(path: Path, *, epsg: int, prefix: str = "") -> Track:
    """Return the track of a CSV file on a map.

    Parameters
    ----------
    path : Path
    epsg : int
        Of the map.
    prefix : str
        That the names of places and angles begin with: ``true_`` or ``measured_`` for a run's
        ``trajectory.csv``.

    Raises
    ------
    FlightFileError
        With every fault: columns that are missing, rows of another length, numbers that are none,
        time that runs back, quaternions that are not of unit length.
    """
    header, *rows = text_of(path).splitlines() or [""]
    names = tuple(name.strip() for name in header.split(","))
    place = _chosen(names, prefix, ON_MAP, GEOGRAPHIC)
    attitude = _chosen(names, prefix, ANGLES, QUATERNION)
    missing = [
        f"line 1: no column {name}. It has {', '.join(names)}"
        for name in (TIME, *(prefix + name for name in (*place, *attitude)))
        if name not in names
    ]
    used = [name for name in names if name.removeprefix(prefix) in (TIME, *place, *attitude)]
    if faults := missing + doubled(used):
        raise FlightFileError(path, faults)
    try:
        table = numbers(rows, names=names, separator=",", first_line=2)
    except ValueError as error:
        raise FlightFileError(path, str(error).splitlines()) from error
    columns = {TIME: table[:, names.index(TIME)]}
    columns |= {name: table[:, names.index(prefix + name)] for name in (*place, *attitude)}
    faults = _faults(columns, rows)
    if faults:
        raise FlightFileError(path, faults)
    return _track(columns, epsg)


def _chosen(
    names: tuple[str, ...], prefix: str, first: tuple[str, ...], second: tuple[str, ...]
) -> tuple[str, ...]:
    """Return which of two sets of columns a file has more of, the first if in doubt."""
    held = [sum(prefix + name in names for name in each) for each in (first, second)]
    return second if held[1] > held[0] else first


def _faults(columns: dict[str, FloatArray], rows: list[str]) -> list[str]:
    lines = [number for number, row in enumerate(rows, start=2) if row.strip()]
    faults = track_faults(columns, place=lambda i: f"line {lines[i]}", limits=LIMITS)
    if "qw" in columns:
        length = np.sqrt(sum(columns[name] ** 2 for name in QUATERNION))
        off = np.flatnonzero(np.abs(length - 1.0) > UNIT_TOLERANCE)
        faults += few(
            [f"line {lines[i]}: the quaternion is {length[i]:.6g} long, not 1" for i in off]
        )
    return faults


def _track(columns: dict[str, FloatArray], epsg: int) -> Track:
    roll, pitch, heading = _attitude(columns)
    if "easting_m" in columns:
        return Track(
            time=columns[TIME],
            position=np.column_stack([columns[name] for name in ON_MAP]),
            roll=roll,
            pitch=pitch,
            heading=heading % (2.0 * np.pi),
        )
    return Track.from_geographic(
        time=columns[TIME],
        longitude=np.radians(columns["lon_deg"]),
        latitude=np.radians(columns["lat_deg"]),
        height=columns["alt_m"],
        roll=roll,
        pitch=pitch,
        true_heading=heading,
        epsg=epsg,
    )


def _attitude(columns: dict[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return roll, pitch, heading [rad]."""
    if "roll_deg" in columns:
        roll, pitch, heading = (np.radians(columns[name]) for name in ANGLES)
        return roll, pitch, heading
    from scipy.spatial.transform import Rotation

    quaternions = np.column_stack([columns[name] for name in QUATERNION])
    heading, pitch, roll = Rotation.from_quat(quaternions, scalar_first=True).as_euler("ZYX").T
    return roll, pitch, heading

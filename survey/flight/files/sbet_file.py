"""Binary SBET: the smoothed best estimate of a trajectory, 17 doubles a record.

Little-endian, after Applanix' POSPac: time [s of the GPS week], latitude, longitude [rad],
ellipsoidal height [m], velocities [m/s], roll, pitch, platform heading, wander angle [rad], body
accelerations [m/s2], body angular rates [rad/s]. Roll is positive with the right side down, pitch
with the nose up. The heading from true north is the platform heading less the wander angle, and
velocities lie along north, west, up turned by it: so it is in the samples of real flights.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.flight.files.faults import (
    LARGEST_TRACK_BYTES,
    FlightFileError,
    content_of,
    track_faults,
)
from survey.flight.track import Track

FloatArray = NDArray[np.float64]

FIELDS = (
    *("time", "latitude", "longitude", "height", "velocity_x", "velocity_y", "velocity_z"),
    *("roll", "pitch", "heading", "wander", "acceleration_x", "acceleration_y", "acceleration_z"),
    *("rate_x", "rate_y", "rate_z"),
)
NEEDED = ("time", "latitude", "longitude", "height", "roll", "pitch", "heading", "wander")
RECORD = np.dtype([(name, "<f8") for name in FIELDS])
LIMITS = {
    **{"latitude": 0.5 * np.pi, "longitude": 2.0 * np.pi, "height": 1e5},
    **{"roll": np.pi, "pitch": 0.5 * np.pi, "heading": 4.0 * np.pi, "wander": 4.0 * np.pi},
}


def read_sbet(path: Path, *, epsg: int) -> Track:
    """Return the track of an SBET file on a map.

    Parameters
    ----------
    path : Path
    epsg : int
        Of the map.

    Raises
    ------
    FlightFileError
        With every kind of fault: cut off, numbers that are none, time that runs back.
    """
    content = content_of(path, largest=LARGEST_TRACK_BYTES)
    beyond = len(content) % RECORD.itemsize
    if beyond:
        text = (
            f"{len(content)} bytes are no whole number of records of {RECORD.itemsize}: cut off, "
            f"or no SBET. Leave off the last {beyond} bytes, or fetch the file again"
        )
        raise FlightFileError(path, [text])
    records = np.frombuffer(content, RECORD)
    columns = {name: records[name].astype(np.float64) for name in NEEDED}
    faults = track_faults(columns, place=lambda i: f"record {i}", limits=LIMITS)
    if faults:
        raise FlightFileError(path, faults)
    return Track.from_geographic(
        time=columns["time"],
        longitude=columns["longitude"],
        latitude=columns["latitude"],
        height=columns["height"],
        roll=columns["roll"],
        pitch=columns["pitch"],
        true_heading=columns["heading"] - columns["wander"],
        epsg=epsg,
    )


def sbet_bytes(track: Track, *, epsg: int) -> bytes:
    """Return a track on a map as the content of an SBET file.

    Velocities are differences of places, 0 for a single one; the wander angle, accelerations and
    angular rates are 0. Heights are the track's.
    """
    longitude, latitude, heading = track.geographic(epsg=epsg)
    records = np.zeros(len(track.time), RECORD)
    velocity = _velocities(track)
    turn = heading - track.heading
    east, north = velocity[:, 0], velocity[:, 1]
    values = {
        "time": track.time,
        "latitude": latitude,
        "longitude": longitude,
        "height": track.position[:, 2],
        "velocity_x": north * np.cos(turn) - east * np.sin(turn),
        "velocity_y": -(east * np.cos(turn) + north * np.sin(turn)),
        "velocity_z": velocity[:, 2],
        "roll": track.roll,
        "pitch": track.pitch,
        "heading": (heading + np.pi) % (2.0 * np.pi) - np.pi,
    }
    for name, column in values.items():
        records[name] = column
    return records.tobytes()


def _velocities(track: Track) -> FloatArray:
    """Return (n, 3) towards east, north, up on the map [m/s]."""
    if len(track.time) < 2:
        return np.zeros_like(track.position)
    return np.asarray(np.gradient(track.position, track.time, axis=0))

"""The measured trajectory in the formats of other programs: binary SBET, and cBLUE's text."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from survey.flight.files.cblue_file import cblue_text
from survey.flight.files.sbet_file import sbet_bytes
from survey.flight.pose import Frame
from survey.flight.track import Track
from survey.products.gps_time import ADJUSTED_STANDARD_OFFSET_S, adjusted_gps_time
from survey.products.writing import write_whole
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]

TrackFormat = Literal["cblue", "sbet"]
WEEK_S = 604_800.0


def write_trajectory_files(
    folder: Path,
    frames: Sequence[Frame],
    map_frame: MapFrame,
    *,
    formats: Sequence[TrackFormat],
    start_utc: datetime,
    deviations: tuple[float, ...],
) -> None:
    """Write where navigation says the sensor was, one record a flash.

    ``trajectory.sbet`` counts seconds of the GPS week; ``YYYYMMDD_trajectory.txt``, a name that
    cBLUE asks for, counts adjusted standard GPS time as the clouds do. Heights are those of the
    mission's vertical datum, not ellipsoidal ones.

    Parameters
    ----------
    folder : Path
    frames : sequence of Frame
        In the order of flight, in the local frame.
    map_frame : MapFrame
        Where that frame lies on the map.
    formats : sequence of {"cblue", "sbet"}
    start_utc : datetime
        Start of the mission.
    deviations : tuple of float
        Standard deviations of x, y, z [m], roll, pitch, heading [rad].
    """
    if not formats:
        return
    time = adjusted_gps_time(start_utc, np.array([frame.time for frame in frames]))
    if "sbet" in formats:
        track = measured_track(frames, map_frame, (time + ADJUSTED_STANDARD_OFFSET_S) % WEEK_S)
        write_whole(folder / "trajectory.sbet", sbet_bytes(track, epsg=map_frame.epsg))
    if "cblue" in formats:
        track = measured_track(frames, map_frame, time)
        text = cblue_text(track, epsg=map_frame.epsg, deviations=deviations)
        name = f"{start_utc.astimezone(UTC):%Y%m%d}_trajectory.txt"
        write_whole(folder / name, text.encode("ascii"))


def measured_track(frames: Sequence[Frame], map_frame: MapFrame, time: FloatArray) -> Track:
    """Return the measured poses as a track on the map, at times (n,) [s]."""
    poses = [frame.measured for frame in frames]
    return Track(
        time=time,
        position=map_frame.to_map(np.array([pose.position for pose in poses])),
        roll=np.array([pose.roll for pose in poses]),
        pitch=np.array([pose.pitch for pose in poses]),
        heading=np.array([pose.heading for pose in poses]),
    )

"""The section [flight] turned into the plan of a flight, in SI units and radians.

`survey.flight` is imported when a flight is built, so that checking a scenario stays quick.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import cos, radians, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.scenario import flight_sections as kinds
from survey.scenario.file_stamp import stamp_of
from survey.scenario.sections import Flight

if TYPE_CHECKING:
    from survey.flight.profile import Profile
    from survey.flight.track import Track
    from survey.flight.trajectory import Plan

FloatArray = NDArray[np.float64]

FORMAT_OF_SUFFIX: dict[str, kinds.TrackFormat] = {
    ".csv": "csv",
    ".txt": "cblue",
    ".out": "sbet",
    ".sbet": "sbet",
}


def build_plan(
    given: Flight,
    *,
    view: tuple[float, float],
    water_level_m: float,
    origin: tuple[float, float],
    epsg: int,
    folder: Path,
) -> Plan:
    """Return the plan of a flight in a local frame.

    Parameters
    ----------
    given : Flight
        One of the sections of `survey.scenario.flight_sections`.
    view : tuple of float
        Half of the field of view forward and to the right, as tangents.
    water_level_m : float
        In the vertical datum.
    origin : tuple of float
        Easting and northing of the local frame [m].
    epsg : int
        Of the map.
    folder : Path
        Folder from which files are reached.

    Raises
    ------
    FlightFileError
        When a file cannot be used.
    """
    if isinstance(given, kinds.RecordedFlight):
        return _recorded(given, water_level_m, origin, epsg, folder)
    assert isinstance(given, kinds.PlannedFlight)
    common = _common(given, view, water_level_m)
    if isinstance(given, kinds.AreaFlight):
        from survey.flight.area import AreaPlan

        return AreaPlan(
            polygon=area_corners(given, epsg=epsg, folder=folder) - np.array(origin),
            view_length=2.0 * view[0] * given.heights_m[0],
            cross_lines=given.cross_lines,
            **common,
        )
    from survey.flight.plan import FlightPlan

    assert isinstance(given, kinds.LinesFlight)
    return FlightPlan(
        start=(given.start_easting_m - origin[0], given.start_northing_m - origin[1]),
        frames_per_line=given.frames_per_line,
        lines=given.lines,
        **common,
    )


def _common(
    given: kinds.PlannedFlight, view: tuple[float, float], water_level_m: float
) -> dict[str, Any]:
    """Return what all plans of straight lines need; the swath is that of the least height."""
    from_wind, speed = radians(given.wind_from_deg), given.wind_speed_m_s
    return {
        "heading": radians(given.heading_deg),
        "height": given.height_m,
        "water_level": water_level_m,
        "speed": given.speed_m_s,
        "flash_rate": given.flash_rate_hz,
        "swath": 2.0 * view[1] * given.heights_m[0],
        "sidelap": given.sidelap,
        "turn": given.turn,
        "turn_time": given.turn_time_s,
        "turn_bank": None if given.turn_bank_deg is None else radians(given.turn_bank_deg),
        "height_profile": _profile([(s.distance_m, s.height_m) for s in given.height_profile]),
        "speed_profile": _profile([(s.distance_m, s.speed_m_s) for s in given.speed_profile]),
        "wind": (-speed * sin(from_wind), -speed * cos(from_wind)) if speed else (0.0, 0.0),
    }


def _profile(steps: Sequence[tuple[float, float]]) -> Profile | None:
    from survey.flight.profile import Profile

    if not steps:
        return None
    distances, values = zip(*steps, strict=True)
    return Profile(distances=distances, values=values)


def _recorded(
    given: kinds.RecordedFlight,
    water_level_m: float,
    origin: tuple[float, float],
    epsg: int,
    folder: Path,
) -> Plan:
    from survey.flight.recorded import RecordedPlan

    track = read_track(given, epsg=epsg, folder=folder)
    return RecordedPlan(
        track=track.moved(np.array([-origin[0], -origin[1], 0.0])),
        legs=legs(given, track),
        flash_rate=given.flash_rate_hz,
        height=given.height_m,
        water_level=water_level_m,
    )


def legs(given: kinds.RecordedFlight, track: Track) -> tuple[tuple[float, float], ...]:
    """Return beginnings and ends of the legs since the track's first time [s]."""
    if not given.legs_s:
        return ((0.0, float(track.time[-1] - track.time[0])),)
    return tuple((begin, end) for begin, end in given.legs_s)


def read_track(given: kinds.RecordedFlight, *, epsg: int, folder: Path) -> Track:
    """Return the track of a recorded flight on the map, offsets added.

    Raises
    ------
    FlightFileError
        With every kind of fault of the file.
    """
    path = folder / given.file
    kind = track_format(given)
    if kind is None:
        raise ValueError(f"{path}: of no known format. Say it with flight.format")
    track = _read_track(path, stamp_of(path), kind, given.column_prefix, epsg)
    offset = (given.offset_easting_m, given.offset_northing_m, given.offset_up_m)
    return track.moved(np.array(offset))


def sound_track(given: kinds.RecordedFlight, *, epsg: int, folder: Path) -> Track | None:
    """Return the track of a recorded flight; None where it cannot be read."""
    try:
        track = read_track(given, epsg=epsg, folder=folder)
    except (OSError, ValueError, RuntimeError):
        return None
    return track if np.isfinite(track.position).all() else None


def sound_corners(given: kinds.AreaFlight, *, epsg: int, folder: Path) -> FloatArray | None:
    """Return the corners (n, 2) of an area; None where there is none."""
    from survey.flight.polygon import polygon_faults

    try:
        corners = area_corners(given, epsg=epsg, folder=folder)
    except (OSError, ValueError, RuntimeError):
        return None
    return None if polygon_faults(corners) else corners


def track_format(given: kinds.RecordedFlight) -> kinds.TrackFormat | None:
    """Return the format of a track's file, as told or by its name; None where neither tells it."""
    return given.format or FORMAT_OF_SUFFIX.get(Path(given.file).suffix.lower())


@lru_cache(maxsize=4)
def _read_track(
    path: Path, stamp: tuple[int, int], kind: kinds.TrackFormat, prefix: str, epsg: int
) -> Track:
    """Read a track once; another time or size of the file is another file."""
    from survey.flight.files import foreign

    return foreign.read_track(path, kind=kind, epsg=epsg, prefix=prefix)


def area_corners(given: kinds.AreaFlight, *, epsg: int, folder: Path) -> FloatArray:
    """Return the corners (n, 2) of an area on the map [m].

    Raises
    ------
    FlightFileError
        When its file cannot be used.
    """
    if given.file is None:
        corners = np.array(given.corners_m, dtype=np.float64).reshape(-1, 2)
        closed = len(corners) > 1 and bool((corners[0] == corners[-1]).all())
        return corners[:-1] if closed else corners
    path = folder / given.file
    return _read_area(path, stamp_of(path), epsg)


@lru_cache(maxsize=4)
def _read_area(path: Path, stamp: tuple[int, int], epsg: int) -> FloatArray:
    from survey.flight.files import foreign

    return foreign.read_area(path, epsg=epsg)


def beginning(plan: Plan) -> tuple[FloatArray, float]:
    """Return where a flight begins (2,) [m] and which way its first line runs [rad]."""
    from survey.flight.trajectory import fly_lines

    first = fly_lines(plan)[0].pose
    return first.position[:2], getattr(plan, "heading", first.heading)


def start_on_map(given: Flight, *, epsg: int, folder: Path) -> tuple[float, float]:
    """Return easting and northing near which a flight begins [m]."""
    if isinstance(given, kinds.LinesFlight):
        return given.start_easting_m, given.start_northing_m
    if isinstance(given, kinds.AreaFlight):
        east, north = area_corners(given, epsg=epsg, folder=folder).min(axis=0)
    else:
        assert isinstance(given, kinds.RecordedFlight)
        east, north, _ = read_track(given, epsg=epsg, folder=folder).position[0]
    return float(east), float(north)

"""Rules that bind the keys of a flight together, to its files, and to the receiver's gate."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from math import radians
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.scenario import flight_sections as kinds
from survey.scenario.faults import Fault, missing_file
from survey.scenario.flight_parts import (
    FORMAT_OF_SUFFIX,
    area_corners,
    legs,
    read_track,
    sound_corners,
    sound_track,
    track_format,
)
from survey.scenario.motion_sections import Motion
from survey.scenario.sections import Camera, Flight, Mission

FloatArray = NDArray[np.float64]

LARGEST_FRAME_COUNT = 1_000_000
LARGEST_LINE_COUNT = 3_000
WIDEST_SWING = 4.0  # of the r.m.s.: one flash in 16,000 goes beyond


def files_can_be_flown(flight: Flight, mission: Mission, folder: Path) -> Iterator[Fault]:
    """Areas and trajectories can be read, lie on the map, and are sound."""
    file = getattr(flight, "file", None)
    if isinstance(flight, kinds.AreaFlight) and (file is None) == (flight.corners_m is None):
        yield Fault("flight.corners_m", "give an area its corners_m or a file, one of them.")
    elif file is not None and (missing := list(missing_file("flight.file", file, folder))):
        yield from missing
    elif isinstance(flight, kinds.AreaFlight):
        yield from _area_faults(flight, mission.crs_epsg, folder)
    elif isinstance(flight, kinds.RecordedFlight):
        yield from _track_faults(flight, mission.crs_epsg, folder)


def _area_faults(flight: kinds.AreaFlight, epsg: int, folder: Path) -> Iterator[Fault]:
    from pyproj.exceptions import CRSError

    from survey.flight.files.faults import FlightFileError
    from survey.flight.polygon import polygon_faults

    place = "flight.corners_m" if flight.file is None else "flight.file"
    name = "" if flight.file is None else f"{flight.file}: "
    try:
        corners = area_corners(flight, epsg=epsg, folder=folder)
    except FlightFileError as error:
        yield from (Fault(place, f"{name}{text}.") for text in error.faults)
    except CRSError:
        return  # said of mission.crs_epsg
    else:
        yield from (Fault(place, f"{name}{text}.") for text in polygon_faults(corners))


def _track_faults(flight: kinds.RecordedFlight, epsg: int, folder: Path) -> Iterator[Fault]:
    from pyproj.exceptions import CRSError

    from survey.flight.files.faults import FlightFileError

    if track_format(flight) is None:
        known = ", ".join(FORMAT_OF_SUFFIX)
        yield Fault("flight.format", f"the file's name ends in none of {known}. Say the format.")
        return
    try:
        track = read_track(flight, epsg=epsg, folder=folder)
    except FlightFileError as error:
        yield from (Fault("flight.file", f"{flight.file}: {text}.") for text in error.faults)
        return
    except CRSError:
        return  # said of mission.crs_epsg
    if not np.isfinite(track.position).all():
        yield Fault("flight.file", f"{flight.file}: places lie outside the map EPSG:{epsg}.")
    yield from _leg_faults(flight, float(track.time[-1] - track.time[0]))


def _leg_faults(flight: kinds.RecordedFlight, duration: float) -> Iterator[Fault]:
    after = 0.0
    for number, (begin, end) in enumerate(flight.legs_s):
        place = f"flight.legs_s.{number}"
        if not after <= begin <= end:
            yield Fault(place, f"[{begin:g}, {end:g}] does not follow {after:g} s. Sort the legs.")
        elif end > duration:
            yield Fault(place, f"{end:g} s is beyond the file's last record at {duration:g} s.")
        after = end


def profiles_ascend(flight: Flight) -> Iterator[Fault]:
    """The places of a profile follow each other along the heading."""
    for name in ("height_profile", "speed_profile"):
        steps = getattr(flight, name, [])
        for number, (one, other) in enumerate(pairwise(steps), start=1):
            if other.distance_m <= one.distance_m:
                yield Fault(
                    f"flight.{name}.{number}.distance_m",
                    f"{other.distance_m:g} is not beyond {one.distance_m:g} before it. Sort them.",
                )


def wind_is_slower_than_the_aircraft(flight: Flight) -> Iterator[Fault]:
    """An aircraft that keeps to its line makes headway against the wind."""
    if not isinstance(flight, kinds.PlannedFlight):
        return
    speed = min([step.speed_m_s for step in flight.speed_profile] or [flight.speed_m_s])
    if flight.wind_speed_m_s >= speed:
        yield Fault(
            "flight.wind_speed_m_s",
            f"{flight.wind_speed_m_s:g} is not below the ground speed of {speed:g}. Lower it.",
        )


def recorded_motion_is_in_the_file(flight: Flight, motion: Motion) -> Iterator[Fault]:
    """A recorded flight moves as its file says."""
    if isinstance(flight, kinds.RecordedFlight) and motion != Motion(source=motion.source):
        yield Fault("motion", "the trajectory's file has the motion. Leave this section out.")


def mission_is_finite(
    flight: Flight, camera: Camera, mission: Mission, folder: Path
) -> Iterator[Fault]:
    """A mission has no more frames than file names have digits."""
    count, place = _frame_count(flight, camera, mission, folder)
    if count > LARGEST_FRAME_COUNT:
        yield Fault(place, f"{count} frames in all. Stay below {LARGEST_FRAME_COUNT}.")


def _frame_count(flight: Flight, camera: Camera, mission: Mission, folder: Path) -> tuple[int, str]:
    """Return how many frames a flight has, estimated for an area, and the key to blame."""
    if isinstance(flight, kinds.LinesFlight):
        return flight.lines * flight.frames_per_line, "flight.frames_per_line"
    if isinstance(flight, kinds.RecordedFlight):
        track = sound_track(flight, epsg=mission.crs_epsg, folder=folder)
        flown = [] if track is None else legs(flight, track)
        seconds = sum(end - begin for begin, end in flown)
        return int(seconds * flight.flash_rate_hz), "flight.flash_rate_hz"
    assert isinstance(flight, kinds.AreaFlight)
    from survey.flight.polygon import signed_area

    corners = sound_corners(flight, epsg=mission.crs_epsg, folder=folder)
    if corners is None:
        return 0, ""
    length = abs(signed_area(corners)) / _line_spacing_m(flight, camera)
    return int(length * flight.flash_rate_hz / flight.speed_m_s), "flight.flash_rate_hz"


def area_takes_few_lines(
    flight: Flight, camera: Camera, mission: Mission, folder: Path
) -> Iterator[Fault]:
    """An area is not so wide that a corner of it must be elsewhere."""
    if not isinstance(flight, kinds.AreaFlight):
        return
    from survey.flight.plan import unit_axes

    corners = sound_corners(flight, epsg=mission.crs_epsg, folder=folder)
    if corners is None:
        return
    width = float(np.ptp(corners @ unit_axes(radians(flight.heading_deg))[1]))
    spacing = _line_spacing_m(flight, camera)
    if width > LARGEST_LINE_COUNT * spacing:
        yield Fault(
            "flight.heading_deg",
            f"the area is {width:.0f} m wide across it, {width / spacing:.0f} lines. Stay below "
            f"{LARGEST_LINE_COUNT}: turn the heading, or look for a corner that lies elsewhere.",
        )


def _line_spacing_m(flight: kinds.AreaFlight, camera: Camera) -> float:
    tangent = camera.pixel_footprint_m / camera.design_range_m
    side = camera.rows if camera.long_side == "along" else camera.columns
    return side * tangent * flight.heights_m[0] * (1.0 - flight.sidelap)


FLIGHT_RULES: tuple[Callable[..., Iterator[Fault]], ...] = (
    files_can_be_flown,
    profiles_ascend,
    wind_is_slower_than_the_aircraft,
    recorded_motion_is_in_the_file,
    mission_is_finite,
    area_takes_few_lines,
)

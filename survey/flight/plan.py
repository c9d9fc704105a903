"""The flight as it is ordered: straight lines over the water."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from survey.flight.pose import FULL_TURN
from survey.flight.profile import Profile, even_times
from survey.flight.turns import shortest_turn, turn_radius

FloatArray = NDArray[np.float64]

STILL_AIR = (0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class SurveyLine:
    """One straight line and the flashes on it.

    Parameters
    ----------
    axis : float
        Heading in which distances along the line are counted [rad].
    origin : tuple of float
        Easting and northing from which they are counted [m].
    offset : float
        Of the line to the right of the origin [m].
    along : array (n,)
        Distances of the flashes in the order of flight [m].
    times : array (n,)
        Since the line's first flash [s].
    course : float
        Direction of flight [rad]: the axis, or the way back.
    """

    axis: float
    origin: tuple[float, float]
    offset: float
    along: FloatArray
    times: FloatArray
    course: float

    @property
    def places(self) -> FloatArray:
        """Easting and northing of the flashes (n, 2) [m]."""
        ahead, right = unit_axes(self.axis)
        return self.origin + self.along[:, None] * ahead + self.offset * right


def unit_axes(axis: float) -> tuple[FloatArray, FloatArray]:
    """Return the unit vectors (east, north) along a heading and to the right of it."""
    ahead = np.array([np.sin(axis), np.cos(axis)])
    right = np.array([np.cos(axis), -np.sin(axis)])
    return ahead, right


@dataclass(frozen=True, kw_only=True)
class LinePlan:
    """What all plans of straight lines share: how the lines are flown.

    Parameters
    ----------
    heading : float
        Heading of the first line, clockwise from grid north [rad].
    height : float
        Height of the sensor above the water level, whatever the ground under it does [m].
    water_level : float
        Mean water level in the vertical datum [m].
    speed : float
        Ground speed [m/s].
    flash_rate : float
        Flashes a second [Hz].
    swath : float
        Width that one line sees at the water surface, across the flight [m].
    sidelap : float
        Part of the swath at the water surface that the next line sees again [1].
    turn : {"alternate", "same"}
        Which way every second line is flown.
    turn_time : float
        Time between the last flash of a line and the first of the next [s].
    turn_bank : float, optional
        Bank of the turns [rad]: their time then is that of the shortest way from line to line.
    height_profile, speed_profile : Profile, optional
        Instead of the constant height and speed, by the distance along the heading from the
        first line's beginning; a way back sees the same at the same place.
    wind : tuple of float
        Velocity of the air towards east and north at flight height [m/s]. The aircraft keeps to
        its line and points into the wind: its heading is that of ground velocity less wind.
    """

    heading: float
    height: float
    water_level: float
    speed: float
    flash_rate: float
    swath: float
    sidelap: float
    turn: Literal["alternate", "same"]
    turn_time: float
    turn_bank: float | None = None
    height_profile: Profile | None = None
    speed_profile: Profile | None = None
    wind: tuple[float, float] = STILL_AIR

    @property
    def origin(self) -> tuple[float, float]:
        """Easting and northing from which the profiles count [m]."""
        raise NotImplementedError

    @property
    def line_spacing(self) -> float:
        """Distance between neighbouring lines [m]."""
        return self.swath * (1.0 - self.sidelap)

    @property
    def flash_spacing(self) -> float:
        """Distance between neighbouring flashes of a line at the plain speed [m]."""
        return self.speed / self.flash_rate

    @property
    def altitude(self) -> float:
        """Plain height of the sensor in the vertical datum [m]."""
        return self.water_level + self.height

    def altitudes(self, places: FloatArray) -> FloatArray:
        """Return the height of the sensor in the vertical datum at places (n, 2) [m]."""
        if self.height_profile is None:
            return np.full(len(places), self.altitude)
        return self.water_level + self.height_profile.at(self._along(places))

    def speeds(self, places: FloatArray) -> FloatArray:
        """Return the ground speed at places (n, 2) [m/s]."""
        if self.speed_profile is None:
            return np.full(len(places), self.speed)
        return self.speed_profile.at(self._along(places))

    def crabbed(self, course: float, speeds: FloatArray) -> FloatArray:
        """Return the headings (n,) that keep a course [rad] at ground speeds (n,) [m/s]."""
        if self.wind == STILL_AIR:
            return np.full(len(speeds), course)
        through_air = speeds[:, None] * unit_axes(course)[0] - np.array(self.wind)
        return np.asarray(np.arctan2(through_air[:, 0], through_air[:, 1]) % FULL_TURN)

    def turn_between(self, line: SurveyLine, following: SurveyLine) -> float:
        """Return the time from a line's last flash to the first of the next [s]."""
        if self.turn_bank is None:
            return self.turn_time
        length = shortest_turn(
            start=(*line.places[-1], line.course),
            end=(*following.places[0], following.course),
            radius=turn_radius(speed=self.speed, bank=self.turn_bank),
        )
        return length / self.speed

    def course(self, axis: float, *, backwards: bool) -> float:
        """Return the direction of flight along an axis or back [rad]."""
        return (axis + np.pi) % FULL_TURN if backwards else axis

    def _along(self, places: FloatArray) -> FloatArray:
        return np.asarray((places - np.array(self.origin)) @ unit_axes(self.heading)[0])


@dataclass(frozen=True, kw_only=True)
class FlightPlan(LinePlan):
    """Parallel lines with one flash after another at even times.

    The first line starts at `start`; each further line lies one spacing to its right. With
    ``turn = "alternate"`` every second line is flown back, with ``"same"`` all lines are flown the
    same way. Flashes of all lines lie abreast. The other parameters are those of `LinePlan`.

    Parameters
    ----------
    start : tuple of float
        Easting and northing of the first flash in the scene's local frame [m].
    frames_per_line, lines : int
        Flashes on each line, and lines.

    Examples
    --------
    >>> plan = FlightPlan(start=(0.0, 0.0), heading=0.0, height=200.0, water_level=0.0,
    ...     speed=100.0, flash_rate=1.0, frames_per_line=5, lines=2, swath=51.2, sidelap=0.2,
    ...     turn="alternate", turn_time=60.0)
    >>> round(plan.line_spacing, 2), plan.flash_spacing, plan.frame_count
    (40.96, 100.0, 10)
    """

    start: tuple[float, float]
    frames_per_line: int
    lines: int

    @property
    def origin(self) -> tuple[float, float]:
        """Easting and northing from which the profiles count [m]."""
        return self.start

    @property
    def line_count(self) -> int:
        """Lines of the mission."""
        return self.lines

    @property
    def frame_count(self) -> int:
        """Flashes of the whole mission."""
        return self.lines * self.frames_per_line

    @property
    def line_duration(self) -> float:
        """Time from the first to the last flash of a line [s]."""
        return (self.frames_per_line - 1) / self.flash_rate

    @cached_property
    def survey_lines(self) -> list[SurveyLine]:
        """The lines in the order of flight."""
        return [self._line(number) for number in range(self.lines)]

    def _line(self, number: int) -> SurveyLine:
        backwards = self.turn == "alternate" and number % 2 == 1
        along = self._flash_distances
        return SurveyLine(
            axis=self.heading,
            origin=self.start,
            offset=number * self.line_spacing,
            along=along[::-1] if backwards else along,
            times=np.arange(self.frames_per_line, dtype=np.float64) / self.flash_rate,
            course=self.course(self.heading, backwards=backwards),
        )

    @cached_property
    def _flash_distances(self) -> FloatArray:
        if self.speed_profile is None:
            return self.flash_spacing * np.arange(self.frames_per_line, dtype=np.float64)
        farthest = max(self.speed_profile.values) * self.line_duration
        places, _ = even_times(self.speed_profile, start=0.0, end=farthest, rate=self.flash_rate)
        return places[: self.frames_per_line]

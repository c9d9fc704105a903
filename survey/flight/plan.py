"""The flight as it is ordered: parallel lines over the water."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class FlightPlan:
    """Straight parallel lines with one flash after another at even times.

    The first line starts at `start`; each further line lies one spacing to its right. With
    ``turn = "alternate"`` every second line is flown back, with ``"same"`` all lines are flown the
    same way. Flashes of all lines lie abreast.

    Parameters
    ----------
    start : tuple of float
        Easting and northing of the first flash in the scene's local frame [m].
    heading : float
        Heading of the first line, clockwise from grid north [rad].
    height : float
        Height of the sensor above the water level [m].
    water_level : float
        Mean water level in the vertical datum [m].
    speed : float
        Ground speed [m/s].
    flash_rate : float
        Flashes a second [Hz].
    frames_per_line, lines : int
        Flashes on each line, and lines.
    swath : float
        Width that one line sees at the water surface, across the flight [m].
    sidelap : float
        Part of the swath at the water surface that the next line sees again [1].
    turn : {"alternate", "same"}
        Which way every second line is flown.
    turn_time : float
        Time between the last flash of a line and the first of the next [s].

    Examples
    --------
    >>> plan = FlightPlan(start=(0.0, 0.0), heading=0.0, height=200.0, water_level=0.0,
    ...     speed=100.0, flash_rate=1.0, frames_per_line=5, lines=2, swath=51.2, sidelap=0.2,
    ...     turn="alternate", turn_time=60.0)
    >>> round(plan.line_spacing, 2), plan.flash_spacing, plan.frame_count
    (40.96, 100.0, 10)
    """

    start: tuple[float, float]
    heading: float
    height: float
    water_level: float
    speed: float
    flash_rate: float
    frames_per_line: int
    lines: int
    swath: float
    sidelap: float
    turn: Literal["alternate", "same"]
    turn_time: float

    @property
    def frame_count(self) -> int:
        """Flashes of the whole mission."""
        return self.lines * self.frames_per_line

    @property
    def line_spacing(self) -> float:
        """Distance between neighbouring lines [m]."""
        return self.swath * (1.0 - self.sidelap)

    @property
    def flash_spacing(self) -> float:
        """Distance between neighbouring flashes of a line [m]."""
        return self.speed / self.flash_rate

    @property
    def line_duration(self) -> float:
        """Time from the first to the last flash of a line [s]."""
        return (self.frames_per_line - 1) / self.flash_rate

    @property
    def altitude(self) -> float:
        """Height of the sensor in the vertical datum [m]."""
        return self.water_level + self.height

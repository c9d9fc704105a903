"""Lines over an area: as many as a polygon asks for, and cross lines over them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from survey.flight.plan import LinePlan, SurveyLine, unit_axes
from survey.flight.polygon import area_between, clipped, signed_area
from survey.flight.pose import FULL_TURN
from survey.flight.profile import Profile, even_times

FloatArray = NDArray[np.float64]

TOUCHED_AREA = 1e-6
ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class AreaPlan(LinePlan):
    """Parallel lines that cover a polygon at the water surface, then lines across them.

    The fewest lines, one spacing apart, whose swaths hold the polygon from side to side; what
    they reach beyond it is shared out between both sides. A line begins and ends where its view
    begins and ends to see the polygon, and does not flash where it sees none of it. Cross lines
    follow, a quarter turn to the right of the heading, spread evenly over the polygon. The other
    parameters are those of `LinePlan`; profiles count from where the polygon begins.

    Parameters
    ----------
    polygon : array (n, 2)
        Corners in the scene's local frame [m].
    view_length : float
        Length that a flash sees at the water surface, along the flight [m].
    cross_lines : int
        Lines across the others.

    Examples
    --------
    >>> field = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 400.0], [0.0, 400.0]])
    >>> plan = AreaPlan(polygon=field, heading=0.0, height=200.0, water_level=0.0, speed=100.0,
    ...     flash_rate=1.0, swath=50.0, view_length=100.0, sidelap=0.2, turn="alternate",
    ...     turn_time=60.0, cross_lines=1)
    >>> [len(line.along) for line in plan.survey_lines], plan.frame_count
    ([4, 4, 4, 1], 13)
    """

    polygon: FloatArray
    view_length: float
    cross_lines: int = 0

    @cached_property
    def origin(self) -> tuple[float, float]:
        """Easting and northing of where the area is hindmost and leftmost, from above [m]."""
        ahead, right = unit_axes(self.heading)
        low = (self.polygon @ np.column_stack([ahead, right])).min(axis=0)
        east, north = low[0] * ahead + low[1] * right
        return float(east), float(north)

    @cached_property
    def survey_lines(self) -> list[SurveyLine]:
        """The lines in the order of flight, cross lines last."""
        return [*self._sweep(self.heading, None), *self._sweep(self._cross_heading, self._places)]

    @property
    def line_count(self) -> int:
        """Lines, cross lines included."""
        return len(self.survey_lines)

    @property
    def frame_count(self) -> int:
        """Flashes of the whole mission."""
        return sum(len(line.along) for line in self.survey_lines)

    @property
    def _cross_heading(self) -> float:
        return (self.heading + 0.5 * np.pi) % FULL_TURN

    @property
    def _places(self) -> FloatArray:
        """Parts of the area's length at which the cross lines lie."""
        return (np.arange(self.cross_lines) + 0.5) / max(self.cross_lines, 1)

    def _sweep(self, axis: float, parts: FloatArray | None) -> list[SurveyLine]:
        """Return the lines along an axis: at parts of the area's width, or as many as cover it."""
        ahead, right = unit_axes(axis)
        field = (self.polygon - np.array(self.origin)) @ np.column_stack([ahead, right])
        low, high = field[:, 1].min(), field[:, 1].max()
        offsets = self._covering(low, high) if parts is None else high - parts * (high - low)
        lines: list[SurveyLine] = []
        for offset in offsets:
            backwards = self.turn == "alternate" and len(lines) % 2 == 1
            line = self._line(axis, field, float(offset), backwards=backwards)
            if line is not None:
                lines.append(line)
        return lines

    def _covering(self, low: float, high: float) -> FloatArray:
        """Return the middles of the fewest swaths that hold a width."""
        gaps = (high - low - self.swath) / self.line_spacing
        count = max(int(np.ceil(gaps - ROUNDING)), 0) + 1
        steps = np.arange(count) - 0.5 * (count - 1)
        return np.asarray(0.5 * (low + high) + steps * self.line_spacing)

    def _line(
        self, axis: float, field: FloatArray, offset: float, *, backwards: bool
    ) -> SurveyLine | None:
        """Return the line at an offset; none where its swath misses the area."""
        half = np.array([0.5 * self.view_length, 0.5 * self.swath])
        strip = clipped(
            field,
            low=np.array([-np.inf, offset - half[1]]),
            high=np.array([np.inf, offset + half[1]]),
        )
        if abs(signed_area(strip)) <= TOUCHED_AREA:
            return None
        begin, end = strip[:, 0].min() + half[0], strip[:, 0].max() - half[0]
        along, times = self._flashes(axis, begin, end, offset)
        seen = area_between(strip, along - half[0], along + half[0]) > TOUCHED_AREA
        along, times = along[seen], times[seen]
        if backwards:
            along, times = along[::-1], times[-1] - times[::-1]
        return SurveyLine(
            axis=axis,
            origin=self.origin,
            offset=offset,
            along=along,
            times=times - times[0],
            course=self.course(axis, backwards=backwards),
        )

    def _flashes(
        self, axis: float, begin: float, end: float, offset: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return places and times of flashes whose middles reach from begin to end at least."""
        speed = self._speed_along(axis, offset)
        if end <= begin:
            return np.array([0.5 * (begin + end)]), np.zeros(1)
        along, _ = even_times(speed, start=begin, end=end, rate=self.flash_rate)
        early = 0.5 * min(along[-1] - end, self.view_length)
        return even_times(speed, start=begin - early, end=end, rate=self.flash_rate)

    def _speed_along(self, axis: float, offset: float) -> Profile:
        """Return the speed along a line; across the heading it is that of the place."""
        if self.speed_profile is None:
            return Profile(distances=(0.0,), values=(self.speed,))
        if axis == self.heading:
            return self.speed_profile
        ahead = float(self.speed_profile.at(np.array(-offset)))
        return Profile(distances=(0.0,), values=(ahead,))

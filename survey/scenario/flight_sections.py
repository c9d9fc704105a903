"""The section [flight]: one set of keys for each kind of flight."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePath
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from survey.scenario.sections import (
    Bearing,
    Coordinate,
    Count,
    Elevation,
    Flight,
    Height,
    NotNegative,
    Positive,
    Section,
    Text,
)

Overlap = Annotated[float, Field(ge=0.0, lt=1.0)]
Bank = Annotated[float, Field(gt=0.0, le=60.0)]
Pair = Annotated[list[Coordinate], Field(min_length=2, max_length=2)]
AREA_SUFFIXES = (".geojson", ".json")
TrackFormat = Literal["csv", "cblue", "sbet"]


class HeightAt(Section):
    """The height above the water at a place along the heading; straight in between."""

    distance_m: Coordinate
    """Distance along the heading from where the lines begin."""
    height_m: Height
    """Height above the water level there."""


class SpeedAt(Section):
    """The ground speed at a place along the heading; straight in between."""

    distance_m: Coordinate
    """Distance along the heading from where the lines begin."""
    speed_m_s: Positive
    """Speed over ground there."""


class PlannedFlight(Flight):
    """Straight lines; sidelap counts at the water surface.

    Profiles replace `height_m` and `speed_m_s`; their distances count along the heading from
    where the lines begin. With `turn_bank_deg` a turn takes as long as its way, without it
    `turn_time_s`. Wind turns the nose off the line (crab angle); `speed_m_s` is that over ground.
    """

    heading_deg: Bearing
    """Direction of the first line, from north to the east."""
    sidelap: Overlap = 0.2
    """Share of the swath that neighbouring lines have in common, at the water."""
    turn: Literal["alternate", "same"] = "alternate"
    """`alternate` flies every other line back; `same` flies all in one direction."""
    turn_time_s: NotNegative = 60.0
    """Time between two lines, without `turn_bank_deg`."""
    turn_bank_deg: Bank | None = None
    """Bank of the turns: their time follows from their way."""
    height_profile: list[HeightAt] = Field(default_factory=list)
    """Heights at places along the lines, which replace `height_m`."""
    speed_profile: list[SpeedAt] = Field(default_factory=list)
    """Speeds at places along the lines, which replace `speed_m_s`."""
    wind_speed_m_s: Annotated[float, Field(ge=0.0, le=60.0)] = 0.0
    """Wind at the aircraft, which turns the nose off the line."""
    wind_from_deg: Bearing = 0.0
    """Direction from which that wind comes."""

    @property
    def heights_m(self) -> tuple[float, float]:
        """Least and greatest height above the water."""
        heights = [step.height_m for step in self.height_profile] or [self.height_m]
        return min(heights), max(heights)


class LinesFlight(PlannedFlight):
    """So many parallel lines, each so many flashes long, from a start on the map."""

    kind: Literal["lines"] = "lines"
    start_easting_m: Coordinate
    """Easting of the first flash of the first line."""
    start_northing_m: Coordinate
    """Northing of the first flash of the first line."""
    frames_per_line: Count
    """Flashes of each line."""
    lines: Count = 1
    """Number of parallel lines; the next one lies to the right."""


class AreaFlight(PlannedFlight):
    """As many lines as cover a polygon, its corners on the map or in a GeoJSON file.

    Cross lines run a quarter turn to the right of the heading.
    """

    kind: Literal["area"]
    corners_m: list[Pair] | None = None
    """Corners of the area on the map, each `[easting, northing]`."""
    file: Text | None = None
    """GeoJSON file with the area's polygon, in place of corners."""
    cross_lines: Annotated[int, Field(ge=0, le=1000)] = 0
    """Lines across the others."""


class RecordedFlight(Flight):
    """Along a recorded trajectory, moving as the aircraft did; each leg is a line.

    The format follows from the file's name (.csv, .txt for cBLUE's, .out or .sbet) unless told.
    Offsets are added to every place: `offset_up_m` brings heights into the vertical datum.
    `height_m` and `speed_m_s` say what the receiver's gate and the rules count on.
    """

    kind: Literal["trajectory"]
    file: Text
    """The trajectory's file."""
    format: TrackFormat | None = None
    """Its format, where the file's name does not tell."""
    column_prefix: Literal["", "true_", "measured_"] = ""
    """Which poses of a `trajectory.csv` of ours are flown: `true_` or `measured_`."""
    legs_s: list[Pair] = Field(default_factory=list)
    """Lines, each `[begin, end]` since the track's first time; without them all of it is one line.
    """
    offset_easting_m: Coordinate = 0.0
    """Added to every easting."""
    offset_northing_m: Coordinate = 0.0
    """Added to every northing."""
    offset_up_m: Elevation = 0.0
    """Added to every height, for instance from ellipsoid to vertical datum."""


def _with_kind(given: Any) -> Any:
    """Where the kind is not said, the keys tell it."""
    if not isinstance(given, Mapping) or "kind" in given:
        return given
    if "corners_m" in given:
        return {"kind": "area", **given}
    if isinstance(given.get("file"), str):
        is_area = PurePath(given["file"]).suffix.lower() in AREA_SUFFIXES
        return {"kind": "area" if is_area else "trajectory", **given}
    return {"kind": "lines", **given}


AnyFlight = Annotated[
    LinesFlight | AreaFlight | RecordedFlight,
    Field(discriminator="kind"),
    BeforeValidator(_with_kind),
]

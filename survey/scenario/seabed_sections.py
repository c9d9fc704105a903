"""The section [seabed]: one set of keys for each kind of seabed and of object on it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from survey.scenario.sections import Bearing, Count, Fraction, NotNegative, Positive, Section, Text

PointClassCode = Annotated[int, Field(ge=0, le=255)]
Slope = Annotated[float, Field(gt=0.0, le=80.0)]
Tilt = Annotated[float, Field(ge=-180.0, le=180.0)]


class Placed(Section):
    """What every object has: its place on the map, how it lies, how deep it is buried.

    A positive list lowers its starboard side, a positive trim lifts its bow.
    """

    easting_m: float
    northing_m: float
    heading_deg: Bearing = 0.0
    list_deg: Tilt = 0.0
    trim_deg: Tilt = 0.0
    burial_m: NotNegative = 0.0
    reflectance: Fraction = 0.1


class Wreck(Placed):
    """A hull with overhangs."""

    kind: Literal["wreck"]
    length_m: Positive = 30.0
    beam_m: Positive = 6.0
    hull_height_m: Positive = 3.0


class Boulder(Placed):
    """A rounded rock; its relief is a part of its radius."""

    kind: Literal["boulder"]
    diameter_m: Positive = 3.0
    relief: Annotated[float, Field(ge=0.0, le=0.3)] = 0.15
    seed: Annotated[int, Field(ge=0)] = 1


class Cube(Placed):
    """The cube of the hydrographic feature tests."""

    kind: Literal["cube"]
    side_m: Positive = 2.0


class MeshObject(Placed):
    """Any mesh file in metres, z up, y towards its heading."""

    kind: Literal["mesh"]
    file: Text


SeabedObject = Annotated[Wreck | Boulder | Cube | MeshObject, Field(discriminator="kind")]


class SeabedSection(Section):
    """What every seabed has; it is read or made up to `margin_m` beyond the flight."""

    reflectance: Fraction = 0.1
    margin_m: Positive = 100.0
    objects: list[SeabedObject] = Field(default_factory=list)


class RoughenedSeabed(SeabedSection):
    """A seabed to which synthetic fine relief may be added."""

    roughness_rms_m: NotNegative = 0.0
    roughness_spectral_slope: Annotated[float, Field(gt=0.0, le=6.0)] = 3.0
    roughness_longest_wave_m: Positive = 20.0
    roughness_seed: Annotated[int, Field(ge=0)] = 1


class RasterSeabed(RoughenedSeabed):
    """A raster of elevations, positive up, in the mission's map; finer cells when asked for."""

    kind: Literal["raster"]
    file: Text
    band: Count = 1
    spacing_m: Positive | None = None


class PointsSeabed(SeabedSection):
    """LAS or LAZ points, one to a cell, joined by triangles with edges of 4 cells at most."""

    kind: Literal["points"]
    file: Text
    cell_m: Positive = 1.0
    longest_edge_m: Positive | None = None
    classes: list[PointClassCode] = Field(default_factory=lambda: [2, 40], min_length=1)


class MeshSeabed(SeabedSection):
    """A mesh file in metres, z up, that lies on the map once its offset is added."""

    kind: Literal["mesh"]
    file: Text
    offset_easting_m: float = 0.0
    offset_northing_m: float = 0.0
    offset_up_m: float = 0.0


class MadeSeabed(RoughenedSeabed):
    """A seabed by formula.

    Depths count from the zero of the vertical datum, so that a tide does not move the bed.
    """

    spacing_m: Positive = 2.0


class PlaneSeabed(MadeSeabed):
    """Level."""

    kind: Literal["plane"]
    depth_m: float


class SlopeSeabed(MadeSeabed):
    """Evenly sloping; the depth is that at the flight's start."""

    kind: Literal["slope"]
    depth_m: float
    slope_deg: Slope
    downhill_deg: Bearing


class SandbarSeabed(MadeSeabed):
    """A slope out from the shoreline with a bar along the shore.

    The shoreline's distance counts offshore from the flight's start, the bar's from the shoreline;
    the beach rises up to its height.
    """

    kind: Literal["sandbar"]
    shoreline_m: float
    offshore_deg: Bearing
    slope_deg: Slope
    bar_distance_m: Positive
    bar_height_m: Positive
    bar_sigma_m: Positive
    beach_slope_deg: Slope = 5.0
    beach_height_m: Positive = 4.0


class ChannelSeabed(MadeSeabed):
    """A level bed with a channel of trapezoidal section through a point of the map."""

    kind: Literal["channel"]
    depth_m: float
    channel_depth_m: float
    channel_easting_m: float
    channel_northing_m: float
    channel_heading_deg: Bearing
    floor_width_m: Positive
    side_slope_deg: Slope


class RoughSeabed(MadeSeabed):
    """Level but for its roughness."""

    kind: Literal["rough"]
    depth_m: float
    roughness_rms_m: Positive = 0.15


Seabed = Annotated[
    RasterSeabed
    | PointsSeabed
    | MeshSeabed
    | PlaneSeabed
    | SlopeSeabed
    | SandbarSeabed
    | ChannelSeabed
    | RoughSeabed,
    Field(discriminator="kind"),
]

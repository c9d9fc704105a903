"""The section [seabed]: one set of keys for each kind of seabed and of object on it."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from survey.scenario.seabed_object_sections import Material, SeabedObject, Seed
from survey.scenario.sections import (
    Bearing,
    Coordinate,
    Count,
    Elevation,
    Fraction,
    NotNegative,
    Positive,
    Section,
    Text,
)

PointClassCode = Annotated[int, Field(ge=0, le=255)]
Slope = Annotated[float, Field(gt=0.0, le=80.0)]
Asymmetry = Annotated[float, Field(ge=1.0, le=20.0)]
SpectralSlope = Annotated[float, Field(gt=0.0, le=6.0)]


def _number_or_none(value: Any) -> Any:
    if isinstance(value, str) and value != "none":
        raise PydanticCustomError("nodata", 'neither a number nor "none"')
    return value


NoData = Annotated[float | Literal["none"] | None, BeforeValidator(_number_or_none)]


class MapClass(Material):
    """What the cells of one number in a map are made of."""

    value: int
    """Number of the class in the map."""


class BottomMap(Section):
    """A raster in the mission's map of what the bottom is made of.

    With `classes` its cells hold their numbers, without them reflectances, 0 to 1. Beyond the map,
    and where it has no data, the bottom is that of the section.
    """

    file: Text
    """The raster file, in the mission's map."""
    band: Count = 1
    """Which band."""
    nodata: NoData = None
    """Value of cells without data, or `"none"`, where the file does not tell."""
    classes: list[MapClass] = Field(default_factory=list)
    """What the numbers stand for; without them cells hold reflectances."""


class SeabedSection(Material):
    """What every seabed has; it is read or made up to `margin_m` beyond the flight."""

    map: BottomMap | None = None
    """What lies where."""
    margin_m: Positive = 100.0
    """How far beyond the flight the bed is read or made."""
    objects: list[SeabedObject] = Field(default_factory=list)
    """What lies on it."""


class RoughenedSeabed(SeabedSection):
    """A seabed to which synthetic fine relief may be added."""

    roughness_rms_m: NotNegative = 0.0
    """R.m.s. height of added relief."""
    roughness_spectral_slope: SpectralSlope = 3.0
    """Exponent by which its power falls with wavenumber."""
    roughness_longest_wave_m: Positive = 20.0
    """Its longest wave."""
    roughness_seed: Seed = 1
    """Which relief."""


class RasterSeabed(RoughenedSeabed):
    """A raster of elevations, positive up, in the mission's map; finer cells when asked for.

    `nodata` is the value of cells without data, or "none", where the file does not tell.
    """

    kind: Literal["raster"]
    file: Text
    """The raster file."""
    band: Count = 1
    """Which band."""
    nodata: NoData = None
    """Value of cells without data, or `"none"`, where the file does not tell."""
    spacing_m: Positive | None = None
    """Distance of nodes, if finer than the file's cells."""


class PointsSeabed(SeabedSection):
    """LAS or LAZ points, one to a cell, joined by triangles with edges of 4 cells at most."""

    kind: Literal["points"]
    file: Text
    """The LAS or LAZ file."""
    cell_m: Positive = 1.0
    """Side of the cells of which one point is taken."""
    longest_edge_m: Positive | None = None
    """Longest edge of a triangle; 4 cells unless told."""
    classes: list[PointClassCode] = Field(default_factory=lambda: [2, 40], min_length=1)
    """Classes whose points are seabed."""


class MeshSeabed(SeabedSection):
    """A mesh file in metres, z up, that lies on the map once its offset is added."""

    kind: Literal["mesh"]
    file: Text
    """The mesh file."""
    offset_easting_m: Coordinate = 0.0
    """Added to every x."""
    offset_northing_m: Coordinate = 0.0
    """Added to every y."""
    offset_up_m: Elevation = 0.0
    """Added to every z."""


class MadeSeabed(RoughenedSeabed):
    """A seabed by formula.

    Depths count from the zero of the vertical datum, so that a tide does not move the bed.
    """

    spacing_m: Positive = 2.0
    """Distance of nodes."""


class PlaneSeabed(MadeSeabed):
    """Level."""

    kind: Literal["plane"]
    depth_m: Elevation
    """Depth."""


class SlopeSeabed(MadeSeabed):
    """Evenly sloping; the depth is that at the flight's start."""

    kind: Literal["slope"]
    depth_m: Elevation
    """Depth at the flight's start."""
    slope_deg: Slope
    """How steep it is."""
    downhill_deg: Bearing
    """Direction in which it falls."""


class SandbarSeabed(MadeSeabed):
    """A slope out from the shoreline with a bar along the shore.

    The shoreline's distance counts offshore from the flight's start, the bar's from the shoreline;
    the beach rises up to its height.
    """

    kind: Literal["sandbar"]
    shoreline_m: Coordinate
    """Distance of the shoreline offshore from the flight's start."""
    offshore_deg: Bearing
    """Direction out to sea."""
    slope_deg: Slope
    """How steep the bed is."""
    bar_distance_m: Positive
    """Distance of the bar's crest from the shoreline."""
    bar_height_m: Positive
    """Height of the bar over the slope."""
    bar_sigma_m: Positive
    """Half width of the bar, the sigma of its Gaussian section."""
    beach_slope_deg: Slope = 5.0
    """How steep the beach is."""
    beach_height_m: Positive = 4.0
    """How high the beach rises."""


class ChannelSeabed(MadeSeabed):
    """A level bed with a channel of trapezoidal section through a point of the map."""

    kind: Literal["channel"]
    depth_m: Elevation
    """Depth beside the channel."""
    channel_depth_m: Elevation
    """Depth of its floor."""
    channel_easting_m: Coordinate
    """Easting of a point on its axis."""
    channel_northing_m: Coordinate
    """Northing of a point on its axis."""
    channel_heading_deg: Bearing
    """Direction of its axis."""
    floor_width_m: Positive
    """Width of its floor."""
    side_slope_deg: Slope
    """How steep its sides are."""


class RipplesSeabed(MadeSeabed):
    """Sand ripples; the depth is their mean, the steep flank falls to the right of the crests."""

    kind: Literal["ripples"]
    depth_m: Elevation
    """Mean depth."""
    wavelength_m: Positive
    """Distance from crest to crest."""
    height_m: Positive
    """Height from trough to crest."""
    crest_deg: Bearing
    """Direction along the crests."""
    asymmetry: Asymmetry = 1.0
    """Length of the gentle flank over that of the steep one."""
    crest_wander_m: NotNegative = 0.0
    """R.m.s. by which crests stray from straight lines."""
    crest_seed: Seed = 1
    """Which wandering."""
    spacing_m: Positive = 0.5
    """Distance of nodes."""


class ReefSeabed(MadeSeabed):
    """A level bed with a flat-topped rough reef through a point of the map."""

    kind: Literal["reef"]
    depth_m: Elevation
    """Depth around the reef."""
    reef_depth_m: Elevation
    """Depth of its top."""
    reef_easting_m: Coordinate
    """Easting of a point on its axis."""
    reef_northing_m: Coordinate
    """Northing of a point on its axis."""
    reef_heading_deg: Bearing
    """Direction of its axis."""
    top_width_m: Positive
    """Width of its top."""
    side_slope_deg: Slope = 30.0
    """How steep its sides are."""
    relief_rms_m: Positive = 0.3
    """R.m.s. height of the relief on its top."""
    relief_spectral_slope: SpectralSlope = 3.0
    """Exponent by which the relief's power falls with wavenumber."""
    relief_longest_wave_m: Positive = 10.0
    """Longest wave of the relief."""
    relief_seed: Seed = 1
    """Which relief."""
    reef_substrate: Text = "coral"
    """What the reef is made of."""
    reef_reflectance: Fraction | None = None
    """Its reflectance, before the table's."""
    spacing_m: Positive = 1.0
    """Distance of nodes."""


class RoughSeabed(MadeSeabed):
    """Level but for its roughness."""

    kind: Literal["rough"]
    depth_m: Elevation
    """Mean depth."""
    roughness_rms_m: Positive = 0.15
    """R.m.s. height of the relief."""


Seabed = Annotated[
    RasterSeabed
    | PointsSeabed
    | MeshSeabed
    | PlaneSeabed
    | SlopeSeabed
    | SandbarSeabed
    | ChannelSeabed
    | RipplesSeabed
    | ReefSeabed
    | RoughSeabed,
    Field(discriminator="kind"),
]

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


class BottomMap(Section):
    """A raster in the mission's map of what the bottom is made of.

    With `classes` its cells hold their numbers, without them reflectances, 0 to 1. Beyond the map,
    and where it has no data, the bottom is that of the section.
    """

    file: Text
    band: Count = 1
    nodata: NoData = None
    classes: list[MapClass] = Field(default_factory=list)


class SeabedSection(Material):
    """What every seabed has; it is read or made up to `margin_m` beyond the flight."""

    map: BottomMap | None = None
    margin_m: Positive = 100.0
    objects: list[SeabedObject] = Field(default_factory=list)


class RoughenedSeabed(SeabedSection):
    """A seabed to which synthetic fine relief may be added."""

    roughness_rms_m: NotNegative = 0.0
    roughness_spectral_slope: SpectralSlope = 3.0
    roughness_longest_wave_m: Positive = 20.0
    roughness_seed: Seed = 1


class RasterSeabed(RoughenedSeabed):
    """A raster of elevations, positive up, in the mission's map; finer cells when asked for.

    `nodata` is the value of cells without data, or "none", where the file does not tell.
    """

    kind: Literal["raster"]
    file: Text
    band: Count = 1
    nodata: NoData = None
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
    offset_easting_m: Coordinate = 0.0
    offset_northing_m: Coordinate = 0.0
    offset_up_m: Elevation = 0.0


class MadeSeabed(RoughenedSeabed):
    """A seabed by formula.

    Depths count from the zero of the vertical datum, so that a tide does not move the bed.
    """

    spacing_m: Positive = 2.0


class PlaneSeabed(MadeSeabed):
    """Level."""

    kind: Literal["plane"]
    depth_m: Elevation


class SlopeSeabed(MadeSeabed):
    """Evenly sloping; the depth is that at the flight's start."""

    kind: Literal["slope"]
    depth_m: Elevation
    slope_deg: Slope
    downhill_deg: Bearing


class SandbarSeabed(MadeSeabed):
    """A slope out from the shoreline with a bar along the shore.

    The shoreline's distance counts offshore from the flight's start, the bar's from the shoreline;
    the beach rises up to its height.
    """

    kind: Literal["sandbar"]
    shoreline_m: Coordinate
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
    depth_m: Elevation
    channel_depth_m: Elevation
    channel_easting_m: Coordinate
    channel_northing_m: Coordinate
    channel_heading_deg: Bearing
    floor_width_m: Positive
    side_slope_deg: Slope


class RipplesSeabed(MadeSeabed):
    """Sand ripples; the depth is their mean, the steep flank falls to the right of the crests."""

    kind: Literal["ripples"]
    depth_m: Elevation
    wavelength_m: Positive
    height_m: Positive
    crest_deg: Bearing
    asymmetry: Asymmetry = 1.0
    crest_wander_m: NotNegative = 0.0
    crest_seed: Seed = 1
    spacing_m: Positive = 0.5


class ReefSeabed(MadeSeabed):
    """A level bed with a flat-topped rough reef through a point of the map."""

    kind: Literal["reef"]
    depth_m: Elevation
    reef_depth_m: Elevation
    reef_easting_m: Coordinate
    reef_northing_m: Coordinate
    reef_heading_deg: Bearing
    top_width_m: Positive
    side_slope_deg: Slope = 30.0
    relief_rms_m: Positive = 0.3
    relief_spectral_slope: SpectralSlope = 3.0
    relief_longest_wave_m: Positive = 10.0
    relief_seed: Seed = 1
    reef_substrate: Text = "coral"
    reef_reflectance: Fraction | None = None
    spacing_m: Positive = 1.0


class RoughSeabed(MadeSeabed):
    """Level but for its roughness."""

    kind: Literal["rough"]
    depth_m: Elevation
    roughness_rms_m: Positive = 0.15


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

"""What may lie on a seabed: one set of keys for each kind of object."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from survey.scenario.sections import (
    Bearing,
    Coordinate,
    Fraction,
    NotNegative,
    Positive,
    Section,
    Text,
)

Tilt = Annotated[float, Field(ge=-180.0, le=180.0)]
Relief = Annotated[float, Field(ge=0.0, le=0.3)]
Seed = Annotated[int, Field(ge=0, lt=2**40)]
Place = Annotated[list[Coordinate], Field(min_length=2, max_length=2)]


class Material(Section):
    """What something is made of: a known substrate, or a name and reflectance of one's own."""

    substrate: Text | None = None
    reflectance: Fraction | None = None


class Placed(Material):
    """What most objects have: a place on the map, how they lie, how deep they are buried.

    A positive list lowers its starboard side, a positive trim lifts its bow.
    """

    easting_m: Coordinate
    northing_m: Coordinate
    heading_deg: Bearing = 0.0
    list_deg: Tilt = 0.0
    trim_deg: Tilt = 0.0
    burial_m: NotNegative = 0.0


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
    relief: Relief = 0.15
    seed: Seed = 1


class Boulders(Material):
    """A field of rocks about a place, as long along its heading as it says.

    Number and places are Poisson's, diameters exponential above the least and cut off at the
    largest; the mean is that before the cut.
    """

    kind: Literal["boulders"]
    easting_m: Coordinate
    northing_m: Coordinate
    heading_deg: Bearing = 0.0
    length_m: Positive
    width_m: Positive
    density_per_m2: Positive = 0.01
    least_diameter_m: Positive = 0.5
    mean_diameter_m: Positive = 1.0
    largest_diameter_m: Positive = 4.0
    buried_fraction: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.25
    relief: Relief = 0.15
    seed: Seed = 1


class Cube(Placed):
    """The cube of the hydrographic feature tests."""

    kind: Literal["cube"]
    side_m: Positive = 2.0


class Span(Section):
    """Where a pipeline hangs free, counted along its route."""

    start_m: NotNegative
    length_m: Positive
    gap_m: Positive


class Pipeline(Material):
    """A stiff pipe along a route of map points, with free spans."""

    kind: Literal["pipeline"]
    route_m: list[Place] = Field(min_length=2)
    diameter_m: Positive = 0.6
    burial_m: NotNegative = 0.0
    bend_radius_m: Positive = 200.0
    spans: list[Span] = Field(default_factory=list)


class MeshObject(Placed):
    """Any mesh file in metres, z up, y towards its heading."""

    kind: Literal["mesh"]
    file: Text


SeabedObject = Annotated[
    Wreck | Boulder | Boulders | Cube | Pipeline | MeshObject, Field(discriminator="kind")
]

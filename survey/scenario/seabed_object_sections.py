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
    """What it is made of: a label, with the table's reflectance."""
    reflectance: Fraction | None = None
    """Diffuse reflectance at the laser's wavelength, before the table's; 0.1 where nothing says."""


class Placed(Material):
    """What most objects have: a place on the map, how they lie, how deep they are buried.

    A positive list lowers its starboard side, a positive trim lifts its bow.
    """

    easting_m: Coordinate
    """Easting of its middle."""
    northing_m: Coordinate
    """Northing of its middle."""
    heading_deg: Bearing = 0.0
    """Direction of its bow, from north to the east."""
    list_deg: Tilt = 0.0
    """How far its starboard side is lowered."""
    trim_deg: Tilt = 0.0
    """How far its bow is lifted."""
    burial_m: NotNegative = 0.0
    """How deep it is sunk into the bed."""


class Wreck(Placed):
    """A hull with overhangs."""

    kind: Literal["wreck"]
    length_m: Positive = 30.0
    """Length of the hull."""
    beam_m: Positive = 6.0
    """Width of the hull."""
    hull_height_m: Positive = 3.0
    """Height from keel to sheer."""


class Boulder(Placed):
    """A rounded rock; its relief is a part of its radius."""

    kind: Literal["boulder"]
    diameter_m: Positive = 3.0
    """Mean diameter."""
    relief: Relief = 0.15
    """How rough it is, as a part of its radius."""
    seed: Seed = 1
    """Which boulder."""


class Boulders(Material):
    """A field of rocks about a place, as long along its heading as it says.

    Number and places are Poisson's, diameters exponential above the least and cut off at the
    largest; the mean is that before the cut.
    """

    kind: Literal["boulders"]
    easting_m: Coordinate
    """Easting of the field's middle."""
    northing_m: Coordinate
    """Northing of the field's middle."""
    heading_deg: Bearing = 0.0
    """Direction of the field's length."""
    length_m: Positive
    """Length of the field."""
    width_m: Positive
    """Width of the field."""
    density_per_m2: Positive = 0.01
    """Boulders on a square metre, on average."""
    least_diameter_m: Positive = 0.5
    """Least diameter."""
    mean_diameter_m: Positive = 1.0
    """Mean diameter before the cut."""
    largest_diameter_m: Positive = 4.0
    """Diameter at which the distribution is cut off."""
    buried_fraction: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.25
    """Share of each that is below the bed."""
    relief: Relief = 0.15
    """How rough they are, as a part of their radius."""
    seed: Seed = 1
    """Which field."""


class Cube(Placed):
    """The cube of the hydrographic feature tests."""

    kind: Literal["cube"]
    side_m: Positive = 2.0
    """Side of the cube."""


class Span(Section):
    """Where a pipeline hangs free, counted along its route."""

    start_m: NotNegative
    """Where the pipe leaves the bed, along the route."""
    length_m: Positive
    """Length of the span."""
    gap_m: Positive
    """Clear height under the pipe."""


class Pipeline(Material):
    """A stiff pipe along a route of map points, with free spans."""

    kind: Literal["pipeline"]
    route_m: list[Place] = Field(min_length=2)
    """Points of the map that it runs through, each `[easting, northing]`."""
    diameter_m: Positive = 0.6
    """Outer diameter."""
    burial_m: NotNegative = 0.0
    """How deep it is sunk into the bed."""
    bend_radius_m: Positive = 200.0
    """Least radius of its bends up and down, so that it bridges hollows."""
    spans: list[Span] = Field(default_factory=list)
    """Where it hangs free."""


class MeshObject(Placed):
    """Any mesh file in metres, z up, y towards its heading."""

    kind: Literal["mesh"]
    file: Text
    """The mesh file."""


SeabedObject = Annotated[
    Wreck | Boulder | Boulders | Cube | Pipeline | MeshObject, Field(discriminator="kind")
]

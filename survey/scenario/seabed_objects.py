"""The objects of the section [seabed] set on it, in SI units and radians."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

import numpy as np

from survey.scenario import seabed_object_sections as kinds
from survey.scenario.scenario import Scenario
from survey.scenario.seabed_materials import substrate_of
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    import trimesh

    from survey.products.verdict.features import Cube
    from terrain.seabed import Seabed


def with_objects(seabed: Seabed, scenario: Scenario, frame: MapFrame) -> Seabed:
    """Return the seabed with the scenario's objects set on it, each on what was there before."""
    for given in scenario.seabed.objects:
        body = _lying(given, seabed, scenario, frame)
        material = substrate_of(given, scenario.seabed)
        seabed = seabed.with_object(
            body, reflectance=material.reflectance, source=f"On it: {given.kind}."
        ).painted(slice(-len(body.faces), None), material)
    return seabed


def cubes(scenario: Scenario) -> list[Cube]:
    """Return the cubes of the feature tests in the local frame."""
    from survey.products.verdict.features import Cube
    from survey.scenario.components import map_frame

    frame = map_frame(scenario)
    return [
        Cube(
            side=given.side_m,
            east=given.easting_m - frame.easting,
            north=given.northing_m - frame.northing,
            heading=radians(given.heading_deg),
        )
        for given in scenario.seabed.objects
        if isinstance(given, kinds.Cube)
    ]


def _lying(
    given: kinds.SeabedObject, seabed: Seabed, scenario: Scenario, frame: MapFrame
) -> trimesh.Trimesh:
    """Return an object as it lies on the seabed, in local coordinates."""
    if isinstance(given, kinds.Pipeline):
        return _pipeline(given, seabed, frame)
    east, north = given.easting_m - frame.easting, given.northing_m - frame.northing
    if isinstance(given, kinds.Boulders):
        return _boulders(given, seabed, east, north)
    from terrain.objects import place

    return place(
        _body(given, scenario),
        seabed=seabed,
        east=east,
        north=north,
        heading=radians(given.heading_deg),
        list_angle=radians(given.list_deg),
        trim_angle=radians(given.trim_deg),
        burial=given.burial_m,
    )


def _body(
    given: kinds.Wreck | kinds.Boulder | kinds.Cube | kinds.MeshObject, scenario: Scenario
) -> trimesh.Trimesh:
    from terrain import objects

    if isinstance(given, kinds.Wreck):
        return objects.wreck(length=given.length_m, beam=given.beam_m, height=given.hull_height_m)
    if isinstance(given, kinds.Boulder):
        return objects.boulder(radius=0.5 * given.diameter_m, relief=given.relief, seed=given.seed)
    if isinstance(given, kinds.Cube):
        return objects.cube(side=given.side_m)
    from terrain.importers import read_mesh

    return read_mesh(scenario.folder / given.file)


def _boulders(given: kinds.Boulders, seabed: Seabed, east: float, north: float) -> trimesh.Trimesh:
    from terrain.boulder_field import BoulderField

    field = BoulderField(
        length=given.length_m,
        width=given.width_m,
        density=given.density_per_m2,
        least_diameter=given.least_diameter_m,
        mean_diameter=given.mean_diameter_m,
        largest_diameter=given.largest_diameter_m,
        burial=given.buried_fraction,
        relief=given.relief,
        seed=given.seed,
    )
    return field.bodies(seabed=seabed, east=east, north=north, heading=radians(given.heading_deg))


def _pipeline(given: kinds.Pipeline, seabed: Seabed, frame: MapFrame) -> trimesh.Trimesh:
    from terrain.pipeline import FreeSpan, pipeline

    return pipeline(
        seabed=seabed,
        route=np.array(given.route_m) - frame.origin[:2],
        diameter=given.diameter_m,
        burial=given.burial_m,
        bend_radius=given.bend_radius_m,
        spans=[
            FreeSpan(start=span.start_m, length=span.length_m, gap=span.gap_m)
            for span in given.spans
        ],
    )

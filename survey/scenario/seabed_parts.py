"""The section [seabed] turned into terrain, in SI units and radians."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import radians, tan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.scenario import seabed_sections as kinds
from survey.scenario.components import flight_plan
from survey.scenario.scenario import Scenario
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    import trimesh

    from terrain.generators import Ground
    from terrain.roughness import Roughness
    from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]


def bare_seabed(scenario: Scenario, frame: MapFrame, outlines: Sequence[FloatArray]) -> Seabed:
    """Return the seabed without its objects.

    Parameters
    ----------
    scenario : Scenario
    frame : MapFrame
        Local frame.
    outlines : sequence of array (corners, 2)
        Footprints in the local frame [m]: what lies beyond their margin is not needed.
    """
    given = scenario.seabed
    if isinstance(given, kinds.MadeSeabed):
        return _made(given, _Site(scenario, frame, outlines))
    corners = np.concatenate(outlines) + frame.origin[:2]
    return _in_frame(_imported(given, scenario, corners), frame)


class _Site:
    """Where a made seabed lies: the footprints, and the flight's start."""

    def __init__(self, scenario: Scenario, frame: MapFrame, outlines: Sequence[FloatArray]) -> None:
        from survey.scenario.flight_parts import beginning

        self.frame, self.corners = frame, np.concatenate(outlines)
        self.start, self.heading = beginning(flight_plan(scenario))

    def local(self, easting: float, northing: float) -> FloatArray:
        """Return a point of the map in the local frame (2,) [m]."""
        return np.array([easting - self.frame.easting, northing - self.frame.northing])

    def ground(
        self, given: kinds.MadeSeabed, axis: float, centre: FloatArray | None = None
    ) -> Ground:
        """Return the least rectangle along an axis [rad], about a centre if one is given."""
        from terrain.generators import Ground

        directions = np.array([[np.sin(axis), np.cos(axis)], [np.cos(axis), -np.sin(axis)]])
        along = self.corners @ directions.T
        if centre is None:
            centre = 0.5 * (along.min(axis=0) + along.max(axis=0)) @ directions
        reach = np.abs(along - centre @ directions.T).max(axis=0) + given.margin_m
        return Ground(
            map_frame=self.frame,
            centre=(float(centre[0]), float(centre[1])),
            length=2.0 * float(reach[0]),
            width=2.0 * float(reach[1]),
            axis=axis,
            reflectance=given.reflectance,
            roughness=_roughness(given),
        )

    def start_along(self, ground: Ground) -> float:
        """Return how far along the ground's axis the flight starts, from its centre [m]."""
        axis = np.array([np.sin(ground.axis), np.cos(ground.axis)])
        return float((self.start - np.array(ground.centre)) @ axis)


def _roughness(given: kinds.RoughenedSeabed) -> Roughness | None:
    from terrain.roughness import Roughness

    if given.roughness_rms_m == 0.0:
        return None
    return Roughness(
        rms=given.roughness_rms_m,
        spectral_slope=given.roughness_spectral_slope,
        longest_wavelength=given.roughness_longest_wave_m,
        seed=given.roughness_seed,
    )


def _made(given: kinds.MadeSeabed, site: _Site) -> Seabed:
    if isinstance(given, kinds.SandbarSeabed):
        return _sandbar(given, site)
    if isinstance(given, kinds.ChannelSeabed):
        return _channel(given, site)
    if isinstance(given, kinds.SlopeSeabed):
        return _slope(given, site)
    assert isinstance(given, kinds.PlaneSeabed | kinds.RoughSeabed)
    from terrain.generators import plane

    ground = site.ground(given, site.heading)
    return plane(ground=ground, depth=given.depth_m, spacing=_spacing(given))


def _spacing(given: kinds.MadeSeabed) -> float | None:
    """Return the cells' side where roughness asks for cells [m]."""
    return None if given.roughness_rms_m == 0.0 else given.spacing_m


def _slope(given: kinds.SlopeSeabed, site: _Site) -> Seabed:
    from terrain.generators import slope

    ground = site.ground(given, radians(given.downhill_deg))
    gradient = tan(radians(given.slope_deg))
    return slope(
        ground=ground,
        depth=given.depth_m - gradient * site.start_along(ground),
        gradient=gradient,
        spacing=_spacing(given),
    )


def _sandbar(given: kinds.SandbarSeabed, site: _Site) -> Seabed:
    from terrain.generators import sandbar

    ground = site.ground(given, radians(given.offshore_deg))
    return sandbar(
        ground=ground,
        shoreline=site.start_along(ground) + given.shoreline_m,
        gradient=tan(radians(given.slope_deg)),
        bar_distance=given.bar_distance_m,
        bar_height=given.bar_height_m,
        bar_width=given.bar_sigma_m,
        spacing=given.spacing_m,
        beach_gradient=tan(radians(given.beach_slope_deg)),
        beach_height=given.beach_height_m,
    )


def _channel(given: kinds.ChannelSeabed, site: _Site) -> Seabed:
    from terrain.generators import channel

    centre = site.local(given.channel_easting_m, given.channel_northing_m)
    return channel(
        ground=site.ground(given, radians(given.channel_heading_deg), centre),
        depth=given.depth_m,
        channel_depth=given.channel_depth_m,
        bottom_width=given.floor_width_m,
        side_gradient=tan(radians(given.side_slope_deg)),
        spacing=given.spacing_m,
    )


def _imported(given: kinds.SeabedSection, scenario: Scenario, corners: FloatArray) -> Seabed:
    """Return the seabed of a file, as far as it lies about corners (n, 2) on the map [m]."""
    from terrain import importers

    mission = scenario.mission
    common: dict[str, Any] = {
        "epsg": mission.crs_epsg,
        "vertical_epsg": mission.vertical_epsg,
        "reflectance": given.reflectance,
    }
    nearby: dict[str, Any] = {"outline": corners, "margin": given.margin_m}
    if isinstance(given, kinds.RasterSeabed):
        return importers.from_raster(
            scenario.folder / given.file,
            band=given.band,
            spacing=given.spacing_m,
            roughness=_roughness(given),
            **nearby,
            **common,
        )
    if isinstance(given, kinds.PointsSeabed):
        return importers.from_las(
            scenario.folder / given.file,
            classes=given.classes,
            cell=given.cell_m,
            longest_edge=given.longest_edge_m,
            **nearby,
            **common,
        )
    assert isinstance(given, kinds.MeshSeabed)
    offset = (given.offset_easting_m, given.offset_northing_m, given.offset_up_m)
    return importers.from_mesh_file(scenario.folder / given.file, offset=offset, **common)


def _in_frame(seabed: Seabed, frame: MapFrame) -> Seabed:
    """Return the seabed in another local frame."""
    mesh = seabed.mesh.copy()
    mesh.apply_translation(seabed.map_frame.origin - frame.origin)
    return replace(seabed, mesh=mesh, map_frame=frame)


def with_objects(seabed: Seabed, scenario: Scenario, frame: MapFrame) -> Seabed:
    """Return the seabed with the scenario's objects set on it, each on what was there before."""
    from terrain.objects import place

    for given in scenario.seabed.objects:
        body = place(
            _body(given, scenario),
            seabed=seabed,
            east=given.easting_m - frame.easting,
            north=given.northing_m - frame.northing,
            heading=radians(given.heading_deg),
            list_angle=radians(given.list_deg),
            trim_angle=radians(given.trim_deg),
            burial=given.burial_m,
        )
        sentence = f"On it: {given.kind}."
        seabed = seabed.with_object(body, reflectance=given.reflectance, source=sentence)
    return seabed


def _body(given: kinds.SeabedObject, scenario: Scenario) -> trimesh.Trimesh:
    from terrain import objects

    if isinstance(given, kinds.Wreck):
        return objects.wreck(length=given.length_m, beam=given.beam_m, height=given.hull_height_m)
    if isinstance(given, kinds.Boulder):
        return objects.boulder(radius=0.5 * given.diameter_m, relief=given.relief, seed=given.seed)
    if isinstance(given, kinds.Cube):
        return objects.cube(side=given.side_m)
    from terrain.importers import read_mesh

    return read_mesh(scenario.folder / given.file)

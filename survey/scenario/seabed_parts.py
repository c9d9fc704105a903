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
from survey.scenario.seabed_materials import reef_material, stated_reflectance, substrate_of
from terrain.map_frame import MapFrame
from terrain.substrate import UNLABELLED

if TYPE_CHECKING:
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
    corners = np.concatenate(outlines) + frame.origin[:2]
    if isinstance(given, kinds.MadeSeabed):
        seabed = _made(given, _Site(scenario, frame, outlines))
    else:
        seabed = _in_frame(_imported(given, scenario, corners), frame)
    seabed = seabed.painted(seabed.substrate == UNLABELLED, substrate_of(given, given))
    return seabed if given.map is None else _mapped(seabed, given, scenario, corners)


def _mapped(
    seabed: Seabed, given: kinds.SeabedSection, scenario: Scenario, corners: FloatArray
) -> Seabed:
    """Return the seabed made of what its map shows about corners (n, 2) on the map [m]."""
    from terrain.cover import reflectance_cover, substrate_cover
    from terrain.cover_faces import covered

    chart = given.map
    assert chart is not None
    path = scenario.folder / chart.file
    window: dict[str, Any] = {
        "epsg": scenario.mission.crs_epsg,
        "band": chart.band,
        "nodata": chart.nodata,
        "outline": corners,
        "margin": given.margin_m,
    }
    if not chart.classes:
        return covered(seabed, reflectance_cover(path, **window))
    classes = {part.value: substrate_of(part, given) for part in chart.classes}
    return covered(seabed, substrate_cover(path, classes=classes, **window))


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
            reflectance=stated_reflectance(given.model_dump()),
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
    if isinstance(given, kinds.RipplesSeabed):
        return _ripples(given, site)
    if isinstance(given, kinds.ReefSeabed):
        return _reef(given, site)
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


def _ripples(given: kinds.RipplesSeabed, site: _Site) -> Seabed:
    from terrain.bedforms import ripples

    return ripples(
        ground=site.ground(given, radians(given.crest_deg)),
        depth=given.depth_m,
        wavelength=given.wavelength_m,
        height=given.height_m,
        asymmetry=given.asymmetry,
        crest_wander=given.crest_wander_m,
        seed=given.crest_seed,
        spacing=given.spacing_m,
    )


def _reef(given: kinds.ReefSeabed, site: _Site) -> Seabed:
    from terrain.bedforms import reef
    from terrain.roughness import Roughness

    centre = site.local(given.reef_easting_m, given.reef_northing_m)
    return reef(
        ground=site.ground(given, radians(given.reef_heading_deg), centre),
        depth=given.depth_m,
        top_depth=given.reef_depth_m,
        top_width=given.top_width_m,
        side_gradient=tan(radians(given.side_slope_deg)),
        relief=Roughness(
            rms=given.relief_rms_m,
            spectral_slope=given.relief_spectral_slope,
            longest_wavelength=given.relief_longest_wave_m,
            seed=given.relief_seed,
        ),
        coral=substrate_of(reef_material(given), given),
        spacing=given.spacing_m,
    )


def _imported(given: kinds.SeabedSection, scenario: Scenario, corners: FloatArray) -> Seabed:
    """Return the seabed of a file, as far as it lies about corners (n, 2) on the map [m]."""
    from terrain import importers

    mission = scenario.mission
    common: dict[str, Any] = {
        "epsg": mission.crs_epsg,
        "vertical_epsg": mission.vertical_epsg,
        "reflectance": stated_reflectance(given.model_dump()),
    }
    nearby: dict[str, Any] = {"outline": corners, "margin": given.margin_m}
    if isinstance(given, kinds.RasterSeabed):
        return importers.from_raster(
            scenario.folder / given.file,
            band=given.band,
            nodata=given.nodata,
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

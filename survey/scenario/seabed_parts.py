"""The section [seabed] turned into terrain, in SI units and radians."""

from __future__ import annotations

from collections.abc import Sequence
from math import radians, tan
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from survey.scenario import seabed_sections as kinds
from survey.scenario.components import flight_plan
from survey.scenario.scenario import Scenario
from survey.scenario.seabed_files import cover, imported, roughness
from survey.scenario.seabed_materials import reef_material, stated_reflectance, substrate_of
from terrain.map_frame import MapFrame
from terrain.substrate import UNLABELLED

if TYPE_CHECKING:
    from terrain.generators import Ground
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
        seabed = imported(scenario, corners, frame)
    seabed = seabed.painted(seabed.substrate == UNLABELLED, substrate_of(given, given))
    if given.map is None:
        return seabed
    from terrain.cover_faces import covered

    return covered(seabed, cover(given.map, scenario, corners))


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
            roughness=roughness(given),
        )

    def start_along(self, ground: Ground) -> float:
        """Return how far along the ground's axis the flight starts, from its centre [m]."""
        axis = np.array([np.sin(ground.axis), np.cos(ground.axis)])
        return float((self.start - np.array(ground.centre)) @ axis)


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

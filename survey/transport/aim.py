"""Which way a track of light is turned, and through which facet of the waves, to reach a place.

A few azimuths of the track are tried, each with a facet of its own, and one is taken in proportion
to how likely it is that light comes that way: at the edge of the lit area others begin in the dark,
and a wave has facets of a slope only where it leans about so. How likely is told to first order,
which does no harm: light is weighted by the mean of those tried over the one that was taken
(resampled importance sampling, Talbot, Cline and Egbert 2005).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from survey.transport.beam import Ray, light_on_water
from survey.transport.launch import Optics, fraction
from survey.transport.layers import Layers
from survey.transport.light_sent import GAP, Facet, Method, Sight
from survey.transport.random import uniform
from survey.transport.scene import Scene
from survey.transport.surface import slope_density
from survey.transport.tracks import Course, Tracks, aside_of
from terrain.kernels import inlined_kernel
from terrain.waves.lattice import elevation_and_slopes

TRIED = 4
BLINDLY = 0.35
"""Share of the tracks that take any of those tried, likely or not.

For the column, whose light begins elsewhere, and where the guess is wrong: no weight is above
1 / 0.35. At 0.2 the column errs more than at any azimuth, at 0.5 the bottom under waves by a tenth
more than now: docs/engine.md.
"""


class Aim(NamedTuple):
    """The azimuth of a track, 0 to 1, the facet, and what its light counts for being taken."""

    turn: float
    facet: Facet
    weight: float


@inlined_kernel
def aimed(
    scene: Scene,
    layers: Layers,
    optics: Optics,
    method: Method,
    tracks: Tracks,
    sight: Sight,
    ray: Ray,
    depth: float,
    upright: float,
    way: Course,
    turn: float,
    state: NDArray[np.uint64],
) -> Aim:
    """Choose azimuth and facet of a track to a place at a ``depth``, the first azimuth being given.

    ``upright`` is the cosine of the light in the air to the vertical. A facet moves the entry by
    depth x (1 - cos air / (n cos water)) x its slope, to first order.
    """
    taken, facet, likely, total = turn, Facet(0.0, 0.0, 1.0), 1.0, 0.0
    in_water = 1.0 / math.sqrt(1.0 + ray.slope_x * ray.slope_x + ray.slope_y * ray.slope_y)
    bend = depth * (1.0 - upright / (layers.refractive_index * in_water))
    deeper = min(2.0, depth / max(scene.bounds.depth, GAP))
    blindly = uniform(state) < BLINDLY
    radius, angle = uniform(state), uniform(state)
    for i in range(TRIED):
        tried, chance = fraction(turn + i / TRIED), 1.0
        other = facet_at(scene, method, fraction(radius + i / TRIED), fraction(angle + i / TRIED))
        east, north = aside_of(layers, tracks, 2 * sight.batch, way, method.circle, tried)
        x = ray.x - deeper * east - bend * other.slope_x
        y = ray.y - deeper * north - bend * other.slope_y
        if scene.wavy:
            _, wave_x, wave_y = elevation_and_slopes(scene.waves, x, y)
            chance = slope_density(scene.sea, other.slope_x - wave_x, other.slope_y - wave_y)
            chance /= other.density
        if sight.rim:
            sea = scene.sea.level
            if light_on_water(optics, sea, x, y, sight.pixel, method.isolated) == 0.0:
                chance = 0.0
        total += chance
        if i == 0 or (not blindly and uniform(state) * total < chance):
            taken, facet, likely = tried, other, chance
    share = likely / total if total > 0.0 else 1.0 / TRIED
    share = (1.0 - BLINDLY) * share + BLINDLY / TRIED
    return Aim(taken, facet, 1.0 / (TRIED * share))


@inlined_kernel
def facet_at(scene: Scene, method: Method, radius: float, angle: float) -> Facet:
    """Return the facet at places from 0 to 1 of the two dimensions of the slopes drawn by."""
    sea, i = scene.drawn, int(angle * method.circle.shape[0])
    away = math.sqrt(-2.0 * math.log(1.0 - radius))
    up = sea.upwind_deviation * away * method.circle[i, 0]
    across = sea.crosswind_deviation * away * method.circle[i, 1]
    slope_x = up * sea.wind_east + across * sea.wind_north
    slope_y = up * sea.wind_north - across * sea.wind_east
    return Facet(slope_x, slope_y, slope_density(sea, slope_x, slope_y))

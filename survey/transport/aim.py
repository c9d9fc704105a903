"""Which way a track of light is turned, and through which facet of the waves, to reach a place.

A few azimuths of the track are tried, each with a facet of its own, and one is taken in proportion
to how likely it is that light comes that way: at the edge of the lit area others begin in the dark,
and a wave has facets of a slope only where it leans about so. How likely is told to first order.

That is fair whatever the guess (resampled importance sampling, Talbot, Cline and Egbert 2005). Of N
tries, each spread as it would be alone, let try j bring light g_j and be taken with a chance P_j
that is never zero. Its light counts 1 / (N P_j), so that on average the sum of P_j g_j / (N P_j) is
told: the mean of the g_j, which is right since each of them is. Here P_j is a share 1 - B of the
guess and B / N. The blind share B takes the first try, but the tries are evenly spaced modulo 1 and
any of them is as likely the first: over all such sets, too, it takes each as often.
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
from terrain.kernels import inlined_fused_kernel
from terrain.waves.lattice import elevation_and_slopes

TRIED = 4
BLINDLY, BLINDLY_WITH_COLUMN = 0.2, 0.35
"""Share of the tracks that take any of those tried, likely or not; no weight is above one over it.

It is what a wrong guess costs: at 0.05 the bottom of pixels at the rim errs a sixth more. Where the
track lights the column as well, whose light begins elsewhere, more of them are blind: on waves at
0.2 the column errs more than at any azimuth, at 0.5 the bottom a tenth more than now.
"""


class Aim(NamedTuple):
    """The azimuth of a track, 0 to 1, the facet, and what its light counts for being taken."""

    turn: float
    facet: Facet
    weight: float


@inlined_fused_kernel
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
    depth x (1 - cos air / (n cos water)) x its slope, to first order; what strays begins ``nearer``
    to the ray, as in `light_sent`.
    """
    taken, facet, likely, total = turn, Facet(0.0, 0.0, 1.0), 1.0, 0.0
    in_water = 1.0 / math.sqrt(1.0 + ray.slope_x * ray.slope_x + ray.slope_y * ray.slope_y)
    bend = depth * (1.0 - upright / (layers.refractive_index * in_water))
    deeper = min(2.0, depth / max(scene.bounds.depth, GAP))
    nearer = 1.0 / math.sqrt((1.0 + depth * ray.radial) * (1.0 + depth * ray.tangential))
    blind = BLINDLY_WITH_COLUMN if scene.wavy else BLINDLY
    blindly = uniform(state) < blind
    radius, angle = uniform(state), uniform(state)
    for i in range(TRIED):
        tried, chance = fraction(turn + i / TRIED), 1.0
        other = facet_at(scene, method, fraction(radius + i / TRIED), fraction(angle + i / TRIED))
        east, north = aside_of(layers, tracks, 2 * sight.batch, way, method.circle, tried)
        x = ray.x - nearer * (deeper * east + bend * other.slope_x)
        y = ray.y - nearer * (deeper * north + bend * other.slope_y)
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
    share = (1.0 - blind) * share + blind / TRIED
    return Aim(taken, facet, 1.0 / (TRIED * share))


@inlined_fused_kernel
def facet_at(scene: Scene, method: Method, radius: float, angle: float) -> Facet:
    """Return the facet at places from 0 to 1 of the two dimensions of the slopes drawn by."""
    sea, i = scene.drawn, int(angle * method.circle.shape[0])
    away = math.sqrt(-2.0 * math.log(1.0 - radius))
    up = sea.upwind_deviation * away * method.circle[i, 0]
    across = sea.crosswind_deviation * away * method.circle[i, 1]
    slope_x = up * sea.wind_east + across * sea.wind_north
    slope_y = up * sea.wind_north - across * sea.wind_east
    return Facet(slope_x, slope_y, slope_density(sea, slope_x, slope_y))

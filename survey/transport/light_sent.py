"""What the laser sends along a track that is laid to lead to a place.

A track of open water is turned into the direction of the laser's ray and shifted so that it leads
to the very place. It begins somewhere on the sea surface; if that is lit, track and walk make a
light path.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.transport.beam import Ray, light_on_water
from survey.transport.launch import Optics
from survey.transport.layers import Layers
from survey.transport.scene import Scene
from survey.transport.sheet import through_waves
from survey.transport.tally import Tally
from terrain.kernels import inlined_fused_kernel
from terrain.raycast import first_hit

GAP = 1e-3


class Method(NamedTuple):
    """How light paths are made: see `TransportSettings`.

    ``spacing`` of the points that light the column in scatterings [1], ``photons`` launched in a
    pulse.
    """

    split_cosine: float
    spacing: float
    isolated: bool
    photons: float
    quantiles: NDArray[np.float64]
    circle: NDArray[np.float64]


class Sight(NamedTuple):
    """A walk from a pixel as it enters the water.

    ``importance`` is its share of the pixel's etendue behind the surface [m2 sr]; light to a pixel
    at the ``rim`` of what is lit may begin in the dark. Tracks are taken in the order for the
    ``tilt`` at which the pixel looks down.
    """

    pixel: int
    batch: int
    time: float
    importance: float
    rim: bool
    tilt: int


class Facet(NamedTuple):
    """Where on waves a track is laid through: its slopes, and the ``density`` it was drawn by."""

    slope_x: float
    slope_y: float
    density: float


class Sent(NamedTuple):
    """What the laser sends along a track to a place: ``light`` [1/m2] and lengths [m].

    ``in_air``, how much ``deeper`` the track goes for its tilt, the ``straight`` way in the water,
    and the ``lift`` of the wave above mean level where the track enters.
    """

    light: float
    in_air: float
    deeper: float
    straight: float
    lift: float


@inlined_fused_kernel
def light_sent(
    scene: Scene,
    optics: Optics,
    method: Method,
    sight: Sight,
    ray: Ray,
    x: float,
    y: float,
    depth: float,
    east: float,
    north: float,
    slope_x: float,
    slope_y: float,
    facet: Facet,
    deepening: float,
) -> Sent:
    """Return what the laser sends along a track to a place.

    The track goes (``east``, ``north``) sideways to the place's ``depth``. Laid to the place it
    would begin somewhat ``aside`` of where the ray enters whose direction it has. The ray that
    enters there leans the other way, the more so the shallower neighbours part: it tilts the track,
    which then begins nearer, goes somewhat deeper and, on what passes through the place by
    (``slope_x``, ``slope_y``) per metre of depth, is thinned further. Departure: to first order, as
    if neighbours parted alike in all directions, and no more than doubled.

    Where a wave stands at the entry the track slides there along what goes through the place: the
    light slides over a fixed place, which then is deeper under the wave (``deepening`` 1), or a
    place of fixed depth over its light (0).
    """
    spread_r, spread_t = 1.0 + depth * ray.radial, 1.0 + depth * ray.tangential
    thinned = 1.0 / (spread_r * spread_t)
    shrink = math.sqrt(thinned)
    aside_x, aside_y = x - east - ray.x, y - north - ray.y
    px, py = ray.x + aside_x * shrink, ray.y + aside_y * shrink
    lean = 0.5 * (ray.radial + ray.tangential) * shrink
    stray_x, stray_y = east - depth * ray.slope_x, north - depth * ray.slope_y
    thinned *= min(2.0, max(0.0, 1.0 - lean * (stray_x * slope_x + stray_y * slope_y)))
    level, lift = scene.sea.level, 0.0
    if scene.wavy:
        lift, density = through_waves(scene, px, py, slope_x, slope_y, facet.slope_x, facet.slope_y)
        px, py, level = px - lift * slope_x, py - lift * slope_y, level + lift
        deeper_by = deepening * lift
        thinned *= density / facet.density * spread_r * spread_t
        thinned /= (spread_r + deeper_by * ray.radial) * (spread_t + deeper_by * ray.tangential)
    light = light_on_water(optics, level, px, py, sight.pixel, method.isolated)
    if light == 0.0:
        return Sent(0.0, 0.0, 0.0, 0.0, lift)
    dx, dy, dz = px - optics.position[0], py - optics.position[1], level - optics.position[2]
    in_air = math.sqrt(dx * dx + dy * dy + dz * dz)
    if scene.bounds.highest > scene.waves.lowest:
        _, face = first_hit(
            scene.grid, optics.position[0], optics.position[1], optics.position[2],
            dx / in_air, dy / in_air, dz / in_air, in_air,
        )  # fmt: skip
        if face >= 0:
            return Sent(0.0, 0.0, 0.0, 0.0, lift)
    deeper = -lean * (aside_x * stray_x + aside_y * stray_y)
    down = depth + deepening * lift
    straight = math.sqrt((x - px) ** 2 + (y - py) ** 2 + down * down)
    return Sent(light * thinned, in_air, deeper, straight, lift)


@inlined_fused_kernel
def longest_path(scene: Scene, layers: Layers, optics: Optics, sight: Sight) -> float:
    """Path in water [m] after which light to or from a walk comes later than the gate."""
    height = optics.position[2] - scene.waves.highest
    return float((scene.bounds.latest - sight.time - height / speed_of_light) * layers.speed)


@inlined_fused_kernel
def is_open(
    scene: Scene, tally: Tally, legs: int, last: float, x: float, y: float, level: float
) -> bool:
    """Tell whether a track, begun at (x, y, level), meets no bottom on its legs.

    Of the last leg only the length ``last`` counts, but for a last millimetre.
    """
    for i in range(legs):
        leg = tally.down[i]
        length = leg[6] if i < legs - 1 else last - GAP
        if length <= 0.0:
            continue
        z = level - leg[2]
        if min(z, z + leg[5] * length) > scene.bounds.highest:
            continue
        _, face = first_hit(scene.grid, x + leg[0], y + leg[1], z, leg[3], leg[4], leg[5], length)
        if face >= 0:
            return False
    return True

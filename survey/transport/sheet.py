"""Where light meets resolved waves: from the air, from below, and so that it reaches a place."""

from __future__ import annotations

import math

from survey.transport.scene import Scene
from survey.transport.surface import slope_density
from terrain.kernels import inlined_fused_kernel, leaf_kernel
from terrain.waves.lattice import elevation_and_slopes, meets_surface

ASIDE = 1.0
"""How much further than between crest and trough a ray is followed [m]: for rounding alone."""
BELOW = 1e-5
"""How far under the waves a walk goes on [m], lest it meet them where it is."""


@leaf_kernel
def first_water(
    scene: Scene, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> tuple[float, float, float]:
    """How far it is down to the water, and its slopes there; inf if a ray from the air misses."""
    if not scene.wavy:
        return (scene.sea.level - z) / dz, 0.0, 0.0
    reach = (scene.waves.lowest - z) / dz + ASIDE
    return meets_surface(scene.waves, x, y, z, dx, dy, dz, reach)


@leaf_kernel
def crest_or_trough(scene: Scene) -> float:
    """How far from mean level the waves go [m]."""
    waves = scene.waves
    return max(waves.highest - waves.level, waves.level - waves.lowest)


@leaf_kernel
def sea_under(scene: Scene, x: float, y: float) -> float:
    """Elevation just under the waves at a place [m]."""
    elevation, _, _ = elevation_and_slopes(scene.waves, x, y)
    return elevation - BELOW


@inlined_fused_kernel
def water_above(
    scene: Scene, x: float, y: float, z: float, dx: float, dy: float, dz: float, length: float
) -> tuple[float, float, float]:
    """How far it is up to the surface from below, and its slopes; inf if not within the length."""
    if not scene.wavy:
        if dz > 0.0 and scene.sea.level - z < dz * length:
            return (scene.sea.level - z) / dz, 0.0, 0.0
        return math.inf, 0.0, 0.0
    steepest, top = scene.waves.steepest, max(z, z + dz * length)
    if top < scene.waves.lowest or -dz > steepest * math.sqrt(dx * dx + dy * dy):
        return math.inf, 0.0, 0.0
    return meets_surface(scene.waves, x, y, z, dx, dy, dz, length)


@inlined_fused_kernel
def through_waves(
    scene: Scene, x: float, y: float, slope_x: float, slope_y: float, facet_x: float, facet_y: float
) -> tuple[float, float]:
    """How high the wave stands where a track begins [m], and how likely its facet is there [1].

    Begun at mean level the track would at (x, y); as it slides along what goes through its place by
    (``slope_x``, ``slope_y``) per metre of depth, it begins where that line meets the waves. The
    density of the facets' slopes is over how much closer the beginnings of neighbours then stand.
    Departure: a line flatter than waves are steep may meet several; it begins at mean level.
    """
    waves = scene.waves
    squared = slope_x * slope_x + slope_y * slope_y
    if squared * waves.steepest * waves.steepest >= 1.0:
        _, wave_x, wave_y = elevation_and_slopes(waves, x, y)
        return 0.0, slope_density(scene.sea, facet_x - wave_x, facet_y - wave_y)
    up, stretch = waves.highest - waves.level + ASIDE, math.sqrt(1.0 + squared)
    reach = (up + waves.level - waves.lowest + ASIDE) * stretch
    along, wave_x, wave_y = meets_surface(
        waves, x - up * slope_x, y - up * slope_y, waves.level + up,
        slope_x / stretch, slope_y / stretch, -1.0 / stretch, reach,
    )  # fmt: skip
    density = slope_density(scene.sea, facet_x - wave_x, facet_y - wave_y)
    closer = 1.0 + slope_x * wave_x + slope_y * wave_y
    return up - along / stretch, density / closer

"""The echo of the sea surface itself: no walk is needed, the slopes' statistics say it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.interface import fresnel_reflectance
from survey.transport.launch import Optics, direction_of, pixel_at, tangents_at
from survey.transport.scene import Scene
from survey.transport.sheet import first_water
from survey.transport.surface import return_per_steradian
from survey.transport.tally import TimeBins, deposit_in
from terrain.kernels import leaf_kernel
from terrain.raycast import first_hit

SAMPLES_ACROSS_PIXEL = 4
SAMPLES_ON_WAVES = 7  # 0.5 % error a pixel; 4 would fall into step with the sheet's nodes
MIRROR_SAMPLES = 4096


@leaf_kernel
def add_glint(
    histogram: NDArray[np.float32],
    bins: TimeBins,
    scene: Scene,
    optics: Optics,
    index: float,
    photons: float,
) -> None:
    """Add the return of a rough surface to every pixel, on a grid of directions in each."""
    n = SAMPLES_ON_WAVES if scene.wavy else SAMPLES_ACROSS_PIXEL
    rows, columns = optics.rows * n, optics.columns * n
    area = math.pi * optics.aperture_radius**2
    share = photons / (rows * columns)
    for sample in range(rows * columns):
        forward, right = tangents_at(
            optics, (sample // columns + 0.5) / rows, (sample % columns + 0.5) / columns
        )
        dx, dy, dz, cosine = direction_of(optics, forward, right)
        x, y, z = optics.position
        if dz >= 0.0:
            continue
        length, slope_x, slope_y = first_water(scene, x, y, z, dx, dy, dz)
        _, face = first_hit(scene.grid, x, y, z, dx, dy, dz, length)
        if face >= 0 or length == math.inf:
            continue
        returned = return_per_steradian(scene.sea, index, dx, dy, dz, slope_x, slope_y)
        returned *= share * area * cosine / (length * length)
        pixel = pixel_at(optics, forward, right)
        deposit_in(histogram, pixel, bins, 2.0 * length / speed_of_light, returned)


@leaf_kernel
def add_mirror(
    histogram: NDArray[np.float32],
    bins: TimeBins,
    scene: Scene,
    optics: Optics,
    index: float,
    photons: float,
) -> None:
    """Add the mirror image of the laser in still water: I0 rho A / (2 H)^2, seen at nadir.

    The image lies H under the surface; each part of the aperture sees it in its own direction,
    so that a nadir between pixels shares it among them.
    """
    height = optics.position[2] - scene.sea.level
    t = optics.turn
    intensity_down = photons / (4.0 * optics.half_forward * optics.half_right * (-t[2, 2]) ** 3)
    area = math.pi * optics.aperture_radius**2 * -t[2, 2]
    rho = fresnel_reflectance(1.0, 1.0 / index)
    share = intensity_down * rho * area / (2.0 * height) ** 2 / MIRROR_SAMPLES
    for i in range(MIRROR_SAMPLES):
        radius = optics.aperture_radius * math.sqrt((i + 0.5) / MIRROR_SAMPLES)
        angle = i * 2.399963229728653
        east, north = radius * math.cos(angle), radius * math.sin(angle)
        down = 2.0 * height
        forward = -(t[0, 0] * east + t[1, 0] * north) - t[2, 0] * down
        right = -(t[0, 1] * east + t[1, 1] * north) - t[2, 1] * down
        boresight = -(t[0, 2] * east + t[1, 2] * north) - t[2, 2] * down
        pixel = pixel_at(optics, forward / boresight, right / boresight)
        if pixel >= 0:
            deposit_in(histogram, pixel, bins, 2.0 * height / speed_of_light, share)

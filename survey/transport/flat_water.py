"""What the judges of the fast engine share: light of a flash in flat water of uniform depth.

The surface lies at up = 0 and is still, the bottom is flat and Lambertian. Absorption is a weight
along the path; scattering, bottom and internal reflection are events.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.interface import fresnel_reflectance, refracted
from survey.optics.phase import PhaseFunction
from survey.transport.launch import Optics, direction_of, pixel_at
from survey.transport.random import uniform
from survey.transport.table import value_at
from terrain.kernels import leaf_kernel

FloatArray = NDArray[np.float64]

COLUMN, BOTTOM = 0, 1
DENSITY_CELLS = 1 << 14
DISC_REACH, RINGS = 30.0, 2000
LEAST_STEP = 1e-8


def density_table(phase_function: PhaseFunction, *, disc: float = 0.0) -> FloatArray:
    """Return the density at evenly spaced square roots of sin(angle / 2), 0 to 1 [1/sr].

    So spaced, linear interpolation is good to 0.1 % in the forward peak of sea water down to
    1e-4 rad, and it follows the peak to 1e-8 rad. The first entry, where the power law of the peak
    has no bound, repeats the second.

    Parameters
    ----------
    phase_function : PhaseFunction
    disc : float
        Angular radius of a disc over whose directions the density is averaged [rad]; none at 0.
    """
    sine = np.linspace(0.0, 1.0, DENSITY_CELLS + 1) ** 2
    sine[0] = sine[1]
    angle = 2.0 * np.arcsin(sine)
    density = phase_function.density(angle)
    near = angle < DISC_REACH * disc
    if near.any():
        grid = np.geomspace(1e-4 * disc, 2.0 * DISC_REACH * disc, RINGS)
        within = np.array([phase_function.fraction_within(float(at)) for at in grid])
        density[near] = [_mean_over_disc(at, disc, grid, within) for at in angle[near]]
    return density


def _mean_over_disc(angle: float, disc: float, grid: FloatArray, within: FloatArray) -> float:
    """Return the mean density over a disc around a direction at this angle [1/sr].

    Ring by ring around the peak: the share of scattering in the ring times the part of its
    circumference that lies in the disc. ``within`` is the share of scattering within ``grid``.
    """
    edge = np.linspace(max(0.0, angle - disc), angle + disc, RINGS)
    ring = 0.5 * (edge[1:] + edge[:-1])
    cosine = (ring**2 + angle**2 - disc**2) / (2.0 * ring * angle)
    inside = np.arccos(np.clip(cosine, -1.0, 1.0)) / np.pi
    share = np.diff(np.interp(edge, grid, within, left=0.0))
    return float((inside * share).sum() / (np.pi * disc**2))


@leaf_kernel
def density_between(
    dx: float, dy: float, dz: float, wx: float, wy: float, wz: float, table: FloatArray
) -> float:
    """Density of scattering from one unit direction into another [1/sr], by `density_table`."""
    half_chord = 0.5 * math.sqrt((wx - dx) ** 2 + (wy - dy) ** 2 + (wz - dz) ** 2)
    return value_at(table, min(1.0, math.sqrt(half_chord)))


@leaf_kernel
def enter_flat_water(
    optics: Optics, index: float, state: NDArray[np.uint64]
) -> tuple[float, float, float, float, float, float, float]:
    """Draw a photon of the pulse: place under the surface, direction there, weight, time.

    The pulse fills the field of view evenly over its tangents. The weight is what Fresnel lets
    through.
    """
    forward = (2.0 * uniform(state) - 1.0) * optics.half_forward
    right = (2.0 * uniform(state) - 1.0) * optics.half_right
    ax, ay, az, _ = direction_of(optics, forward, right)
    length = -optics.position[2] / az
    dx, dy, dz = refracted(ax, ay, az, 0.0, 0.0, 1.0, 1.0 / index)
    return (
        optics.position[0] + ax * length,
        optics.position[1] + ay * length,
        dx,
        dy,
        dz,
        1.0 - fresnel_reflectance(-az, 1.0 / index),
        length / speed_of_light,
    )


@leaf_kernel
def seen_along(optics: Optics, ux: float, uy: float, uz: float) -> int:
    """Flat index of the pixel that sees light going along the unit vector u in air; -1 for none."""
    t = optics.turn
    boresight = -(t[0, 2] * ux + t[1, 2] * uy + t[2, 2] * uz)
    if boresight <= 0.0:
        return -1
    forward = -(t[0, 0] * ux + t[1, 0] * uy + t[2, 0] * uz) / boresight
    right = -(t[0, 1] * ux + t[1, 1] * uy + t[2, 1] * uz) / boresight
    return pixel_at(optics, forward, right)


@leaf_kernel
def way_to_event(depth: float, free: float, z: float, dz: float) -> tuple[float, bool]:
    """Way to the next event [m] and whether it is a scattering, not surface or bottom.

    ``free`` is the way to the next scattering [m].
    """
    wall = -z / dz if dz > 0.0 else (-depth - z) / dz if dz < 0.0 else math.inf
    return min(free, wall), free < wall


@leaf_kernel
def tangent_in_air(index: float, height: float, depth: float, aside: float) -> float:
    """Tangent off nadir, in air, of the ray from a point under water to one above it.

    Solves ``aside`` = height t + depth t / sqrt(n^2 + (n^2 - 1) t^2), Snell's law, by Newton's
    method: the right side is concave and rises, so that it converges from below, always. A last
    step of 1e-8 leaves an error of the order of its square.

    Examples
    --------
    >>> t = tangent_in_air(1.34, 200.0, 10.0, 30.0)
    >>> round(200.0 * t + 10.0 * math.tan(math.asin(math.sin(math.atan(t)) / 1.34)), 9)
    30.0
    """
    squared = index * index
    t = aside / (height + depth)
    while True:
        q = squared + (squared - 1.0) * t * t
        root = math.sqrt(q)
        miss = aside - height * t - depth * t / root
        step = miss / (height + depth * squared / (q * root))
        t += step
        if abs(step) <= LEAST_STEP * (1.0 + t):
            return t


@leaf_kernel
def solid_angle_per_area(index: float, height: float, depth: float, t: float) -> float:
    """Solid angle under water that goes through a unit of level area in air [sr/m2].

    The Jacobian sin(w) dw / (r dr) of the ray at the tangent t in air, w its angle in water and r
    its way aside; at nadir 1 / (n height + depth)^2.

    Examples
    --------
    >>> round(1.0 / solid_angle_per_area(1.34, 200.0, 10.0, 0.0)**0.5, 9)
    278.0
    """
    squared = index * index
    q = squared + (squared - 1.0) * t * t
    root = math.sqrt(q)
    cos_air = 1.0 / math.sqrt(1.0 + t * t)
    cos_water = root * cos_air / index
    along_aside = (height + depth / root) * (height + depth * squared / (q * root))
    return cos_air**4 / (squared * cos_water * along_aside)

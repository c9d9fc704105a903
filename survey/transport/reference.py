"""The reference engine: plain, slow, surely right. The fast engine is judged by it.

Light is followed forward alone, in one piece, from the laser to the aperture. Where the last event
before the surface is smooth (a bottom reflection, or a scattering by more than ``peak_angle``),
the chance to go straight into the camera is added in the textbook way (local estimate); where it
is a scattering within the forward peak, for which that estimate never settles, the light that does
arrive is counted. ``peak_angle = 0`` is the textbook estimator throughout, pi counts throughout.

The camera is the same as the fast engine's, pixels defined by the direction of the light. For
enough light to arrive, give it an aperture of many metres: both engines then simulate the same
giant telescope, and no approximation enters the comparison.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.flight.pose import Pose
from survey.optics.interface import fresnel_reflectance, reflected, refracted
from survey.optics.water import Water, WaterColumn
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser
from survey.sensor.receiver import Receiver
from survey.transport.directions import lambert_direction, turned
from survey.transport.engine import kernel_optics
from survey.transport.flat_water import (
    BOTTOM,
    COLUMN,
    density_between,
    density_table,
    enter_flat_water,
    seen_along,
    way_to_event,
)
from survey.transport.launch import Optics, direction_of
from survey.transport.layers import Layers, bend_at, crossed, free_path, kernel_layers, last_at
from survey.transport.random import REFERENCE, exponential, start_stream, uniform
from survey.transport.tally import TimeBins, deposit_in
from terrain.kernels import kernel, leaf_kernel

FloatArray = NDArray[np.float64]
AIMED, AIMED_WITHIN = 0.2, 1.0 - math.cos(math.radians(45.0))


@leaf_kernel
def _reaches_aperture(
    optics: Optics, x: float, y: float, z: float, ux: float, uy: float, uz: float
) -> float:
    """Distance along an upward ray to the aperture, or -1 when it misses."""
    px, py, pz = optics.position[0] - x, optics.position[1] - y, optics.position[2] - z
    bx, by, bz = optics.turn[0, 2], optics.turn[1, 2], optics.turn[2, 2]
    length = (px * bx + py * by + pz * bz) / (ux * bx + uy * by + uz * bz)
    miss = (px - ux * length) ** 2 + (py - uy * length) ** 2 + (pz - uz * length) ** 2
    return length if length > 0.0 and miss <= optics.aperture_radius**2 else -1.0


@leaf_kernel
def _line_of_view(
    optics: Optics, index: float, forward: float, right: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return direction of light in water, in air, and the view's solid angle in water there.

    The solid angle is that of the whole field of view if all of it were like this line: with a
    line drawn evenly over the tangent plane its inverse is the density per steradian in water.
    """
    ax, ay, az, cosine = direction_of(optics, forward, right)
    wx, wy, wz = refracted(ax, ay, az, 0.0, 0.0, 1.0, 1.0 / index)
    solid = 4.0 * optics.half_forward * optics.half_right * cosine**3
    return -wx, -wy, -wz, -ax, -ay, -az, solid * az / (wz * index * index)


@leaf_kernel
def _scattered(
    layers: Layers,
    depth: float,
    table: FloatArray,
    state: NDArray[np.uint64],
    dx: float,
    dy: float,
    dz: float,
) -> tuple[float, float, float, float]:
    """Draw a new direction; one in five is aimed upwards, and the weight makes up for it.

    Aimed directions fill a cone of 45 degrees evenly. Returns the direction and the factor
    p / (0.8 p + 0.2 aimed density) on the weight.
    """
    azimuth = 2.0 * math.pi * uniform(state)
    if uniform(state) < AIMED:
        nx, ny, nz = turned(0.0, 0.0, 1.0, AIMED_WITHIN * uniform(state), azimuth)
    else:
        nx, ny, nz = turned(dx, dy, dz, bend_at(layers, depth, uniform(state)), azimuth)
    aimed = 1.0 / (2.0 * math.pi * AIMED_WITHIN) if 1.0 - nz <= AIMED_WITHIN else 0.0
    density = density_between(dx, dy, dz, nx, ny, nz, table)
    return nx, ny, nz, density / ((1.0 - AIMED) * density + AIMED * aimed)


@leaf_kernel
def _score_straight_exit(
    histogram: FloatArray,
    bins: TimeBins,
    optics: Optics,
    layers: Layers,
    state: NDArray[np.uint64],
    x: float,
    y: float,
    depth: float,
    dx: float,
    dy: float,
    dz: float,
    table: FloatArray,
    peak_cosine: float,
    scatters: bool,
    weight: float,
    time: float,
) -> None:
    """Add the chance to leave for the camera in one straight line, on a random line of its view.

    Water sends by its phase function, the bottom cos/pi of what it does not absorb.
    """
    forward = (2.0 * uniform(state) - 1.0) * optics.half_forward
    right = (2.0 * uniform(state) - 1.0) * optics.half_right
    wx, wy, wz, ax, ay, az, solid = _line_of_view(optics, layers.refractive_index, forward, right)
    sent = wz / math.pi
    if scatters:
        if dx * wx + dy * wy + dz * wz >= peak_cosine:
            return
        sent = density_between(dx, dy, dz, wx, wy, wz, table)
    slant = depth / wz
    length = _reaches_aperture(optics, x + wx * slant, y + wy * slant, 0.0, ax, ay, az)
    if length < 0.0:
        return
    dimmed = crossed(layers, layers.absorption, layers.absorbed, depth, -wz, slant)
    dimmed += crossed(layers, layers.scattering, layers.scattered, depth, -wz, slant)
    passed = 1.0 - fresnel_reflectance(az, 1.0 / layers.refractive_index)
    score = weight * sent * solid * passed * math.exp(-dimmed)
    deposit_in(histogram, 0, bins, time + slant / layers.speed + length / speed_of_light, score)


@leaf_kernel
def _count_arrival(
    histogram: FloatArray,
    bins: TimeBins,
    optics: Optics,
    layers: Layers,
    x: float,
    y: float,
    dx: float,
    dy: float,
    dz: float,
    weight: float,
    time: float,
) -> None:
    """Count light that leaves the water if it hits the aperture within the field of view."""
    ux, uy, uz = refracted(dx, dy, dz, 0.0, 0.0, -1.0, layers.refractive_index)
    length = _reaches_aperture(optics, x, y, 0.0, ux, uy, uz)
    if length < 0.0:
        return
    if seen_along(optics, ux, uy, uz) >= 0:
        deposit_in(histogram, 0, bins, time + length / speed_of_light, weight)


@leaf_kernel
def _follow(
    column: FloatArray,
    bottom: FloatArray,
    bins: TimeBins,
    optics: Optics,
    layers: Layers,
    depth: float,
    rho: float,
    tables: FloatArray,
    peak_cosine: float,
    latest: float,
    state: NDArray[np.uint64],
    photons: float,
) -> None:
    """Follow one photon through flat water of uniform depth, the surface at up = 0."""
    x, y, dx, dy, dz, weight, time = enter_flat_water(optics, layers.refractive_index, state)
    weight *= photons
    z, into, estimated = 0.0, column, True
    while time < latest and weight > 0.0:
        free = free_path(layers, -z, -dz, exponential(state))
        step, scatters = way_to_event(depth, free, z, dz)
        absorbed = crossed(layers, layers.absorption, layers.absorbed, -z, -dz, step)
        x, y, z = x + dx * step, y + dy * step, z + dz * step
        time += step / layers.speed
        weight *= math.exp(-absorbed)
        if scatters:
            table = tables[layers.phase[last_at(layers.tops, -z)]]
            _score_straight_exit(
                into, bins, optics, layers, state, x, y, -z, dx, dy, dz,
                table, peak_cosine, True, weight, time,
            )  # fmt: skip
            ox, oy, oz = dx, dy, dz
            dx, dy, dz, factor = _scattered(layers, -z, table, state, dx, dy, dz)
            weight *= factor
            estimated = ox * dx + oy * dy + oz * dz < peak_cosine
        elif dz < 0.0:
            into, z, estimated = bottom, -depth, True
            weight *= rho
            _score_straight_exit(
                into, bins, optics, layers, state, x, y, depth, dx, dy, dz,
                tables[0], peak_cosine, False, weight, time,
            )  # fmt: skip
            dx, dy, dz = lambert_direction(0.0, 0.0, 1.0, state)
        else:
            z = 0.0
            if uniform(state) >= fresnel_reflectance(dz, layers.refractive_index):
                if not estimated:
                    _count_arrival(into, bins, optics, layers, x, y, dx, dy, dz, weight, time)
                return
            dx, dy, dz = reflected(dx, dy, dz, 0.0, 0.0, 1.0)


@kernel
def _batch(
    column: FloatArray,
    bottom: FloatArray,
    bins: TimeBins,
    optics: Optics,
    layers: Layers,
    depth: float,
    rho: float,
    tables: FloatArray,
    peak_cosine: float,
    latest: float,
    seed: int,
    batch: int,
    walks: int,
    photons: float,
) -> None:
    state = np.empty(2, np.uint64)
    for i in range(walks):
        start_stream(state, seed, REFERENCE, 0, batch, i)
        _follow(
            column, bottom, bins, optics, layers, depth, rho, tables, peak_cosine, latest, state,
            photons / walks,
        )  # fmt: skip


def reference_flash(
    *,
    water: Water | WaterColumn,
    depth: float,
    reflectance: float,
    laser: Laser,
    camera: Camera,
    receiver: Receiver,
    pose: Pose,
    walks_per_batch: int,
    batches: int,
    peak_angle: float,
    seed: int,
    threads: int = 2,
) -> FloatArray:
    """Return photons through the aperture, pooled over all pixels, without the pulse's width.

    The water's surface is flat at up = 0, its bottom flat and Lambertian.

    Parameters
    ----------
    water : Water or WaterColumn
        At all depths, or by depth.
    depth, reflectance : float
        Depth [m] and reflectance [1] of the bottom.
    laser, camera, receiver, pose
        The instrument; bins are the receiver's, height is the pose's third coordinate.
    walks_per_batch, batches : int
        The scatter among batches gives the error.
    peak_angle : float
        Scatterings by less than this are counted, not estimated [rad].
    seed, threads : int
        The result does not depend on the number of threads.

    Returns
    -------
    array (batches, 2, bins)
        Photons from column and bottom, one estimate a batch.
    """
    optics = kernel_optics(camera=camera, receiver=receiver, pose=pose)
    bins = TimeBins(receiver.gate_start, receiver.bin_width, receiver.bins)
    column = WaterColumn.of(water)
    layers = kernel_layers(column)
    tables = np.array([density_table(phase) for phase in column.phase_functions])
    result = np.zeros((batches, 2, receiver.bins))

    def run(batch: int) -> None:
        _batch(
            result[batch, COLUMN : COLUMN + 1], result[batch, BOTTOM : BOTTOM + 1], bins, optics,
            layers, depth, reflectance, tables, math.cos(peak_angle), receiver.gate_end,
            seed, batch, walks_per_batch, laser.photons_per_pulse,
        )  # fmt: skip

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(run, range(batches)))
    return result

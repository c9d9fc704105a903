"""The textbook engine: photons traced from the laser, each collision connected to the receiver.

Poole (1981): a photon is followed from the laser, and at every collision and every touch of the
bottom the chance to go straight to the receiver is added to the echo (local estimate, also called
next-event estimation). It is plain, complete and without bias; the fast engine's figure of merit
is counted in multiples of its own.

It settles slowly, for the connection meets the forward peak of sea water. Where the density goes
as angle^-s, the chance that a score exceeds x falls as x^(-2/s): for Petzold's waters, s above 1,
scores have a mean but no variance, and the error falls as N^(s/2 - 1), more slowly than N^(-1/2).
This ends where the peak is narrower than the receiver, some 2e-5 rad wide: the chance to reach it
is the mean of the density over its disc, which has a bound. What variance is left lies in few and
giant scores: in coastal water 10 m deep, all pixels pooled, it is 5e5 times the squared mean for
one photon, and most of that comes from fewer than one photon in a hundred million. The scatter of
shorter runs does not show it.

A point and a receiver are joined by one ray through a level surface, and by none or many through
waves: the textbook way takes the surface level there. The comparison with the fast engine is
therefore made over still water, where both are exact.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.flight.pose import Pose
from survey.optics.interface import fresnel_reflectance, reflected
from survey.optics.water import Water
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser
from survey.sensor.receiver import Receiver
from survey.transport.directions import drawn, lambert_direction, turned
from survey.transport.engine import kernel_optics
from survey.transport.flat_water import (
    BOTTOM,
    COLUMN,
    density_between,
    density_table,
    enter_flat_water,
    seen_along,
    solid_angle_per_area,
    tangent_in_air,
    way_to_event,
)
from survey.transport.launch import Optics
from survey.transport.random import REFERENCE, exponential, start_stream, uniform
from survey.transport.scene import Medium, forward_medium
from survey.transport.tally import TimeBins, deposit_in
from survey.transport.waveforms import blurred, padded_bins, pulse_taps
from terrain.kernels import kernel, leaf_kernel

FloatArray = NDArray[np.float64]

# Of the judges' addresses 0 to 2 are the reference engine's, the slab's and the profile's.
ADDRESS_OF_FLASHES = 3
ROULETTE_BELOW = 1e-4
ROULETTE_SURVIVAL = 0.1


class TextbookFlash(NamedTuple):
    """One flash of the textbook engine.

    ``photo_electrons`` (2, rows, columns, bins) are the mean photo-electrons from column and
    bottom; ``largest`` (2,) the largest single score in each of them [1].
    """

    photo_electrons: FloatArray
    largest: FloatArray


class Tally(NamedTuple):
    """Where scores go: histograms (2, pixels, bins) of column and bottom, the largest score."""

    histogram: FloatArray
    largest: FloatArray
    bins: TimeBins


@leaf_kernel
def _connect(
    tally: Tally,
    origin: int,
    optics: Optics,
    medium: Medium,
    x: float,
    y: float,
    depth: float,
    dx: float,
    dy: float,
    dz: float,
    table: FloatArray,
    scatters: bool,
    weight: float,
    time: float,
) -> None:
    """Add the chance to go from here to the receiver without another event.

    Water sends by its phase function, the bottom cos/pi of what it does not absorb.
    """
    index = medium.refractive_index
    to_x, to_y, height = optics.position[0] - x, optics.position[1] - y, optics.position[2]
    aside = math.sqrt(to_x * to_x + to_y * to_y)
    t = tangent_in_air(index, height, depth, aside)
    cos_air = 1.0 / math.sqrt(1.0 + t * t)
    sin_air = t * cos_air
    east, north = (to_x / aside, to_y / aside) if aside > 0.0 else (0.0, 0.0)
    ax, ay = sin_air * east, sin_air * north
    pixel = seen_along(optics, ax, ay, cos_air)
    if pixel < 0:
        return
    sin_water = sin_air / index
    cos_water = math.sqrt(1.0 - sin_water * sin_water)
    wx, wy = sin_water * east, sin_water * north
    sent = cos_water / math.pi
    if scatters:
        sent = density_between(dx, dy, dz, wx, wy, cos_water, table)
    turn = optics.turn
    facing = -(turn[0, 2] * ax + turn[1, 2] * ay + turn[2, 2] * cos_air)
    area = math.pi * optics.aperture_radius**2 * facing / cos_air
    slant = depth / cos_water
    passed = 1.0 - fresnel_reflectance(cos_air, 1.0 / index)
    kept = math.exp(-(medium.attenuation + medium.scattering) * slant)
    reach = area * solid_angle_per_area(index, height, depth, t)
    score = weight * sent * reach * passed * kept
    arrival = time + slant / medium.speed + height / cos_air / speed_of_light
    deposit_in(tally.histogram[origin], pixel, tally.bins, arrival, score)
    tally.largest[origin] = max(tally.largest[origin], score)


@leaf_kernel
def _follow(
    tally: Tally,
    optics: Optics,
    medium: Medium,
    depth: float,
    rho: float,
    table: FloatArray,
    latest: float,
    photons: float,
    state: NDArray[np.uint64],
) -> None:
    """Follow one photon, worth ``photons``, until it leaves the water or is too late."""
    index = medium.refractive_index
    x, y, dx, dy, dz, weight, time = enter_flat_water(optics, index, state)
    weight *= photons
    roulette_below = ROULETTE_BELOW * weight
    z, origin = 0.0, COLUMN
    while time < latest and weight > 0.0:
        step, scatters = way_to_event(depth, exponential(state) / medium.scattering, z, dz)
        x, y, z = x + dx * step, y + dy * step, z + dz * step
        time += step / medium.speed
        weight *= math.exp(-medium.attenuation * step)
        if scatters:
            _connect(tally, origin, optics, medium, x, y, -z, dx, dy, dz, table, True, weight, time)
            azimuth = 2.0 * math.pi * uniform(state)
            dx, dy, dz = turned(dx, dy, dz, drawn(medium.sampler, 1.0, state), azimuth)
        elif dz < 0.0:
            origin, z = BOTTOM, -depth
            weight *= rho
            _connect(
                tally, origin, optics, medium, x, y, depth, dx, dy, dz, table, False, weight, time
            )
            dx, dy, dz = lambert_direction(0.0, 0.0, 1.0, state)
        else:
            if uniform(state) >= fresnel_reflectance(dz, index):
                return
            dx, dy, dz = reflected(dx, dy, dz, 0.0, 0.0, 1.0)
            z = 0.0
        if weight < roulette_below:
            if uniform(state) >= ROULETTE_SURVIVAL:
                return
            weight /= ROULETTE_SURVIVAL


@kernel
def _walks(
    tally: Tally,
    optics: Optics,
    medium: Medium,
    depth: float,
    rho: float,
    table: FloatArray,
    latest: float,
    photons: float,
    walks: int,
    seed: int,
    frame: int,
) -> None:
    state = np.empty(2, np.uint64)
    for i in range(walks):
        start_stream(state, seed, REFERENCE, ADDRESS_OF_FLASHES, frame, i)
        _follow(tally, optics, medium, depth, rho, table, latest, photons / walks, state)


def textbook_flash(
    *,
    water: Water,
    depth: float,
    reflectance: float,
    laser: Laser,
    camera: Camera,
    receiver: Receiver,
    pose: Pose,
    photo_electrons_per_photon: float,
    walks: int,
    seed: int,
    frame: int,
) -> TextbookFlash:
    """Return what every pixel may expect of one flash over flat water, flooded with light.

    The same question as `survey.transport.engine.Engine.flash` answers over still water, the glint
    of its surface apart. Poole, L. R. (1981), local estimate. One flash runs in one thread and
    lets others run.

    Parameters
    ----------
    water : Water
    depth, reflectance : float
        Depth [m] and reflectance [1] of the flat Lambertian bottom; the surface is at up = 0.
    laser, camera, receiver, pose
        The instrument; the pose's third coordinate is the height.
    photo_electrons_per_photon : float
        Optics transmission x detection efficiency [1].
    walks : int
        Photons traced.
    seed, frame : int
        Address of the flash: the same numbers trace the same photons.

    Returns
    -------
    TextbookFlash

    Raises
    ------
    ValueError
        When an argument lies outside its range, all of them named at once.
    """
    faults = [
        message
        for bad, message in (
            (not depth > 0.0, "depth must be above 0"),
            (not 0.0 <= reflectance <= 1.0, "reflectance must lie in 0 to 1"),
            (not pose.position[2] > 0.0, "the pose must be above the water"),
            (walks < 1, "walks must be 1 or more"),
        )
        if bad
    ]
    if faults:
        raise ValueError("textbook_flash: " + "; ".join(faults))
    bins, pad = padded_bins(
        start=receiver.gate_start,
        width=receiver.bin_width,
        bins=receiver.bins,
        sigma=laser.pulse_sigma,
    )
    disc = receiver.aperture_radius / (water.refractive_index * pose.position[2] + depth)
    tally = Tally(np.zeros((2, camera.rows * camera.columns, bins.number)), np.zeros(2), bins)
    _walks(
        tally, kernel_optics(camera=camera, receiver=receiver, pose=pose), forward_medium(water),
        depth, reflectance, density_table(water.phase_function, disc=disc),
        bins.start + bins.number * bins.width,
        laser.photons_per_pulse * photo_electrons_per_photon, walks, seed, frame,
    )  # fmt: skip
    taps = pulse_taps(sigma=laser.pulse_sigma, width=receiver.bin_width, pad=pad)
    echoes = [blurred(origin, taps) for origin in tally.histogram]
    shape = (2, camera.rows, camera.columns, receiver.bins)
    return TextbookFlash(np.stack(echoes).reshape(shape), tally.largest)

"""Every avalanche of a SPAD array, one after the other; times count in bins.

Candidates for an avalanche (photons, afterpulses, crosstalk) wait in one list for each bin and are
taken bin after bin. A candidate that finds its pixel dead is lost. Pixels draw from generators of
their own, so that what one pixel draws does not depend on the others.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import kernel, leaf_kernel

FloatArray = NDArray[np.float64]

PHOTON, AFTERPULSE, CROSSTALK = range(3)
NOTHING = -1
NEVER = 1e300

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)


class Diodes(NamedTuple):
    """One SPAD array as kernels take it; probabilities [1], times [bins]."""

    rows: int
    columns: int
    efficiency: float
    dead_time: float
    afterpulse_probability: float
    afterpulse_lifetime: float
    crosstalk_probability: float
    jitter: float


class Candidates(NamedTuple):
    """Possible avalanches, listed by bin: first of each bin, next in the list, what they are."""

    first: NDArray[np.int32]
    next: NDArray[np.int32]
    time: FloatArray
    pixel: NDArray[np.int32]
    kind: NDArray[np.int8]


class Found(NamedTuple):
    """What the avalanches leave behind.

    Parameters
    ----------
    counts : array (pixels, bins)
        Avalanches by the bin that they are timed in.
    deaths : array (pixels, bins + 1)
        Pulses that die in a bin less those that revive; its running sum are the dead ones.
    tag_pixel, tag_pulse, tag_time : array (room,)
        The counts one by one, as far as there is room.
    """

    counts: NDArray[np.int32]
    deaths: NDArray[np.int32]
    tag_pixel: NDArray[np.int32]
    tag_pulse: NDArray[np.int32]
    tag_time: NDArray[np.float32]


@leaf_kernel
def _uniform(state: NDArray[np.uint64], pixel: int) -> float:
    """Next uniform number in [0, 1) of a pixel's SplitMix64 (Steele et al. 2014)."""
    state[pixel] += _GOLDEN
    value = state[pixel]
    value = (value ^ (value >> np.uint64(30))) * _MIX_1
    value = (value ^ (value >> np.uint64(27))) * _MIX_2
    value ^= value >> np.uint64(31)
    return float(value >> np.uint64(11)) / 9007199254740992.0


@leaf_kernel
def _exponential(state: NDArray[np.uint64], pixel: int) -> float:
    return -math.log(1.0 - _uniform(state, pixel))


@leaf_kernel
def _normal(state: NDArray[np.uint64], pixel: int) -> float:
    radius = math.sqrt(2.0 * _exponential(state, pixel))
    return radius * math.cos(2.0 * math.pi * _uniform(state, pixel))


@leaf_kernel
def _next_photon(
    photons: FloatArray, pixel: int, time: float, efficiency: float, state: NDArray[np.uint64]
) -> float:
    """Return when the next photon comes that starts an avalanche if it finds the pixel live.

    ``photons`` (pixels, bins + 1) are running sums of expected photons. All photons are drawn, and
    each has a mark that tells from which efficiency on it is detected.
    """
    bins = photons.shape[1] - 1
    if time >= bins:
        return NEVER
    low = int(time)
    target = photons[pixel, low] + (time - low) * (photons[pixel, low + 1] - photons[pixel, low])
    while True:
        target += _exponential(state, pixel)
        if target >= photons[pixel, bins]:
            return NEVER
        if _uniform(state, pixel) < efficiency:
            break
    high = bins
    while high - low > 1:
        middle = (low + high) // 2
        if photons[pixel, middle] <= target:
            low = middle
        else:
            high = middle
    below, above = photons[pixel, low], photons[pixel, low + 1]
    return float(low + (target - below) / (above - below))


@leaf_kernel
def _enlist(waiting: Candidates, free: int, time: float, pixel: int, kind: int) -> int:
    """Put a candidate into the list of its bin; return the next free place, or what was free."""
    if time >= waiting.first.shape[0] or free == NOTHING:
        return free
    after, place = int(waiting.next[free]), int(time)
    waiting.time[free], waiting.pixel[free], waiting.kind[free] = time, pixel, kind
    waiting.next[free] = waiting.first[place]
    waiting.first[place] = free
    return after


@leaf_kernel
def _note(
    found: Found, pixel: int, pulse: int, time: float, diodes: Diodes, number: int,
    state: NDArray[np.uint64],
) -> int:  # fmt: skip
    """Note an avalanche; return how many have been timed within the gate."""
    bins = found.counts.shape[1]
    dies, revives = int(time + 0.5), int(min(time + diodes.dead_time, bins) + 0.5)
    found.deaths[pixel, min(dies, bins)] += 1
    found.deaths[pixel, min(revives, bins)] -= 1
    if diodes.jitter > 0.0:
        time += diodes.jitter * _normal(state, pixel)
    if time < 0.0 or time >= bins:
        return number
    found.counts[pixel, int(time)] += 1
    if number < found.tag_pixel.shape[0]:
        found.tag_pixel[number], found.tag_pulse[number] = pixel, pulse
        found.tag_time[number] = time
    return number + 1


@leaf_kernel
def _consequences(
    waiting: Candidates, free: int, time: float, pixel: int, diodes: Diodes,
    state: NDArray[np.uint64],
) -> int:  # fmt: skip
    """Enlist the afterpulse and the crosstalk of an avalanche."""
    afterpulse = diodes.afterpulse_probability
    if afterpulse > 0.0 and _uniform(state, pixel) < afterpulse:
        delay = diodes.dead_time + diodes.afterpulse_lifetime * _exponential(state, pixel)
        free = _enlist(waiting, free, time + delay, pixel, AFTERPULSE)
    if diodes.crosstalk_probability > 0.0:
        row, column = pixel // diodes.columns, pixel % diodes.columns
        for side in range(4):
            beside_row = row + (side == 0) - (side == 1)
            beside_column = column + (side == 2) - (side == 3)
            if _uniform(state, pixel) >= diodes.crosstalk_probability:
                continue
            if 0 <= beside_row < diodes.rows and 0 <= beside_column < diodes.columns:
                beside = beside_row * diodes.columns + beside_column
                free = _enlist(waiting, free, time, beside, CROSSTALK)
    return free


@kernel
def avalanches(
    found: Found,
    photons: FloatArray,
    armed: NDArray[np.bool_],
    diodes: Diodes,
    first_pulse: int,
    pulses: int,
    waiting: Candidates,
    state: NDArray[np.uint64],
    number: int,
) -> int:
    """Let all pixels fire through the gate, pulse after pulse; return the count, timed ones.

    Every pulse finds all pixels live. Within a bin candidates come in the order of their lists,
    so that dead time between pixels' own candidates is kept to a bin.

    Parameters
    ----------
    found : Found
        Is added to.
    photons : array (pixels, bins + 1)
        Running sums of the photons expected of one pulse in the armed bins.
    armed : array (pixels or 1, bins)
        Where avalanches are possible.
    diodes : Diodes
    first_pulse, pulses : int
        Number of the first pulse, and how many.
    waiting : Candidates
        Room for the lists.
    state : array (pixels,)
        Generators.
    number : int
        Counts so far.

    Returns
    -------
    int
        Counts so far; -1 when the lists were too short.
    """
    pixels, bins = found.counts.shape
    room = waiting.next.shape[0]
    live_from = np.empty(pixels)
    for pulse in range(first_pulse, first_pulse + pulses):
        live_from[:] = 0.0
        waiting.first[:] = NOTHING
        for place in range(room):
            waiting.next[place] = place + 1 if place + 1 < room else NOTHING
        free = 0
        for pixel in range(pixels):
            time = _next_photon(photons, pixel, 0.0, diodes.efficiency, state)
            free = _enlist(waiting, free, time, pixel, PHOTON)
        for place in range(bins):
            while waiting.first[place] != NOTHING:
                if free == NOTHING:
                    return NOTHING
                taken = waiting.first[place]
                waiting.first[place] = waiting.next[taken]
                waiting.next[taken] = free
                free = taken
                time, pixel = waiting.time[taken], waiting.pixel[taken]
                kind = waiting.kind[taken]
                live = time >= live_from[pixel] and armed[pixel % armed.shape[0], place]
                if live:
                    number = _note(found, pixel, pulse, time, diodes, number, state)
                    live_from[pixel] = time + diodes.dead_time
                    free = _consequences(waiting, free, time, pixel, diodes, state)
                if kind == PHOTON:
                    start = max(time, live_from[pixel])
                    time = _next_photon(photons, pixel, start, diodes.efficiency, state)
                    free = _enlist(waiting, free, time, pixel, PHOTON)
    return number

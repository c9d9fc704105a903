"""Mean counts of a SPAD array, without chance; times count in bins.

A pixel is dead while its last avalanche is younger than the dead time, and there is at most one
such avalanche: P(live) = 1 - mean avalanches within the last dead time, which is exact for Poisson
light and a dead time that further photons do not prolong. Afterpulses and crosstalk are taken as
further candidates that come independently of whether the pixel is live.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from survey.sensor.spad_events import Diodes
from terrain.kernels import kernel, leaf_kernel

FloatArray = NDArray[np.float64]

SMALL = 1e-2


@leaf_kernel
def _shares(candidates: float) -> tuple[float, float]:
    """Return which share of pixels fires in a step: of those live, and of those that revive in it.

    1 - exp(-x), and 1 - [1 - exp(-x)] / x where they revive evenly over the step.
    """
    if candidates < SMALL:
        at_once = candidates * (1.0 - candidates * (0.5 - candidates / 6.0))
        return at_once, candidates * (0.5 - candidates * (1.0 / 6.0 - candidates / 24.0))
    at_once = -math.expm1(-candidates)
    return at_once, 1.0 - at_once / candidates


@leaf_kernel
def _revived(fired: FloatArray, step: int, pixel: int, dead_time: float) -> float:
    """Return the share that comes out of its dead time in a step."""
    whole = int(dead_time)
    part = dead_time - whole
    share = 0.0
    if step >= whole:
        share += (1.0 - part) * fired[step - whole, pixel]
    if step >= whole + 1:
        share += part * fired[step - whole - 1, pixel]
    return share


@leaf_kernel
def _beside(fired: FloatArray, step: int, pixel: int, diodes: Diodes) -> float:
    """Return the mean avalanches of a pixel's neighbours in a step."""
    row, column = pixel // diodes.columns, pixel % diodes.columns
    total = 0.0
    if row > 0:
        total += fired[step, pixel - diodes.columns]
    if row + 1 < diodes.rows:
        total += fired[step, pixel + diodes.columns]
    if column > 0:
        total += fired[step, pixel - 1]
    if column + 1 < diodes.columns:
        total += fired[step, pixel + 1]
    return total


@kernel
def mean_avalanches(
    light: FloatArray, armed: NDArray[np.bool_], diodes: Diodes, steps: int
) -> FloatArray:
    """Return the mean avalanches of one pulse (bins, pixels).

    Parameters
    ----------
    light : array (bins, pixels)
        Photo-electrons expected in armed bins.
    armed : array (bins, pixels or 1)
        Where avalanches are possible.
    diodes : Diodes
    steps : int
        Steps of a bin; one must not be longer than the dead time, unless that is 0.
    """
    bins, pixels = light.shape
    dead_time = max(diodes.dead_time * steps, 1.0) if diodes.dead_time > 0.0 else 0.0
    decay = math.exp(-1.0 / (steps * max(diodes.afterpulse_lifetime, 1e-12)))
    result = np.zeros((bins, pixels))
    fired = np.zeros((bins * steps, pixels))
    revived, alone, gain = np.zeros(pixels), np.zeros(pixels), np.zeros(pixels)
    live, trapped = np.ones(pixels), np.zeros(pixels)
    generations = 2 if diodes.crosstalk_probability > 0.0 else 0
    for step in range(bins * steps):
        place = step // steps
        for pixel in range(pixels):
            if dead_time > 0.0:
                revived[pixel] = _revived(fired, step, pixel, dead_time)
            elif step > 0:
                revived[pixel] = fired[step - 1, pixel]
            trapped[pixel] += diodes.afterpulse_probability * revived[pixel]
            released = trapped[pixel] * (1.0 - decay)
            trapped[pixel] -= released
            open_now = armed[place, pixel % armed.shape[1]]
            candidates = light[place, pixel] / steps + (released if open_now else 0.0)
            if dead_time > 0.0:
                at_once, late = _shares(candidates)
                alone[pixel] = live[pixel] * at_once + revived[pixel] * late
                alive = live[pixel] + 0.5 * revived[pixel] - alone[pixel]
            else:
                alone[pixel], alive = candidates, 1.0
            gain[pixel] = diodes.crosstalk_probability * max(alive, 0.0) * open_now
            fired[step, pixel] = alone[pixel]
        for _ in range(generations):
            for pixel in range(pixels):
                fired[step, pixel] = alone[pixel] + gain[pixel] * _beside(
                    fired, step, pixel, diodes
                )
        for pixel in range(pixels):
            result[place, pixel] += fired[step, pixel]
            live[pixel] += revived[pixel] - fired[step, pixel]
    return result

"""The engine on one uniform water column, defined so that others can compute the same.

The surface is still and index-matched: nothing is reflected there, and light that goes up through
it is gone. No 1/n^2, no receiver factors, no pulse. The source shines straight down, evenly over a
square of 2 x 2 m (`isolated`) or over the whole plane (`flood`); the receiver takes the vertical
radiance, evenly over the same square.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.water import Water
from survey.transport.random import BACKWARD, FORWARD, chance
from survey.transport.response_column import column_batches
from survey.transport.response_echo import first_arrivals
from survey.transport.response_walks import BATCHES, Footprint
from survey.transport.scene import Medium, forward_medium

FloatArray = NDArray[np.float64]
Illumination = Literal["flood", "isolated"]

SQUARE = Footprint(side=2.0, growth=0.0)
BIN = 0.5
GATE = 10e-9
OPTICAL_DEPTH = 8.0
ARRIVALS_PER_BATCH = 6000
PAIRINGS = 8


class ResponseError(ValueError):
    """A water column that cannot answer; a line for each fault."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A number with its standard error."""

    value: float
    sem: float


@dataclass(frozen=True, kw_only=True)
class Response:
    """What a water column sends back.

    Parameters
    ----------
    bin_edges : array (bins + 1,)
        Of half the path length [m].
    column, column_sem : array (bins,)
        Attenuated backscatter of bottomless water, averaged over a bin, and its standard error
        [1/(m sr)]; single scattering alone is b p(180 deg) exp(-2 c z).
    bottom_depth : float
        Depth of the bottom [m].
    two_way : Estimate
        Two-way transmission of light that touched the bottom once: rho / pi times it is the echo.
    two_way_10ns : Estimate
        The part of it within 10 ns of the direct echo.
    mean_excess_path : float
        Mean two-way path beyond 2 z, weighted by light [m].
    blur_radius : float
        Radius around the square's centre that holds half of its two-way light [m].
    """

    bin_edges: FloatArray
    column: FloatArray
    column_sem: FloatArray
    bottom_depth: float
    two_way: Estimate
    two_way_10ns: Estimate
    mean_excess_path: float
    blur_radius: float


def response(
    *, water: Water, illumination: Illumination, bottom_depth: float, seed: int = 1
) -> Response:
    """Return column and bottom of one water, each by 64 independent batches.

    Parameters
    ----------
    water : Water
        Absorbs and scatters; its group index times the 10 ns.
    illumination : {"flood", "isolated"}
    bottom_depth : float
        Above 0 [m].
    seed : int

    Raises
    ------
    ResponseError
        When the water does not scatter or the depth is not positive.
    """
    faults = []
    if not water.scattering > 0.0:
        faults.append("response: scattering must be above 0: without it nothing comes back")
    if not (math.isfinite(bottom_depth) and bottom_depth > 0.0):
        faults.append(f"response: bottom depth {bottom_depth:g} m must be above 0")
    if faults:
        raise ResponseError("\n".join(faults))
    which = ("flood", "isolated").index(illumination)
    bins = math.ceil(OPTICAL_DEPTH / water.attenuation / BIN)
    column = column_batches(water=water, footprint=SQUARE, bins=bins, bin_width=BIN, seed=seed)
    column = column[:, which]
    bottom = _bottom_batches(water, bottom_depth, which, seed)
    mean, sem = column.mean(axis=0), column.std(axis=0, ddof=1) / BATCHES**0.5
    return Response(
        bin_edges=np.arange(column.shape[1] + 1) * BIN,
        column=mean,
        column_sem=sem,
        bottom_depth=bottom_depth,
        two_way=_estimate(bottom.two_way),
        two_way_10ns=_estimate(bottom.within_gate),
        mean_excess_path=bottom.excess.sum() / bottom.two_way.sum(),
        blur_radius=bottom.blur_radius,
    )


@dataclass(frozen=True, kw_only=True)
class _Bottom:
    two_way: FloatArray
    within_gate: FloatArray
    excess: FloatArray
    blur_radius: float


def _bottom_batches(water: Water, depth: float, which: int, seed: int) -> _Bottom:
    """Pair full walks down and full walks up: one touch of the bottom splits the path."""
    medium = forward_medium(water)
    two_way, within, excess = np.zeros((3, BATCHES))
    radii, lights = [], []
    for batch in range(BATCHES):
        there, back = (
            _arrivals(medium, depth, seed, purpose, batch) for purpose in (FORWARD, BACKWARD)
        )
        draws = chance(seed=seed, purpose=FORWARD, frame=batch)
        for shift in range(1, PAIRINGS + 1):
            met = np.roll(there, shift, axis=0)
            apart = met[:, :2] - back[:, :2]
            overlap = np.prod(np.clip(1.0 - np.abs(apart) / SQUARE.side, 0.0, None), axis=1)
            light = met[:, 3] * back[:, 3] * (overlap if which else 1.0) / PAIRINGS
            late = met[:, 2] + back[:, 2] - 2.0 * depth
            two_way[batch] += light.mean()
            within[batch] += light[late * water.group_index <= GATE * speed_of_light].sum() / len(
                light
            )
            excess[batch] += (light * late).mean()
            start = _starts(apart if which else np.zeros_like(apart), draws)
            radii.append(np.hypot(*(start + back[:, :2]).T))
            lights.append(light)
    return _Bottom(
        two_way=two_way,
        within_gate=within,
        excess=excess,
        blur_radius=_weighted_median(np.concatenate(radii), np.concatenate(lights)),
    )


def _starts(apart: FloatArray, draws: np.random.Generator) -> FloatArray:
    """Draw where in the square a walk back begins, its forward partner beginning there too."""
    low = np.clip(-0.5 * SQUARE.side + apart, -0.5 * SQUARE.side, 0.5 * SQUARE.side)
    high = np.clip(0.5 * SQUARE.side + apart, -0.5 * SQUARE.side, 0.5 * SQUARE.side)
    return np.asarray(low + (high - low) * draws.random(apart.shape))


def _weighted_median(values: FloatArray, weights: FloatArray) -> float:
    order = np.argsort(values)
    reached = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(reached, 0.5 * reached[-1])])


def _arrivals(medium: Medium, depth: float, seed: int, purpose: int, batch: int) -> FloatArray:
    """Return x, y, path and weight of walks at the bottom; weight 0 for those that never arrive."""
    arrivals = np.zeros((ARRIVALS_PER_BATCH, 1, 4))
    first_arrivals(arrivals, medium, np.array([depth]), seed, purpose, batch)
    return arrivals[:, 0]


def _estimate(batches: FloatArray) -> Estimate:
    return Estimate(value=float(batches.mean()), sem=float(batches.std(ddof=1) / BATCHES**0.5))

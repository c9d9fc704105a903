"""Why an echo was too weak: one change of the truth at a time, and would it have been found?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from survey.cloud.bottom_search import BottomSearch
from survey.cloud.points import Outcome
from survey.cloud.truth import TrueTargets
from survey.optics.water import WaterColumn
from survey.optics.water.apparent import diffuse_attenuation

FloatArray = NDArray[np.float64]

USUAL_REFLECTANCE = 0.1
"""Below it a bottom is called dark: the reflectance that scenarios have unless told."""
WOULD_BE_FOUND = 0.5


def weak_causes(
    *,
    outcome: NDArray[np.uint8],
    bottom: FloatArray,
    surface: FloatArray,
    targets: TrueTargets,
    water: WaterColumn,
    search: BottomSearch,
) -> NDArray[np.uint8]:
    """Return the outcomes with every TOO_DEEP replaced by a nearer cause where there is one.

    A cause is named where the probability of detection, below one half as it is, would be one half
    or more if one thing were otherwise. The first that holds:

    ===================  =========================================================================
    GLINT                the surface of the water sent no laser light back
    TOO_TURBID           all the water above the bottom were as clear as its clearest layer there;
                         the light grows by exp(2 (integral of K_d - K_d of that layer x path))
    LOW_REFLECTANCE      the bottom reflected 0.1; its light grows in proportion, neighbours' light
                         that scatters into the pixel included
    TOO_DEEP             none of these: uniform water, a bottom not dark, and still no echo
    ===================  =========================================================================

    Parameters
    ----------
    outcome : array (rows, columns)
        `Outcome`, TOO_DEEP for all echoes that are too weak.
    bottom, surface : array (rows, columns, bins)
        Expected photo-electrons of bottom and surface.
    targets : TrueTargets
    water : WaterColumn
        The true one.
    search : BottomSearch
        How the bottom was looked for.
    """
    weak = outcome == Outcome.TOO_DEEP
    if not weak.any():
        return outcome
    gains = {
        Outcome.LOW_REFLECTANCE: _brighter(targets.reflectance),
        Outcome.TOO_TURBID: _clearer(water, targets.depth, targets.water_path),
    }
    result = outcome.copy()
    for cause, gain in gains.items():
        helped = weak & (gain > 1.0)
        if helped.any():
            result[helped & _found(search, bottom * gain[..., None])] = cause
    result[weak & _found(search.without(surface), bottom)] = Outcome.GLINT
    return result


def _found(search: BottomSearch, bottom: FloatArray) -> NDArray[np.bool_]:
    return search.probability(bottom) >= WOULD_BE_FOUND


def _clearer(water: WaterColumn, depth: FloatArray, path: FloatArray) -> FloatArray:
    """Return by how much the echo would grow in the clearest of the layers above the bottom."""
    if len(water.layers) == 1:
        return np.ones(depth.shape)
    wet = depth > 0.0
    deep = np.where(wet, depth, 1.0)
    loss = np.array([diffuse_attenuation(layer.water) for layer in water.layers])
    tops = np.array([layer.top for layer in water.layers])
    clearest = np.minimum.accumulate(loss)[np.searchsorted(tops, deep, side="left") - 1]
    excess = water.integral(deep, diffuse_attenuation) - clearest * deep
    gain = np.exp(2.0 * np.maximum(excess, 0.0) * path / deep)
    return np.where(wet & np.isfinite(gain), gain, 1.0)


def _brighter(reflectance: FloatArray) -> FloatArray:
    """Return by how much the echo would grow over a bottom of the usual reflectance."""
    known = np.where(reflectance > 0.0, reflectance, USUAL_REFLECTANCE)
    return np.maximum(USUAL_REFLECTANCE / known, 1.0)

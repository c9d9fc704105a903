"""Why an echo was too weak: one change of the truth at a time, and would it have been found?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from survey.cloud.noise import NoiseModel, gate_scatter, gate_sums
from survey.cloud.points import Outcome
from survey.cloud.ranging import bottom_detection_probability
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
    noise: NoiseModel,
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
    noise : NoiseModel
    """
    weak = outcome == Outcome.TOO_DEEP
    if not weak.any():
        return outcome
    light, here = bottom[weak][None], _of_pixels(noise, weak)
    growth = {
        Outcome.TOO_TURBID: _clearer(water, targets.depth[weak], targets.water_path[weak]),
        Outcome.LOW_REFLECTANCE: _brighter(targets.reflectance[weak]),
    }
    cause = np.full(light.shape[1], Outcome.TOO_DEEP)
    for name in (Outcome.LOW_REFLECTANCE, Outcome.TOO_TURBID):
        gain = growth[name]
        if (gain > 1.0).any():
            found = _found(light * gain[:, None], here) & (gain > 1.0)
            cause[found] = name
    cause[_found(light, _without_surface(here, surface[weak][None]))] = Outcome.GLINT
    result = outcome.copy()
    result[weak] = cause
    return result


def _found(bottom: FloatArray, noise: NoiseModel) -> NDArray[np.bool_]:
    probability = bottom_detection_probability(bottom=bottom, noise=noise)[0]
    return np.asarray(probability >= WOULD_BE_FOUND)


def _of_pixels(noise: NoiseModel, which: NDArray[np.bool_]) -> NoiseModel:
    """Return the model of some pixels alone, as one row of them."""
    names = ("bottomless_light", "bottomless", "bottom_threshold", "allowance")
    return replace(noise, **{name: getattr(noise, name)[which][None] for name in names})


def _without_surface(noise: NoiseModel, surface: FloatArray) -> NoiseModel:
    """Return the model of water whose surface sends nothing back, with its thresholds.

    What else has raised the thresholds, such as the doubt of a flash, stays.
    """
    light = np.maximum(noise.bottomless_light - surface, noise.steady_light)
    mean, dark = noise.detector.mean(light), _threshold(noise, light)
    raised = np.maximum(_threshold(noise, noise.bottomless_light) - dark, 0.0)
    return replace(
        noise,
        bottomless_light=light,
        bottomless=mean,
        bottom_threshold=noise.bottom_threshold - raised,
    )


def _threshold(noise: NoiseModel, light: FloatArray) -> FloatArray:
    """Return n_L over a light as the model sets it."""
    bins = noise.detector.scatter(light, noise.detector.mean(light))
    mean = gate_sums(bins.mean, noise.gate_bins) + noise.allowance
    return gate_scatter(bins, mean, noise.gate_bins).threshold(float(norm.sf(noise.deviate)))


def _clearer(water: WaterColumn, depth: FloatArray, path: FloatArray) -> FloatArray:
    """Return by how much the echo would grow in the clearest of the layers above the bottom."""
    if len(water.layers) == 1:
        return np.ones(depth.shape)
    loss = np.array([diffuse_attenuation(layer.water) for layer in water.layers])
    tops = np.array([layer.top for layer in water.layers])
    clearest = np.minimum.accumulate(loss)[np.searchsorted(tops, depth, side="left") - 1]
    excess = water.integral(depth, diffuse_attenuation) - clearest * depth
    return np.asarray(np.exp(2.0 * np.maximum(excess, 0.0) * path / depth))


def _brighter(reflectance: FloatArray) -> FloatArray:
    """Return by how much the echo would grow over a bottom of the usual reflectance."""
    known = np.where(reflectance > 0.0, reflectance, USUAL_REFLECTANCE)
    return np.maximum(USUAL_REFLECTANCE / known, 1.0)

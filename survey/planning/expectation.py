"""How deep the bottom of a scenario may lie, by day and by night."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from survey.expected_light import coarse, expected_light
from survey.planning.depth_limit import DepthLimit, depth_limit
from survey.planning.run_costs import column_error
from survey.preparation import noise_model, steady_light
from survey.scenario import components
from survey.scenario.scenario import Scenario
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Expectation:
    """Depths down to which nine flashes in ten show the bottom.

    Parameters
    ----------
    day, night : DepthLimit
        What the instrument can do.
    run_day, run_night : DepthLimit
        What a run can show: the error of its Monte Carlo raises its thresholds.
    reflectance : float
        Of the bottom: the median of the seabed without its objects [1].
    basis : str
        Where the water's response comes from.
    is_estimate : bool
        Whether the water is none of those that were traced.
    """

    day: DepthLimit
    night: DepthLimit
    run_day: DepthLimit
    run_night: DepthLimit
    reflectance: float
    basis: str
    is_estimate: bool


def expectation(scenario: Scenario, *, seabed: Seabed, height: float) -> Expectation:
    """Return how deep the bottom of a scenario may lie.

    The scenario's own background stands for its own time of day; for the other it is that of its
    sun, or of a night without a moon.

    Parameters
    ----------
    scenario : Scenario
    seabed : Seabed
        For its reflectance.
    height : float
        Of the sensor above the water [m].
    """
    water, few = components.water(scenario), coarse(scenario)
    light = expected_light(scenario, height=height)
    reflectance = float(np.median(seabed.reflectance[~seabed.is_object]))
    column = light.column()
    bottomless = column + light.surface_echo()
    error = column * column_error(
        water,
        scenario.laser.illumination,
        light.bin_depths,
        walks_per_pixel=scenario.transport.walks_per_pixel,
    )

    @cache
    def bottom(depth: float) -> FloatArray:
        return light.bottom(depth=depth, reflectance=reflectance)

    def limit(radiance: float, *, of_run: bool) -> DepthLimit:
        variance = error**2 if of_run else np.zeros_like(error)
        noise = noise_model(few, steady_light(scenario, radiance), bottomless, variance)
        return depth_limit(bottom=bottom, noise=noise, gate_depth=light.gate_depth)

    day, night = _radiances(scenario)
    return Expectation(
        day=limit(day, of_run=False),
        night=limit(night, of_run=False),
        run_day=limit(day, of_run=True),
        run_night=limit(night, of_run=True),
        reflectance=reflectance,
        basis=light.water.basis,
        is_estimate=light.water.is_estimate,
    )


def _radiances(scenario: Scenario) -> tuple[float, float]:
    """Return the background by day and by night [W / (m2 m sr)]."""
    own = components.background_radiance(scenario)
    if scenario.sun.day:
        return own, components.NIGHT_RADIANCE_W_M2_UM_SR / components.MICRO
    return components.sky(scenario).radiance(), own

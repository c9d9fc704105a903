"""The light that a scenario lets expect, by its water's response."""

from __future__ import annotations

from math import ceil, sqrt

from survey.optics.water import WaterColumn
from survey.optics.water_response import water_response
from survey.scenario import components
from survey.scenario.scenario import Scenario
from survey.transport.expected_light import ExpectedLight

MOST_PIXELS = 32


def expected_light(
    scenario: Scenario, *, height: float, water: WaterColumn | None = None
) -> ExpectedLight:
    """Return what a few pixels, spread over the field of view, may expect of a flash.

    Parameters
    ----------
    scenario : Scenario
    height : float
        Of the sensor above the water [m].
    water : WaterColumn, optional
        The scenario's unless told.
    """
    receiver, water = components.receiver(scenario), water or components.water(scenario)
    efficiency = components.detector(scenario).photo_electrons_per_photon
    return ExpectedLight(
        height=height,
        laser=components.laser(scenario),
        receiver=receiver,
        camera=components.camera(coarse(scenario)),
        pixel_solid_angle=components.camera(scenario).pixel_tangent ** 2,
        photo_electrons_per_photon=receiver.optics_transmission * efficiency,
        surface=components.sea_surface(scenario),
        water=water_response(water, scenario.laser.illumination),
        refractive_index=water.refractive_index,
        group_index=water.group_index,
    )


def coarse(scenario: Scenario) -> Scenario:
    """Return the scenario with fewer pixels in nearly the same field of view, for speed."""
    given = scenario.camera
    step = ceil(sqrt(given.rows * given.columns / MOST_PIXELS))
    step = min(step, given.rows, given.columns)
    changes = {
        "camera.rows": given.rows // step,
        "camera.columns": given.columns // step,
        "camera.pixel_footprint_m": given.pixel_footprint_m * step,
    }
    return scenario.replace(**changes)

"""The effects of a scenario that can be left out, each with the changes that leave it out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from survey.scenario import components
from survey.scenario.detector_sections import SpadDetector
from survey.scenario.flight_sections import PlannedFlight
from survey.scenario.motion_sections import Motion, Navigation
from survey.scenario.scenario import Scenario

Changes = dict[str, Any]

CLEAREST = 1e-6  # scattering coefficient of water that does not scatter [1/m]
MOUNTING = ("boresight_", "lever_arm_")
UNKNOWN = "_error_"


def effects(scenario: Scenario) -> dict[str, Changes]:
    """Return the effects at work in a scenario, by name, with what `Scenario.replace` is to change.

    Waves that are left out stay roughness; the mounting that is known stays.

    Examples
    --------
    >>> from survey.scenario.load import load_scenario
    >>> effects(load_scenario("reef-with-swell"))["waves"]
    {'surface.waves': None, 'surface.swell': None}
    """
    return dict([*_of_water(scenario), *_of_light(scenario), *_of_flight(scenario)])


def _of_water(scenario: Scenario) -> Iterator[tuple[str, Changes]]:
    surface, seabed = scenario.surface, scenario.seabed
    if surface.waves or surface.swell:
        yield "waves", {"surface.waves": None, "surface.swell": None}
    if surface.whitecaps:
        yield "whitecaps", {"surface.whitecaps": None}
    if scenario.water.layers:
        yield "layers", {"water.layers": []}
    yield "scattering", {"water": _without_scattering(scenario)}
    if seabed.map is not None:
        yield "map of the bottom", {"seabed.map": None}
    if seabed.objects:
        yield "objects", {"seabed.objects": None}


def _without_scattering(scenario: Scenario) -> Changes:
    """One water at all depths that absorbs like that under the surface."""
    given = scenario.water
    return {
        "type": "stated",
        "absorption_per_m": components.water(scenario).surface.absorption,
        "scattering_per_m": CLEAREST,
        "refractive_index": given.refractive_index,
        "group_index": given.group_index,
    }


def _of_light(scenario: Scenario) -> Iterator[tuple[str, Changes]]:
    detector = scenario.detector
    if scenario.laser.illumination == "flood":
        yield "light of neighbours", {"laser.illumination": "isolated"}
    if components.background_radiance(scenario) > 0.0:
        yield "sun", {"sun": {"radiance_w_m2_um_sr": 0.0}}
    if detector.dark_count_rate_hz > 0.0:
        yield "dark counts", {"detector.dark_count_rate_hz": 0.0}
    if detector.kind != "ideal":
        yield "detector", {"detector": _ideal(scenario)}


def _ideal(scenario: Scenario) -> Changes:
    """Return a detector that counts each photo-electron of the scenario's."""
    given = scenario.detector
    filled = given.fill_factor if isinstance(given, SpadDetector) else 1.0
    return {
        "kind": "ideal",
        "quantum_efficiency": given.quantum_efficiency * filled,
        "dark_count_rate_hz": given.dark_count_rate_hz,
        "pulses_per_frame": given.pulses_per_frame,
        "burst_rate_hz": given.burst_rate_hz,
    }


def _of_flight(scenario: Scenario) -> Iterator[tuple[str, Changes]]:
    flight = scenario.flight
    if scenario.motion != Motion(source=scenario.motion.source):
        yield "motion", {"motion": None}
    if isinstance(flight, PlannedFlight) and flight.wind_speed_m_s > 0.0:
        yield "side wind", {"flight.wind_speed_m_s": None}
    navigation = scenario.navigation.model_dump()
    known = {
        key: value
        for key, value in navigation.items()
        if key.startswith(MOUNTING) and UNKNOWN not in key
    }
    given = navigation | {"source": None, "trajectory_files": []}
    if Navigation(**known) != Navigation(**given):
        yield "navigation errors", {"navigation": known}

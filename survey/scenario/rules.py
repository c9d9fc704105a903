"""Rules that bind several keys together."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from survey.scenario.detector_rules import DETECTOR_RULES
from survey.scenario.faults import Fault
from survey.scenario.flight_rules import FLIGHT_RULES
from survey.scenario.gate_rules import gate_holds_the_water
from survey.scenario.seabed_rules import SEABED_RULES
from survey.scenario.sections import Camera, Mission, Receiver
from survey.scenario.sun import SUN_RULES
from survey.scenario.surface_rules import SURFACE_RULES
from survey.scenario.water_rules import WATER_RULES

LARGEST_FRAME_BINS = 200_000_000


def broken_rules(sound: Mapping[str, Any], folder: Path) -> list[Fault]:
    """Return the faults of every rule whose sections are all sound."""
    parts = {**sound, "folder": folder}
    faults: list[Fault] = []
    for rule in RULES:
        needs = inspect.signature(rule).parameters
        if all(need in parts for need in needs):
            faults += rule(**{need: parts[need] for need in needs})
    return faults


def frame_fits_in_memory(camera: Camera, receiver: Receiver) -> Iterator[Fault]:
    """One frame's waveforms stay in a size that computers hold."""
    size = camera.rows * camera.columns * receiver.bins
    if size > LARGEST_FRAME_BINS:
        yield Fault(
            "receiver.bins",
            f"{camera.rows} x {camera.columns} pixels of {receiver.bins} bins are {size} numbers "
            f"a frame. Stay below {LARGEST_FRAME_BINS}.",
        )


def map_is_projected_in_metres(mission: Mission) -> Iterator[Fault]:
    """The map is projected, with easting and northing in metres."""
    crs = _known_crs(mission.crs_epsg)
    if crs is None:
        yield Fault("mission.crs_epsg", f"there is no EPSG:{mission.crs_epsg}.")
    elif not crs.is_projected or crs.axis_info[0].unit_name != "metre":
        yield Fault(
            "mission.crs_epsg",
            f"EPSG:{mission.crs_epsg} ({crs.name}) is not a projected map in metres. "
            "Take one, such as UTM.",
        )


def heights_are_in_metres(mission: Mission) -> Iterator[Fault]:
    """The vertical datum counts metres upwards."""
    crs = _known_crs(mission.vertical_epsg)
    if crs is None:
        yield Fault("mission.vertical_epsg", f"there is no EPSG:{mission.vertical_epsg}.")
        return
    axis = crs.axis_info[0]
    if not crs.is_vertical or axis.direction != "up" or axis.unit_name != "metre":
        yield Fault(
            "mission.vertical_epsg",
            f"EPSG:{mission.vertical_epsg} ({crs.name}) is not a height in metres, positive up. "
            "Take one, such as 5714 or 5703.",
        )


def _known_crs(epsg: int) -> Any:
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        return CRS.from_epsg(epsg)
    except CRSError:
        return None


RULES: tuple[Callable[..., Iterator[Fault]], ...] = (
    *FLIGHT_RULES,
    gate_holds_the_water,
    frame_fits_in_memory,
    map_is_projected_in_metres,
    heights_are_in_metres,
    *SEABED_RULES,
    *DETECTOR_RULES,
    *SUN_RULES,
    *SURFACE_RULES,
    *WATER_RULES,
)

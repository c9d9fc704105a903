"""Rules that bind several keys together."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from math import hypot
from pathlib import Path
from typing import Any

from scipy.constants import c

from survey.scenario.faults import Fault
from survey.scenario.seabed_sections import ChannelSeabed, SeabedSection
from survey.scenario.sections import Camera, Flight, Laser, Mission, Receiver, Section, Water

GATE_LEAD_NS = 30.0
LARGEST_FRAME_BINS = 200_000_000
LARGEST_FRAME_COUNT = 1_000_000


def gate_start_ns(receiver: Receiver, flight: Flight) -> float:
    """Return when the gate opens after the pulse: as stated, or 30 ns before the nadir surface."""
    if receiver.gate_start_ns is not None:
        return receiver.gate_start_ns
    return max(0.0, two_way_ns(flight.height_m) - GATE_LEAD_NS)


def two_way_ns(distance_m: float) -> float:
    """Return the time that light takes there and back [ns].

    Examples
    --------
    >>> round(two_way_ns(200.0), 2)
    1334.26
    """
    return 2.0e9 * distance_m / c


def broken_rules(sound: Mapping[str, Any], folder: Path) -> list[Fault]:
    """Return the faults of every rule whose sections are all sound."""
    parts = {**sound, "folder": folder}
    faults: list[Fault] = []
    for rule in RULES:
        needs = inspect.signature(rule).parameters
        if all(need in parts for need in needs):
            faults += rule(**{need: parts[need] for need in needs})
    return faults


def group_slower_than_phase(water: Water) -> Iterator[Fault]:
    """Light's group is slower than its phase in water: dispersion is normal there."""
    if water.group_index < water.refractive_index:
        yield Fault(
            "water.group_index",
            f"{water.group_index:g} is below refractive_index {water.refractive_index:g}. "
            "A pulse in water is slower than its phase; raise it.",
        )


def gate_holds_the_water(
    receiver: Receiver, flight: Flight, camera: Camera, laser: Laser
) -> Iterator[Fault]:
    """The gate opens before the first surface echo and closes after the last one."""
    start = gate_start_ns(receiver, flight)
    end = start + receiver.bins * receiver.bin_width_ns
    half = 0.5 * camera.pixel_footprint_m / camera.design_range_m
    slant = hypot(1.0, half * camera.rows, half * camera.columns)
    first = two_way_ns(flight.height_m) - laser.pulse_width_ns
    last = two_way_ns(flight.height_m * slant) + laser.pulse_width_ns
    if start > first:
        yield Fault(
            "receiver.gate_start_ns",
            f"{start:g} is after the water surface's first echo at {first:.0f} ns. Open earlier.",
        )
    if end < last:
        yield Fault(
            "receiver.bins",
            f"the gate closes at {end:.0f} ns, before the corner pixels see the water surface "
            f"at {last:.0f} ns. Take at least {_bins_until(last, start, receiver)} bins.",
        )


def _bins_until(time_ns: float, start_ns: float, receiver: Receiver) -> int:
    return int((time_ns - start_ns) / receiver.bin_width_ns) + 1


def channel_is_deeper(seabed: SeabedSection) -> Iterator[Fault]:
    """A channel lies below the bed beside it."""
    if isinstance(seabed, ChannelSeabed) and seabed.channel_depth_m <= seabed.depth_m:
        yield Fault(
            "seabed.channel_depth_m",
            f"{seabed.channel_depth_m:g} is not deeper than depth_m {seabed.depth_m:g}. "
            "Deepen the channel.",
        )


def frame_fits_in_memory(camera: Camera, receiver: Receiver) -> Iterator[Fault]:
    """One frame's waveforms stay in a size that computers hold."""
    size = camera.rows * camera.columns * receiver.bins
    if size > LARGEST_FRAME_BINS:
        yield Fault(
            "receiver.bins",
            f"{camera.rows} x {camera.columns} pixels of {receiver.bins} bins are {size} numbers "
            f"a frame. Stay below {LARGEST_FRAME_BINS}.",
        )


def mission_is_finite(flight: Flight) -> Iterator[Fault]:
    """A mission has no more frames than file names have digits."""
    count = flight.lines * flight.frames_per_line
    if count > LARGEST_FRAME_COUNT:
        yield Fault(
            "flight.frames_per_line",
            f"{count} frames in all. Stay below {LARGEST_FRAME_COUNT}.",
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


def files_exist(seabed: SeabedSection, folder: Path) -> Iterator[Fault]:
    """Every file that the seabed names is there."""
    named: dict[str, Section] = {"seabed.file": seabed}
    named |= {f"seabed.objects.{number}.file": part for number, part in enumerate(seabed.objects)}
    for place, part in named.items():
        file = getattr(part, "file", None)
        if file is not None and not (folder / file).is_file():
            yield Fault(place, f"no file '{file}' in {folder}.", missing_file=True)


RULES: tuple[Callable[..., Iterator[Fault]], ...] = (
    group_slower_than_phase,
    gate_holds_the_water,
    channel_is_deeper,
    frame_fits_in_memory,
    mission_is_finite,
    map_is_projected_in_metres,
    heights_are_in_metres,
    files_exist,
)

"""The rule that the receiver's gate holds the water's surface, however the aircraft flies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from survey.scenario import flight_sections as kinds
from survey.scenario.faults import Fault
from survey.scenario.flight_parts import legs, sound_track
from survey.scenario.motion_sections import AngleSwing, DistanceSwing, Motion, Navigation
from survey.scenario.sections import Camera, Flight, Laser, Mission, Receiver
from survey.scenario.surface_sections import Surface
from survey.scenario.times import gate_start_ns, two_way_ns

if TYPE_CHECKING:
    from survey.flight.track import Track

FloatArray = NDArray[np.float64]

WIDEST_SWING = 4.0  # of the r.m.s.: one flash in 16,000 goes beyond


def gate_holds_the_water(
    receiver: Receiver,
    flight: Flight,
    camera: Camera,
    laser: Laser,
    motion: Motion,
    navigation: Navigation,
    surface: Surface,
    mission: Mission,
    folder: Path,
) -> Iterator[Fault]:
    """The gate opens before the first surface echo and closes after the last one, at any tide.

    Swings are taken up to four times their r.m.s., all at once.
    """
    if isinstance(flight, kinds.RecordedFlight):
        track = sound_track(flight, epsg=mission.crs_epsg, folder=folder)
        reach = None if track is None else _recorded_reach(flight, track, surface)
    else:
        assert isinstance(flight, kinds.PlannedFlight)
        reach = _planned_reach(flight, motion, navigation, surface)
    if reach is None:
        return
    if reach.low <= 0.0:
        yield Fault("flight", f"the aircraft comes down to {reach.low:.0f} m above the water.")
        return
    slant = reach.slant(camera)
    start = gate_start_ns(receiver, flight)
    end = start + receiver.bins * receiver.bin_width_ns
    first = two_way_ns(reach.low) - laser.pulse_width_ns
    last = two_way_ns(slant) + laser.pulse_width_ns
    if start > first:
        yield Fault(
            "receiver.gate_start_ns",
            f"{start:g} is after the water surface's first echo at {first:.0f} ns"
            f"{reach.words}. Open earlier.",
        )
    if not np.isfinite(slant):
        yield Fault("flight", f"corner pixels look above the horizon{reach.words}. Tilt less.")
    elif end < last:
        bins = int((last - start) / receiver.bin_width_ns) + 1
        yield Fault(
            "receiver.bins",
            f"the gate closes at {end:.0f} ns, before the corner pixels see the water surface "
            f"at {last:.0f} ns{reach.words}. Take at least {bins} bins.",
        )


@dataclass(frozen=True, kw_only=True)
class _Reach:
    """How high an aircraft flies, how far it tilts [rad], and that in words; arrays (n,)."""

    heights: FloatArray
    rolls: FloatArray
    pitches: FloatArray
    words: str

    @property
    def low(self) -> float:
        """Least height above the water [m]."""
        return float(self.heights.min())

    def slant(self, camera: Camera) -> float:
        """Return the greatest range of a corner pixel to the water [m]; inf without water."""
        half = 0.5 * camera.pixel_footprint_m / camera.design_range_m
        sides = (half * camera.columns, half * camera.rows)
        ahead, aside = sides if camera.long_side == "along" else sides[::-1]
        corners = product((-ahead, ahead), (-aside, aside))
        down = [self._down(forward, right) for forward, right in corners]
        least = np.min(down, axis=0)
        if (least <= 0.0).any():
            return float("inf")
        return float(np.max(self.heights * np.sqrt(1.0 + ahead**2 + aside**2) / least))

    def _down(self, forward: float, right: float) -> FloatArray:
        """Return the part downwards of a ray (forward, right, 1) of the tilted sensor."""
        level = np.sin(self.rolls) * right + np.cos(self.rolls)
        return np.asarray(np.cos(self.pitches) * level - np.sin(self.pitches) * forward)


def _planned_reach(
    flight: kinds.PlannedFlight, motion: Motion, navigation: Navigation, surface: Surface
) -> _Reach:
    heave = _widest(motion.height) + surface.tidal_amplitude_m
    low, high = flight.heights_m[0] - heave, flight.heights_m[1] + heave
    roll = abs(motion.roll_mean_deg) + _widest(motion.roll) + _boresight(navigation, "roll")
    pitch = abs(motion.pitch_mean_deg) + _widest(motion.pitch) + _boresight(navigation, "pitch")
    tilts = product((low, high), (-roll, 0.0, roll), (-pitch, 0.0, pitch))
    heights, rolls, pitches = np.array(list(tilts)).T
    moves = roll or pitch or heave
    words = f" (height {high:.0f} m, roll {roll:.1f}, pitch {pitch:.1f} degrees)" if moves else ""
    return _Reach(
        heights=heights, rolls=np.radians(rolls), pitches=np.radians(pitches), words=words
    )


def _widest(swings: list[AngleSwing] | list[DistanceSwing]) -> float:
    sizes = [s.rms_deg if isinstance(s, AngleSwing) else s.rms_m for s in swings]
    return WIDEST_SWING * float(np.sqrt(np.sum(np.square(sizes))))


def _boresight(navigation: Navigation, axis: str) -> float:
    names = (f"boresight_{axis}_deg", f"boresight_error_{axis}_deg")
    return abs(float(sum(getattr(navigation, name) for name in names)))


def _recorded_reach(flight: kinds.RecordedFlight, track: Track, surface: Surface) -> _Reach:
    since = track.time - track.time[0]
    flown = np.zeros(since.shape, np.bool_)
    for begin, end in legs(flight, track):
        flown |= (since >= begin) & (since <= end)
    flown |= ~flown.any()
    roll, pitch = (np.tile(angle[flown], 2) for angle in (track.roll, track.pitch))
    heights = track.position[flown, 2] - surface.water_level_m
    tide = surface.tidal_amplitude_m
    heights = np.concatenate([heights - tide, heights + tide])
    widest = [np.degrees(np.abs(angle).max()) for angle in (roll, pitch)]
    words = (
        f" (heights {heights.min():.0f} to {heights.max():.0f} m, roll up to {widest[0]:.1f}, "
        f"pitch up to {widest[1]:.1f} degrees)"
    )
    return _Reach(heights=heights, rolls=roll, pitches=pitch, words=words)

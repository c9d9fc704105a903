"""The sections [motion] and [navigation] turned into parts of a flight, in SI units and radians.

`survey.flight` is imported when a part is built, so that checking a scenario stays quick.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from typing import TYPE_CHECKING

from survey.scenario import motion_sections as kinds

if TYPE_CHECKING:
    from survey.flight.motion import Motion, Swing
    from survey.flight.navigation import Mounting, Navigation, NavigationError


def build_motion(given: kinds.Motion) -> Motion:
    """Return the aircraft's motion about its line."""
    from survey.flight.motion import Motion

    return Motion(
        roll_mean=radians(given.roll_mean_deg),
        pitch_mean=radians(given.pitch_mean_deg),
        roll=_angle_swings(given.roll),
        pitch=_angle_swings(given.pitch),
        heading=_angle_swings(given.heading),
        cross_track=_distance_swings(given.cross_track),
        height=_distance_swings(given.height),
    )


def _angle_swings(given: Sequence[kinds.AngleSwing]) -> tuple[Swing, ...]:
    from survey.flight.motion import Swing

    return tuple(
        Swing(rms=radians(swing.rms_deg), period=swing.period_s, damping=swing.damping)
        for swing in given
    )


def _distance_swings(given: Sequence[kinds.DistanceSwing]) -> tuple[Swing, ...]:
    from survey.flight.motion import Swing

    return tuple(
        Swing(rms=swing.rms_m, period=swing.period_s, damping=swing.damping) for swing in given
    )


def build_navigation(given: kinds.Navigation) -> Navigation:
    """Return the errors of navigation and the sensor's mounting."""
    from survey.flight.navigation import Navigation

    return Navigation(
        east=_place_error(given, "east", "horizontal"),
        north=_place_error(given, "north", "horizontal"),
        up=_place_error(given, "up", "up"),
        roll=_angle_error(given, "roll", "roll_pitch"),
        pitch=_angle_error(given, "pitch", "roll_pitch"),
        heading=_angle_error(given, "heading", "heading"),
        mounting=_mounting(given, error=1.0),
        believed_mounting=_mounting(given, error=0.0),
    )


def _place_error(given: kinds.Navigation, axis: str, kind: str) -> NavigationError:
    from survey.flight.navigation import NavigationError

    return NavigationError(
        bias=getattr(given, f"gnss_bias_{axis}_m"),
        drift=getattr(given, f"gnss_drift_{kind}_m"),
        drift_time=given.gnss_drift_time_s,
        white=getattr(given, f"gnss_white_{kind}_m"),
    )


def _angle_error(given: kinds.Navigation, axis: str, kind: str) -> NavigationError:
    from survey.flight.navigation import NavigationError

    return NavigationError(
        bias=radians(getattr(given, f"ins_bias_{axis}_deg")),
        drift=radians(getattr(given, f"ins_drift_{kind}_deg")),
        drift_time=given.ins_drift_time_s,
        white=radians(getattr(given, f"ins_white_{kind}_deg")),
    )


def _mounting(given: kinds.Navigation, *, error: float) -> Mounting:
    """Return the mounting as believed plus a share of its error."""
    from survey.flight.navigation import Mounting

    def summed(name: str, axis: str, unit: str) -> float:
        believed: float = getattr(given, f"{name}_{axis}_{unit}")
        wrong: float = getattr(given, f"{name}_error_{axis}_{unit}")
        return believed + error * wrong

    roll, pitch, heading = (
        radians(summed("boresight", axis, "deg")) for axis in ("roll", "pitch", "heading")
    )
    forward, right, down = (summed("lever_arm", axis, "m") for axis in ("forward", "right", "down"))
    return Mounting(roll=roll, pitch=pitch, heading=heading, lever_arm=(forward, right, down))

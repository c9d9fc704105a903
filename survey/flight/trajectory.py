"""From the plan of a flight to the place of every flash, and what the camera sees from there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from survey.flight.area import AreaPlan
from survey.flight.plan import FlightPlan
from survey.flight.pose import Frame, Pose
from survey.flight.recorded import RecordedPlan

FloatArray = NDArray[np.float64]

Plan = FlightPlan | AreaPlan | RecordedPlan
SHOWN = 5


class FieldOfView(Protocol):
    """What a camera shows of its field of view."""

    @property
    def half_tangents(self) -> tuple[float, float]:
        """Half of the field of view forward and to the right, as tangents [1]."""


def fly_lines(plan: Plan) -> list[Frame]:
    """Return the frames of a plan in the order of flight, without navigation errors.

    Straight lines are flown level; a recorded flight moves as it did.

    Examples
    --------
    >>> plan = FlightPlan(start=(0.0, 0.0), heading=0.0, height=200.0, water_level=0.0,
    ...     speed=100.0, flash_rate=1.0, frames_per_line=3, lines=2, swath=50.0, sidelap=0.2,
    ...     turn="alternate", turn_time=60.0)
    >>> [tuple(frame.pose.position.round(6).tolist()) for frame in fly_lines(plan)][2:4]
    [(0.0, 200.0, 200.0), (40.0, 200.0, 200.0)]
    >>> [frame.time for frame in fly_lines(plan)]
    [0.0, 1.0, 2.0, 62.0, 63.0, 64.0]
    """
    if isinstance(plan, RecordedPlan):
        return plan.frames()
    frames: list[Frame] = []
    begin, before = 0.0, None
    for number, line in enumerate(plan.survey_lines):
        if before is not None:
            begin += before.times[-1] + plan.turn_between(before, line)
        places = line.places
        headings = plan.crabbed(line.course, plan.speeds(places))
        frames += [
            Frame(
                index=len(frames) + flash,
                line=number,
                time=float(begin + line.times[flash]),
                pose=Pose(position=position, roll=0.0, pitch=0.0, heading=float(headings[flash])),
            )
            for flash, position in enumerate(np.column_stack([places, plan.altitudes(places)]))
        ]
        before = line
    return frames


def footprint(camera: FieldOfView, pose: Pose, elevation: float) -> FloatArray:
    """Return the outline of the camera's view on a level plane, along straight rays in air.

    Parameters
    ----------
    camera : Camera
        Anything with the half tangents of its field of view.
    pose : Pose
    elevation : float
        Height of the plane in the vertical datum [m].

    Returns
    -------
    array (4, 2)
        Easting and northing [m, local frame] of the corners of the view, in the order forward
        left, forward right, aft right, aft left.

    Raises
    ------
    ValueError
        When a corner looks level or upwards, or the plane lies above the sensor.

    Examples
    --------
    >>> from survey.sensor.camera import Camera
    >>> camera = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
    >>> above = Pose(position=np.array([0.0, 0.0, 250.0]), roll=0.0, pitch=0.0, heading=0.0)
    >>> footprint(camera, above, 0.0).round(9).tolist()
    [[-32.0, 64.0], [32.0, 64.0], [32.0, -64.0], [-32.0, -64.0]]
    """
    forward, right = camera.half_tangents
    corners = np.array(
        [
            [forward, -right, 1.0],
            [forward, right, 1.0],
            [-forward, right, 1.0],
            [-forward, -right, 1.0],
        ]
    )
    rays = corners @ pose.body_to_map().T
    drop = elevation - pose.position[2]
    if drop >= 0.0 or np.any(rays[:, 2] >= 0.0):
        raise ValueError(
            f"the plane at {elevation:g} m is not below all corners of the view: "
            "lower it or tilt the sensor less"
        )
    outline: FloatArray = pose.position[:2] + rays[:, :2] * (drop / rays[:, 2])[:, None]
    return outline


def footprints(camera: FieldOfView, frames: Sequence[Frame], elevation: float) -> list[FloatArray]:
    """Return the outline (4, 2) of every frame's view on a level plane, see `footprint`.

    Raises
    ------
    ValueError
        Naming the first frames that see no such plane, a line each.
    """
    outlines, faults = [], []
    for frame in frames:
        try:
            outlines.append(footprint(camera, frame.pose, elevation))
        except ValueError:
            faults.append(_lost(frame, elevation))
    if len(faults) > SHOWN:
        faults[SHOWN:] = [f"flight: and {len(faults) - SHOWN} other frames"]
    if faults:
        raise ValueError("\n".join(faults))
    return outlines


def require_air(frames: Sequence[Frame], *, highest: float) -> None:
    """Refuse a flight that comes down to the ground's highest place [m].

    Raises
    ------
    ValueError
        Naming the lowest frame.
    """
    lowest = min(frames, key=lambda frame: float(frame.pose.position[2]))
    height = float(lowest.pose.position[2])
    if height <= highest:
        raise ValueError(
            f"flight: frame {lowest.index} is at {height:.1f} m, and the ground rises to "
            f"{highest:.1f} m. Fly higher"
        )


def _lost(frame: Frame, elevation: float) -> str:
    pose = frame.pose
    return (
        f"flight: frame {frame.index}, {frame.time:.1f} s: {pose.position[2] - elevation:.0f} m "
        f"above the water, roll {np.degrees(pose.roll):.1f}, pitch {np.degrees(pose.pitch):.1f} "
        "degrees: a corner of the view sees no water. Leave it out, or tilt the sensor less"
    )

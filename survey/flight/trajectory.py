"""From the plan of a flight to the place of every flash, and what the camera sees from there."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from survey.flight.plan import FlightPlan
from survey.flight.pose import Frame, Pose

FloatArray = NDArray[np.float64]


class FieldOfView(Protocol):
    """What a camera shows of its field of view."""

    @property
    def half_tangents(self) -> tuple[float, float]:
        """Half of the field of view forward and to the right, as tangents [1]."""


def fly_lines(plan: FlightPlan) -> list[Frame]:
    """Return the frames of a plan in the order of flight, level and without navigation errors.

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
    return [_frame(plan, index) for index in range(plan.frame_count)]


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


def _frame(plan: FlightPlan, index: int) -> Frame:
    line, flash = divmod(index, plan.frames_per_line)
    backwards = plan.turn == "alternate" and line % 2 == 1
    step = plan.frames_per_line - 1 - flash if backwards else flash
    ahead = np.array([np.sin(plan.heading), np.cos(plan.heading)])
    right = np.array([np.cos(plan.heading), -np.sin(plan.heading)])
    place = plan.start + step * plan.flash_spacing * ahead + line * plan.line_spacing * right
    return Frame(
        index=index,
        line=line,
        time=line * (plan.line_duration + plan.turn_time) + flash / plan.flash_rate,
        pose=Pose(
            position=np.array([place[0], place[1], plan.altitude]),
            roll=0.0,
            pitch=0.0,
            heading=(plan.heading + np.pi) % (2.0 * np.pi) if backwards else plan.heading,
        ),
    )

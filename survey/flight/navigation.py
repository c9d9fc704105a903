"""What navigation says of the sensor's pose: errors of GNSS and INS, boresight and lever arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from survey.flight.pose import FULL_TURN, Frame, Pose, turned

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class NavigationError:
    """The error of one measured quantity: a constant, a slow drift, and white noise.

    The drift is a first-order Gauss-Markov process: its correlation falls as exp(-|t| / time).

    Parameters
    ----------
    bias : float
        Constant part, measured less true [rad or m].
    drift : float
        Root mean square of the slow part [rad or m].
    drift_time : float
        Its correlation time [s].
    white : float
        Root mean square of the part that is new at every flash [rad or m].
    """

    bias: float = 0.0
    drift: float = 0.0
    drift_time: float = 600.0
    white: float = 0.0

    @property
    def deviation(self) -> float:
        """Standard deviation of what varies [rad or m]."""
        return float(np.hypot(self.drift, self.white))

    def drawn(self, times: FloatArray, chance: np.random.Generator) -> FloatArray:
        """Return one realisation at ascending times (n,) [s]."""
        normal = chance.standard_normal((2, len(times)))
        kept = np.exp(-np.diff(times) / self.drift_time)
        slow = normal[0].copy()
        for i, share in enumerate(kept, start=1):
            slow[i] = share * slow[i - 1] + np.sqrt(1.0 - share**2) * normal[0, i]
        return np.asarray(self.bias + self.drift * slow + self.white * normal[1])


@dataclass(frozen=True, kw_only=True)
class Mounting:
    """How the sensor sits in the aircraft.

    Parameters
    ----------
    roll, pitch, heading : float
        Boresight [rad]: the turn of the sensor against the body, in the senses of `Pose`.
    lever_arm : tuple of float
        From the place that navigation tells to the sensor: forward, right, down [m].
    """

    roll: float = 0.0
    pitch: float = 0.0
    heading: float = 0.0
    lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def sensor_pose(self, body: Pose) -> Pose:
        """Return the pose of the sensor in a body at a pose.

        Examples
        --------
        >>> north = Pose(position=np.array([0.0, 0.0, 100.0]), roll=0.0, pitch=0.0, heading=0.0)
        >>> sensor = Mounting(roll=0.1, lever_arm=(2.0, 1.0, 0.5)).sensor_pose(north)
        >>> sensor.position.tolist(), round(sensor.roll, 9)
        ([1.0, 2.0, 99.5], 0.1)
        """
        if self == Mounting():
            return body
        to_map = body.body_to_map()
        boresight = turned(roll=self.roll, pitch=self.pitch, yaw=self.heading)
        return Pose.from_body_to_map(
            position=body.position + to_map @ np.array(self.lever_arm), matrix=to_map @ boresight
        )


QUANTITIES = ("east", "north", "up", "roll", "pitch", "heading")
"""What navigation measures, each with random numbers of its own."""

PERFECT = NavigationError()


@dataclass(frozen=True, kw_only=True)
class Navigation:
    """Errors of what navigation measures, and the mounting as it is and as it is believed to be.

    Parameters
    ----------
    east, north, up : NavigationError
        Of the place [m].
    roll, pitch, heading : NavigationError
        Of the attitude [rad].
    mounting, believed_mounting : Mounting
        True, and what georeferencing takes.
    """

    east: NavigationError = PERFECT
    north: NavigationError = PERFECT
    up: NavigationError = PERFECT
    roll: NavigationError = PERFECT
    pitch: NavigationError = PERFECT
    heading: NavigationError = PERFECT
    mounting: Mounting = Mounting()
    believed_mounting: Mounting = Mounting()

    @property
    def deviations(self) -> tuple[float, ...]:
        """Standard deviations of east, north, up [m], roll, pitch, heading [rad]."""
        return tuple(getattr(self, name).deviation for name in QUANTITIES)


@dataclass(frozen=True, kw_only=True)
class PoseUncertainty:
    """Standard deviations of the sensor's measured pose.

    Constant errors count with their size: their sign is not known to the survey.

    Parameters
    ----------
    position : tuple of float
        East, north, up [m].
    lever_arm : tuple of float
        Forward, right, down [m].
    roll, pitch, heading : float
        Of navigation and boresight together [rad].
    """

    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    roll: float = 0.0
    pitch: float = 0.0
    heading: float = 0.0

    @classmethod
    def of(cls, navigation: Navigation) -> PoseUncertainty:
        """Return that of a navigation with its mounting.

        Examples
        --------
        >>> gnss = NavigationError(bias=0.03, white=0.04)
        >>> PoseUncertainty.of(Navigation(up=gnss, roll=gnss)).position
        (0.0, 0.0, 0.05)
        """
        true, believed = navigation.mounting, navigation.believed_mounting
        east, north, up, roll, pitch, heading = (
            float(np.hypot(error.bias, error.deviation))
            for error in (getattr(navigation, name) for name in QUANTITIES)
        )
        forward, right, down = np.subtract(true.lever_arm, believed.lever_arm).tolist()
        return cls(
            position=(east, north, up),
            lever_arm=(forward, right, down),
            roll=float(np.hypot(roll, true.roll - believed.roll)),
            pitch=float(np.hypot(pitch, true.pitch - believed.pitch)),
            heading=float(np.hypot(heading, true.heading - believed.heading)),
        )

    @property
    def position_errors(self) -> FloatArray:
        """Vectors (3, 3) on the map, one for each standard deviation [m]."""
        return np.diag(self.position)

    def lever_errors(self, pose: Pose) -> FloatArray:
        """Return the same of the lever arm of a sensor at a pose [m]."""
        return np.asarray(np.diag(self.lever_arm) @ pose.body_to_map().T)

    @property
    def attitude_errors(self) -> dict[str, float]:
        """Standard deviations by the names of `Pose` [rad]."""
        return {"roll": self.roll, "pitch": self.pitch, "heading": self.heading}


def navigated(
    frames: Sequence[Frame], navigation: Navigation, chances: Sequence[np.random.Generator]
) -> list[Frame]:
    """Return the frames with the sensor's true pose and the one that navigation says.

    Parameters
    ----------
    frames : sequence of Frame
        With the true poses of the aircraft, in the order of flight.
    navigation : Navigation
    chances : sequence of numpy generators
        One for each of `QUANTITIES`, so that changing one error leaves the others as they were.
    """
    if navigation == Navigation():
        return list(frames)
    times = np.array([frame.time for frame in frames])
    errors = np.column_stack(
        [
            getattr(navigation, name).drawn(times, chance)
            for name, chance in zip(QUANTITIES, chances, strict=True)
        ]
    )
    return [
        replace(
            frame,
            pose=navigation.mounting.sensor_pose(frame.pose),
            navigation=navigation.believed_mounting.sensor_pose(_mistaken(frame.pose, error)),
        )
        for frame, error in zip(frames, errors, strict=True)
    ]


def _mistaken(pose: Pose, error: FloatArray) -> Pose:
    """Return a pose with errors of (east, north, up, roll, pitch, heading) added."""
    return Pose(
        position=pose.position + error[:3],
        roll=float(pose.roll + error[3]),
        pitch=float(pose.pitch + error[4]),
        heading=float((pose.heading + error[5]) % FULL_TURN),
    )

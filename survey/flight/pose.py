"""Where the sensor is and which way it is turned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

NORTH_EAST_DOWN_TO_MAP = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
FULL_TURN = 2.0 * np.pi


@dataclass(frozen=True, kw_only=True)
class Pose:
    """Position and attitude of the sensor.

    Parameters
    ----------
    position : array (3,)
        Easting, northing, up in the scene's local frame [m].
    roll, pitch, heading : float
        Attitude [rad]: positive roll lowers the right wing, positive pitch lifts the nose,
        heading counts clockwise from grid north (90 degrees flies east).
    """

    position: FloatArray
    roll: float
    pitch: float
    heading: float

    def body_to_map(self) -> FloatArray:
        """Return the matrix (3, 3) that turns (forward, right, down) into (east, north, up).

        Examples
        --------
        >>> level = Pose(position=np.zeros(3), roll=0.0, pitch=0.0, heading=np.pi / 2)
        >>> (level.body_to_map() @ [1.0, 0.0, 0.0]).round(12) + 0.0
        array([1., 0., 0.])
        """
        return np.asarray(
            NORTH_EAST_DOWN_TO_MAP @ turned(roll=self.roll, pitch=self.pitch, yaw=self.heading)
        )

    @classmethod
    def from_body_to_map(cls, *, position: FloatArray, matrix: FloatArray) -> Pose:
        """Return the pose of a matrix that `body_to_map` gives; the heading is in [0, 2 pi).

        Examples
        --------
        >>> pose = Pose(position=np.zeros(3), roll=0.1, pitch=-0.2, heading=3.0)
        >>> again = Pose.from_body_to_map(position=np.zeros(3), matrix=pose.body_to_map())
        >>> round(again.roll, 12), round(again.pitch, 12), round(again.heading, 12)
        (0.1, -0.2, 3.0)
        """
        to_down = NORTH_EAST_DOWN_TO_MAP @ matrix
        return cls(
            position=position,
            roll=float(np.arctan2(to_down[2, 1], to_down[2, 2])),
            pitch=float(-np.arcsin(np.clip(to_down[2, 0], -1.0, 1.0))),
            heading=float(np.arctan2(to_down[1, 0], to_down[0, 0]) % FULL_TURN),
        )


def turned(*, roll: float, pitch: float, yaw: float) -> FloatArray:
    """Return the matrix (3, 3) from axes forward, right, down to those before the turns.

    First about forward by roll, then about right by pitch, last about down by yaw [rad]
    (aerospace sequence 3-2-1 from outside): from a body to (north, east, down).
    """
    cr, sr = np.cos(roll), np.sin(roll)
    cp, sp = np.cos(pitch), np.sin(pitch)
    ch, sh = np.cos(yaw), np.sin(yaw)
    return np.array(
        [
            [ch * cp, ch * sp * sr - sh * cr, ch * sp * cr + sh * sr],
            [sh * cp, sh * sp * sr + ch * cr, sh * sp * cr - ch * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


@dataclass(frozen=True, kw_only=True)
class Frame:
    """One flash: which, when, from where.

    Parameters
    ----------
    index : int
        Number of the flash in the mission, from 0.
    line : int
        Number of the survey line, from 0.
    time : float
        Seconds since the start of the mission [s].
    pose : Pose
        True pose at the flash: what the light sees.
    navigation : Pose, optional
        The pose as navigation measured it; without one navigation is perfect.
    """

    index: int
    line: int
    time: float
    pose: Pose
    navigation: Pose | None = None

    @property
    def measured(self) -> Pose:
        """The pose that georeferencing knows."""
        return self.pose if self.navigation is None else self.navigation


def measured_positions(frames: Sequence[Frame]) -> FloatArray:
    """Return where flashes were measured to be, by their number (numbers, 3) [m].

    nan for numbers that no frame has.

    Examples
    --------
    >>> pose = Pose(position=np.array([1.0, 2.0, 200.0]), roll=0.0, pitch=0.0, heading=0.0)
    >>> measured_positions([Frame(index=1, line=0, time=0.0, pose=pose)]).tolist()
    [[nan, nan, nan], [1.0, 2.0, 200.0]]
    """
    number = [frame.index for frame in frames]
    position = np.full((max(number, default=-1) + 1, 3), np.nan)
    position[number] = np.reshape([frame.measured.position for frame in frames], (-1, 3))
    return position

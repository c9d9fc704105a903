"""Where the sensor is and which way it is turned."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


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
        cr, sr = np.cos(self.roll), np.sin(self.roll)
        cp, sp = np.cos(self.pitch), np.sin(self.pitch)
        ch, sh = np.cos(self.heading), np.sin(self.heading)
        to_north_east_down = np.array(
            [
                [ch * cp, ch * sp * sr - sh * cr, ch * sp * cr + sh * sr],
                [sh * cp, sh * sp * sr + ch * cr, sh * sp * cr - ch * sr],
                [-sp, cp * sr, cp * cr],
            ]
        )
        north_east_down_to_map = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
        return np.asarray(north_east_down_to_map @ to_north_east_down)


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
        True pose at the flash.
    """

    index: int
    line: int
    time: float
    pose: Pose

"""A recorded flight: where the aircraft was and how it was turned, at many times."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.flight.geodesy import from_map, grid_north, to_map
from survey.flight.pose import FULL_TURN, Pose

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Track:
    """Poses at ascending times, on the map.

    Parameters
    ----------
    time : array (n,)
        Ascending [s], from whatever the recorder counts.
    position : array (n, 3)
        Easting, northing, height on the map [m].
    roll, pitch, heading : array (n,)
        Senses of `Pose`, the heading from grid north [rad].
    """

    time: FloatArray
    position: FloatArray
    roll: FloatArray
    pitch: FloatArray
    heading: FloatArray

    @classmethod
    def from_geographic(
        cls,
        *,
        time: FloatArray,
        longitude: FloatArray,
        latitude: FloatArray,
        height: FloatArray,
        roll: FloatArray,
        pitch: FloatArray,
        true_heading: FloatArray,
        epsg: int,
    ) -> Track:
        """Return the track of longitudes and latitudes [rad] and headings from true north."""
        turn = grid_north(longitude=longitude, latitude=latitude, epsg=epsg)
        flat = to_map(longitude=longitude, latitude=latitude, epsg=epsg)
        return cls(
            time=time,
            position=np.column_stack([flat, height]),
            roll=roll,
            pitch=pitch,
            heading=(true_heading - turn) % FULL_TURN,
        )

    def geographic(self, *, epsg: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return longitude, latitude and heading from true north, each (n,) [rad]."""
        longitude, latitude = from_map(self.position[:, :2], epsg=epsg)
        turn = grid_north(longitude=longitude, latitude=latitude, epsg=epsg)
        return longitude, latitude, (self.heading + turn) % FULL_TURN

    def moved(self, offset: FloatArray) -> Track:
        """Return the track elsewhere: ``offset`` (3,) [m] is added to every position."""
        return Track(
            time=self.time,
            position=self.position + offset,
            roll=self.roll,
            pitch=self.pitch,
            heading=self.heading,
        )

    def poses(self, times: FloatArray) -> list[Pose]:
        """Return the poses at times [s], on the straight line between recorded ones.

        Angles take the short way.

        Examples
        --------
        >>> track = Track(time=np.array([0.0, 2.0]), position=np.array([[0., 0, 9], [8, 0, 9]]),
        ...               roll=np.zeros(2), pitch=np.zeros(2), heading=np.radians([350.0, 20.0]))
        >>> pose, = track.poses(np.array([1.0]))
        >>> pose.position.tolist(), round(float(np.degrees(pose.heading)), 9)
        ([4.0, 0.0, 9.0], 5.0)
        """
        position = np.column_stack(
            [np.interp(times, self.time, column) for column in self.position.T]
        )
        roll, pitch, heading = (
            np.interp(times, self.time, np.unwrap(angle))
            for angle in (self.roll, self.pitch, self.heading)
        )
        return [
            Pose(
                position=position[i],
                roll=float((roll[i] + np.pi) % FULL_TURN - np.pi),
                pitch=float(pitch[i]),
                heading=float(heading[i] % FULL_TURN),
            )
            for i in range(len(times))
        ]

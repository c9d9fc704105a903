"""A flight along a recorded track."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from survey.flight.pose import Frame
from survey.flight.track import Track

ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class RecordedPlan:
    """Flashes at even times along parts of a recorded track, moving as the aircraft did.

    Parameters
    ----------
    track : Track
        In the scene's local frame.
    legs : tuple of (float, float)
        Beginnings and ends of the parts that are flown, since the track's first time [s]; each is
        a line.
    flash_rate : float
        Flashes a second [Hz].
    height : float
        Height above the water that the receiver's gate is made for [m].
    water_level : float
        Mean water level in the vertical datum [m].

    Examples
    --------
    >>> track = Track(time=np.array([7.0, 17.0]), position=np.array([[0., 0, 200], [900, 0, 200]]),
    ...               roll=np.zeros(2), pitch=np.zeros(2), heading=np.full(2, 0.5 * np.pi))
    >>> plan = RecordedPlan(track=track, legs=((0.0, 2.0), (9.0, 10.0)), flash_rate=1.0,
    ...                     height=200.0, water_level=0.0)
    >>> [(f.line, f.time, float(f.pose.position[0])) for f in plan.frames()][2:]
    [(0, 2.0, 180.0), (1, 9.0, 810.0), (1, 10.0, 900.0)]
    """

    track: Track
    legs: tuple[tuple[float, float], ...]
    flash_rate: float
    height: float
    water_level: float

    @property
    def line_count(self) -> int:
        """Legs that are flown."""
        return len(self.legs)

    @property
    def frame_count(self) -> int:
        """Flashes of the whole mission."""
        return sum(self._flashes(begin, end) for begin, end in self.legs)

    def frames(self) -> list[Frame]:
        """Return the flashes; times count from the track's first."""
        frames: list[Frame] = []
        for line, (begin, end) in enumerate(self.legs):
            times = begin + np.arange(self._flashes(begin, end)) / self.flash_rate
            poses = self.track.poses(self.track.time[0] + times)
            frames += [
                Frame(index=len(frames) + flash, line=line, time=float(times[flash]), pose=pose)
                for flash, pose in enumerate(poses)
            ]
        return frames

    def _flashes(self, begin: float, end: float) -> int:
        return int((end - begin) * self.flash_rate + ROUNDING) + 1

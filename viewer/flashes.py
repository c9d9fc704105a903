"""The flashes of a run that gave points: where they were and what they lit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from viewer.run_folder import FlownSurvey
from viewer.scene import outermost

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Flashes:
    """Flashes in the order of their numbers.

    Parameters
    ----------
    frame, line : array (n,)
        Numbers of the flash and of its survey line.
    position : array (n, 3)
        True place of the sensor [m, local].
    heading : array (n,)
        True heading [rad].
    corners : array (n, 4, 3)
        Of the footprint, in ring order [m, local].
    """

    frame: NDArray[np.intp]
    line: NDArray[np.intp]
    position: FloatArray
    heading: FloatArray
    corners: FloatArray

    def __len__(self) -> int:
        return len(self.frame)


def flashes_of(flown: FlownSurvey) -> Flashes:
    """Return the flashes that have a point of the bottom, or a pixel that found none."""
    corners = _corners(flown.bottom)
    listed = [place for place in np.argsort(flown.frame) if int(flown.frame[place]) in corners]
    return Flashes(
        frame=flown.frame[listed],
        line=flown.line[listed],
        position=flown.positions[listed],
        heading=flown.headings[listed],
        corners=np.array([corners[int(flown.frame[place])] for place in listed]).reshape(-1, 4, 3),
    )


def _corners(bottom: PointCloud) -> dict[int, FloatArray]:
    order = np.argsort(bottom.frame, kind="stable")
    frames, starts = np.unique(bottom.frame[order], return_index=True)
    members = np.split(order, starts[1:])
    return {
        int(frame): bottom.position[member[outermost(bottom.row[member], bottom.column[member])]]
        for frame, member in zip(frames, members, strict=True)
    }

"""What strip adjustment should find: the true errors of mounting and lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from survey.cloud.strip_adjustment import Adjustment
from survey.flight.navigation import Mounting, Navigation
from survey.flight.pose import NORTH_EAST_DOWN_TO_MAP, Frame, Pose, turned

FloatArray = NDArray[np.float64]


def true_mounting(navigation: Navigation) -> Mounting:
    """Return the turn and the lever arm that the believed mounting lacks.

    Examples
    --------
    >>> wrong = Navigation(mounting=Mounting(roll=0.3), believed_mounting=Mounting(roll=0.1))
    >>> round(true_mounting(wrong).roll, 9)
    0.2
    """
    true, believed = navigation.mounting, navigation.believed_mounting
    as_matrix = [turned(roll=m.roll, pitch=m.pitch, yaw=m.heading) for m in (true, believed)]
    turn = Pose.from_body_to_map(
        position=np.zeros(3), matrix=NORTH_EAST_DOWN_TO_MAP @ as_matrix[1].T @ as_matrix[0]
    )
    lever = as_matrix[1].T @ (np.array(true.lever_arm) - np.array(believed.lever_arm))
    forward, right, down = lever.tolist()
    return Mounting(
        roll=turn.roll,
        pitch=turn.pitch,
        heading=float((turn.heading + np.pi) % (2.0 * np.pi) - np.pi),
        lever_arm=(forward, right, down),
    )


def true_offsets(found: Adjustment, frames: Sequence[Frame]) -> FloatArray:
    """Return the mean true less measured place of each line's frames (lines, 3) [m].

    For offsets alone, less their mean, which differences of strips do not tell.
    """
    offsets = np.array(
        [
            np.mean(
                [f.pose.position - f.measured.position for f in frames if f.line == line], axis=0
            )
            for line in found.unknowns.lines
        ]
    )
    return offsets - offsets.mean(axis=0) if found.unknowns.mode == "offsets" else offsets

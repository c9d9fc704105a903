"""What strip adjustment solves for: unknowns in metres on the ground, and what is expected of them.

Angles are told as what they move at the edge of the view, so that all unknowns have one unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from survey.cloud.strips import Strip
from survey.flight.navigation import Mounting

FloatArray = NDArray[np.float64]
Mode = Literal["boresight", "offsets"]

ANGLES = ("roll", "pitch", "heading")
LEVER_ARM = ("forward", "right", "down")
RANGING = ("tilt_forward", "tilt_right", "bowl")
"""Biases of ranging over the field of view: they lift its front, its right side, all its edge."""
AXES = ("east", "north", "up")

EXPECTED_BORESIGHT = np.radians(1.0)  # assumed: a mounting before its calibration
EXPECTED_LEVER_ARM = 0.05  # [m] assumed: a mounting that was measured on the ground
EXPECTED_RANGING = 0.1  # [m] assumed, at the edge of the view
EXPECTED_OFFSET = 1.0  # [m] assumed: lines whose navigation nobody vouches for
LEAST_OFFSET = 0.02  # [m]
STEP = 0.01  # [m]


@dataclass(frozen=True, kw_only=True)
class Unknowns:
    """The unknowns of an adjustment, in the order of their vector (size,) [m].

    Parameters
    ----------
    mode : {"boresight", "offsets"}
        One mounting for the survey and an offset for each line, or offsets alone.
    lines : sequence of int
        Numbers of the lines.
    arms : array (3,)
        What a radian of roll, pitch and heading moves [m].
    tangents : array (2,)
        Largest tangents of the view, forward and to the right [1].
    expected : array (size,)
        Standard deviations before the adjustment [m].
    """

    mode: Mode
    lines: tuple[int, ...]
    arms: FloatArray
    tangents: FloatArray
    expected: FloatArray

    @classmethod
    def of(
        cls, strips: Sequence[Strip], *, mode: Mode, line_deviations: FloatArray | None
    ) -> Unknowns:
        """Return the unknowns of strips; deviations (3,) [m] are those of a line's place."""
        rays = np.concatenate([strip.sights.ray for strip in strips])
        height = float(np.mean(np.concatenate([strip.sights.length for strip in strips])))
        tangents = np.abs(rays[:, :2] / rays[:, 2:]).max(axis=0)
        arms = height * np.array([1.0, 1.0, np.hypot(*tangents)])
        offset = np.full(3, EXPECTED_OFFSET)
        if mode == "boresight" and line_deviations is not None:
            offset = np.maximum(line_deviations, LEAST_OFFSET)
        common = [*(EXPECTED_BORESIGHT * arms), *[EXPECTED_LEVER_ARM] * 3, *[EXPECTED_RANGING] * 3]
        return cls(
            mode=mode,
            lines=tuple(strip.line for strip in strips),
            arms=arms,
            tangents=tangents,
            expected=np.array(
                [*(common if mode == "boresight" else []), *np.tile(offset, len(strips))]
            ),
        )

    @property
    def common(self) -> tuple[str, ...]:
        """Names of the unknowns that all lines share."""
        return (*ANGLES, *LEVER_ARM, *RANGING) if self.mode == "boresight" else ()

    @property
    def is_ranging(self) -> NDArray[np.bool_]:
        """Which unknowns only stand beside, and correct nothing (size,)."""
        names = [*self.common, *AXES * len(self.lines)]
        return np.isin(names, RANGING)

    def offsets(self, values: FloatArray) -> FloatArray:
        """Return the part of a vector that belongs to lines (lines, 3)."""
        return values[len(self.common) :].reshape(-1, 3)

    def mounting(self, values: FloatArray) -> Mounting:
        """Return how the sensor sits."""
        if self.mode == "offsets":
            return Mounting()
        roll, pitch, heading = (values[:3] / self.arms).tolist()
        forward, right, down = values[3:6].tolist()
        return Mounting(roll=roll, pitch=pitch, heading=heading, lever_arm=(forward, right, down))

    def places(self, strip: Strip, values: FloatArray) -> FloatArray:
        """Return the points of a strip (n, 3) as unknowns of these values place them [m]."""
        places = strip.placed(self.mounting(values))
        places += self.offsets(values)[self.lines.index(strip.line)]
        if self.mode == "boresight":
            places[:, 2] += self._ranging(strip) @ values[6:9]
        return places

    def derivatives(self, strip: Strip, values: FloatArray) -> FloatArray:
        """Return how the common unknowns move the points of a strip (n, 3, common) [1]."""
        if self.mode == "offsets":
            return np.zeros((len(strip), 3, 0))
        found = np.zeros((len(strip), 3, len(self.common)))
        for i in range(len(ANGLES)):
            step = np.zeros(len(values))
            step[i] = STEP
            ahead, behind = (strip.placed(self.mounting(values + s)) for s in (step, -step))
            found[:, :, i] = (ahead - behind) / (2.0 * STEP)
        found[:, :, 3:6] = strip.sights.to_map
        found[:, 2, 6:] = self._ranging(strip)
        return found

    def _ranging(self, strip: Strip) -> FloatArray:
        share = strip.sights.ray[:, :2] / strip.sights.ray[:, 2:] / self.tangents
        return np.column_stack([share, np.sum(share**2, axis=1) / 2.0])

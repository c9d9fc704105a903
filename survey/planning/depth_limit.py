"""Down to which depth a flight may expect to see the bottom."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from survey.cloud.noise import NoiseModel
from survey.cloud.ranging import bottom_detection_probability

FloatArray = NDArray[np.float64]

DETECTABLE = 0.9
SHALLOWEST = 0.25
STEPS_PER_DOUBLING = 4
HALVINGS = 5


@dataclass(frozen=True, kw_only=True)
class DepthLimit:
    """How deep the bottom may lie.

    Parameters
    ----------
    depth : float
        Deepest depth at which the median pixel finds the bottom in 90 % of flashes [m]; 0 where
        it never does.
    gate_depth : float
        Deepest bottom whose echo all pixels have in the gate [m].
    """

    depth: float
    gate_depth: float

    @property
    def is_set_by_the_gate(self) -> bool:
        """Whether a longer gate would show more."""
        return self.depth > 0.95 * self.gate_depth


def depth_limit(
    *, bottom: Callable[[float], FloatArray], noise: NoiseModel, gate_depth: float
) -> DepthLimit:
    """Return the depth down to which the median pixel's echo fires in 90 % of flashes.

    The probability is that by which a run judges itself,
    `survey.cloud.ranging.bottom_detection_probability`.

    Parameters
    ----------
    bottom : callable
        Returns the light of a bottom (rows, columns, bins) at a depth [m].
    noise : NoiseModel
        Of the same camera's light without a bottom.
    gate_depth : float
        Deepest bottom whose echo lies in the gate [m].
    """

    def is_seen(depth: float) -> bool:
        probability = bottom_detection_probability(bottom=bottom(depth), noise=noise)
        return bool(np.median(probability) >= DETECTABLE)

    return DepthLimit(depth=_deepest(is_seen, gate_depth), gate_depth=gate_depth)


def _deepest(is_seen: Callable[[float], bool], deepest: float) -> float:
    """Return the deepest depth that is seen, from below, to half a per cent."""
    if deepest <= SHALLOWEST:
        return 0.0
    steps = ceil(STEPS_PER_DOUBLING * np.log2(deepest / SHALLOWEST))
    unseen = deepest
    for depth in np.geomspace(deepest, SHALLOWEST, steps + 1):
        if is_seen(depth):
            break
        unseen = float(depth)
    else:
        return 0.0
    seen = float(depth)
    for _ in range(HALVINGS if unseen > seen else 0):
        middle = 0.5 * (seen + unseen)
        seen, unseen = (middle, unseen) if is_seen(middle) else (seen, middle)
    return seen

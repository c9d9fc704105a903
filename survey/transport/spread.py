"""Numbers that are spread evenly over the walks of a pixel: where it looks, which tracks it takes.

What a light path adds to an echo's peak is nearly the same wherever both of its tracks are early,
and next to nothing where one is late. Numbers spread over all pairs alike meet the edge between
them by chance; so a certain number of walks take early pairs and the others the rest, each weighed
by what it stands for.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from survey.transport.launch import fraction
from terrain.kernels import inlined_fused_kernel

# Roberts (2018): additive recurrences of low discrepancy in one and two dimensions.
GOLDEN = 0.6180339887498949
PLASTIC_1, PLASTIC_2 = 0.7548776662466927, 0.5698402909980532
# Azimuths: of those tried, what fills squares with the others most evenly.
TURNING = 0.8211030883946387


class Shifts(NamedTuple):
    """Where the numbers of a pixel begin, 0 to 1 each, in the order of `Evenly`."""

    in_rows: float
    in_columns: float
    back: float
    down: float
    turn: float


class Evenly(NamedTuple):
    """Numbers of one walk from 0 to 1, each spread evenly over the walks of a pixel.

    Where in the pixel a walk looks, the places of its two tracks in their sets, and the azimuth by
    which that of the light is turned where it has to be aimed; ``weight`` is how many walks it
    stands for.
    """

    in_rows: float
    in_columns: float
    back: float
    down: float
    turn: float
    weight: float


class Shares(NamedTuple):
    """How the walks of a pixel are shared out among pairs of tracks.

    ``early`` walks take pairs of two early tracks, at places below ``early_back`` and
    ``early_down``, the ``others`` the rest; each stands for as many walks as its weight tells. Of
    the rest a share ``late_back`` has a late way back.
    """

    early_back: float
    early_down: float
    early: int
    others: int
    early_weight: float
    other_weight: float
    late_back: float


@inlined_fused_kernel
def shared_out(walks: int, early_back: float, early_down: float) -> Shares:
    """Share out the walks of a pixel; tracks at places below the two that are given are early.

    The rest gets its share of the walks, rounded up; of one walk, or where hardly any pair is
    early, none is set aside.
    """
    share = early_back * early_down
    others = math.ceil((1.0 - share) * walks)
    early = walks - others
    if early == 0 or others == 0:
        return Shares(1.0, 1.0, walks, 0, 1.0, 0.0, 0.0)
    return Shares(
        early_back, early_down, early, others, share * walks / early,
        (1.0 - share) * walks / others, (1.0 - early_back) / (1.0 - share),
    )  # fmt: skip


@inlined_fused_kernel
def spread_evenly(i: int, shares: Shares, shifts: Shifts) -> Evenly:
    """Return the numbers of the i-th of a pixel's walks."""
    back, down, weight = pair(i, shares, shifts.back, shifts.down)
    return Evenly(
        fraction(shifts.in_rows + i * PLASTIC_1),
        fraction(shifts.in_columns + i * PLASTIC_2),
        back,
        down,
        fraction(shifts.turn + i * TURNING),
        weight,
    )


@inlined_fused_kernel
def pair(
    i: int, shares: Shares, shift_back: float, shift_down: float
) -> tuple[float, float, float]:
    """Places of the two tracks of the i-th walk, and its weight."""
    if i < shares.early:
        along = fraction(shift_back + i / shares.early)
        across = fraction(shift_down + i * GOLDEN)
        return shares.early_back * along, shares.early_down * across, shares.early_weight
    i -= shares.early
    along, across = fraction(shift_back + i / shares.others), fraction(shift_down + i * GOLDEN)
    late, early = shares.late_back, 1.0 - shares.late_back
    if along < late:
        back = shares.early_back + (1.0 - shares.early_back) * along / late
        return back, across, shares.other_weight
    down = shares.early_down + (1.0 - shares.early_down) * (along - late) / early
    return shares.early_back * across, down, shares.other_weight

"""Which places a sensor can see through level water, and which are hidden behind others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from terrain.raycast import cast_rays

if TYPE_CHECKING:
    from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]
HALVINGS = 50
CLEAR_OF_GROUND = 0.05  # [m]


def entry_points(
    places: FloatArray, *, sensor: FloatArray, level: float, refractive_index: float
) -> FloatArray:
    """Return where light from a sensor enters level water on its way to places (n, 3).

    By Snell the horizontal ways x in air and R - x in water obey
    x / sqrt(x^2 + H^2) = n (R - x) / sqrt((R - x)^2 + d^2), the left growing with x and the right
    falling: halved 50 times. A place above the water is its own entry.

    Parameters
    ----------
    places : array (n, 3)
        [m].
    sensor : array (3,)
        Above the water [m].
    level : float
        Of the water [m].
    refractive_index : float
        [1].

    Examples
    --------
    >>> at = entry_points(np.array([[50.0, 0.0, -10.0]]), sensor=np.array([0.0, 0.0, 200.0]),
    ...                   level=0.0, refractive_index=1.34)
    >>> at.round(2).tolist()
    [[48.22, 0.0, 0.0]]
    """
    height, depth = sensor[2] - level, level - places[:, 2]
    aside = places[:, :2] - sensor[:2]
    reach = np.hypot(aside[:, 0], aside[:, 1])
    low, high = np.zeros(reach.shape), reach.copy()
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        rest = reach - middle
        in_air = middle / np.hypot(middle, height)
        in_water = refractive_index * rest / np.maximum(np.hypot(rest, depth), 1e-12)
        short = in_air < in_water
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    share = np.divide(low, reach, out=np.zeros_like(reach), where=reach > 0.0)
    at_level = np.column_stack([sensor[:2] + aside * share[:, None], np.full(len(places), level)])
    return np.where((depth > 0.0)[:, None], at_level, places)


def is_hidden(
    places: FloatArray,
    *,
    sensor: FloatArray,
    seabed: Seabed,
    level: float,
    refractive_index: float,
) -> NDArray[np.bool_]:
    """Tell to which places (n, 3) on the ground the seabed itself bars the way from a sensor.

    The laser stands beside the receiver: what one cannot see the other does not light. Places
    are looked at from 5 cm above them, so that the ground they lie on does not hide them.
    """
    raised = places + np.array([0.0, 0.0, CLEAR_OF_GROUND])
    entry = entry_points(raised, sensor=sensor, level=level, refractive_index=refractive_index)
    barred = np.zeros(len(places), np.bool_)
    for start, end in ((raised, entry), (entry, np.broadcast_to(sensor, entry.shape))):
        way = end - start
        some = np.linalg.norm(way, axis=1) > 0.0
        if some.any():
            _, face = cast_rays(seabed.grid, start[some], way[some], 1.0)
            barred[some] |= face >= 0
    return barred

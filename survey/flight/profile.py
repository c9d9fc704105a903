"""What changes along a line: height, speed."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

STEPS_PER_PIECE = 400


@dataclass(frozen=True, kw_only=True)
class Profile:
    """A quantity that goes straight from one stated value to the next and stays at its ends.

    Parameters
    ----------
    distances : tuple of float
        Where values are stated, ascending, along the heading of the lines [m].
    values : tuple of float
        The values there.

    Examples
    --------
    >>> climb = Profile(distances=(0.0, 1000.0), values=(200.0, 300.0))
    >>> climb.at(np.array([-50.0, 250.0, 4000.0])).tolist()
    [200.0, 225.0, 300.0]
    """

    distances: tuple[float, ...]
    values: tuple[float, ...]

    def at(self, distance: FloatArray) -> FloatArray:
        """Return the values at distances [m]."""
        return np.asarray(np.interp(distance, self.distances, self.values))


def even_times(
    speed: Profile, *, start: float, end: float, rate: float
) -> tuple[FloatArray, FloatArray]:
    """Return where flashes at even times fall, until one is at or beyond the end.

    The time of a place is the integral of 1 / speed along the way, by the midpoint rule.

    Parameters
    ----------
    speed : Profile
        Ground speed [m/s].
    start, end : float
        First flash, and the place to reach [m].
    rate : float
        Flashes a second [Hz].

    Returns
    -------
    places, times : array (n,)
        Along the line [m], and since the first flash [s].

    Examples
    --------
    >>> places, times = even_times(Profile(distances=(0.0,), values=(50.0,)),
    ...                            start=100.0, end=190.0, rate=1.0)
    >>> places.round(9).tolist(), times.tolist()
    ([100.0, 150.0, 200.0], [0.0, 1.0, 2.0])
    """
    reach = end + max(speed.values) / rate
    knots = [start, *(d for d in speed.distances if start < d < reach), reach]
    ways = [np.linspace(a, b, STEPS_PER_PIECE + 1) for a, b in pairwise(knots)]
    way = np.unique(np.concatenate(ways))
    middles = 0.5 * (way[1:] + way[:-1])
    passed = np.concatenate([[0.0], np.cumsum(np.diff(way) / speed.at(middles))])
    count = int(np.ceil(np.interp(end, way, passed) * rate - 1e-9)) + 1
    times = np.arange(max(count, 1)) / rate
    return np.interp(times, passed, way), times

"""The tide: how far the sea stands above its mean level."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi


@dataclass(frozen=True, kw_only=True)
class Tide:
    """One harmonic constituent of the tide.

    Parameters
    ----------
    amplitude : float
        Half of the range from low to high water [m].
    period : float
        From high water to high water [s].
    high_water : float
        Time of a high water [s].

    Examples
    --------
    >>> tide = Tide(amplitude=1.5, period=12.42 * 3600.0, high_water=3600.0)
    >>> round(tide.height(3600.0), 3), round(tide.height(3600.0 + 6.21 * 3600.0), 3)
    (1.5, -1.5)
    """

    amplitude: float
    period: float
    high_water: float

    def height(self, time: float) -> float:
        """Return how far the sea stands above mean level at a time [s], [m]."""
        return self.amplitude * cos(2.0 * pi * (time - self.high_water) / self.period)

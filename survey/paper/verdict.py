"""Whether a receiver can exist: what a pixel takes in, what filter and sun do to it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.paper import instrument
from survey.paper.receiver import PaperReceiver

FloatArray = NDArray[np.float64]

# Assumed: a large SPAD pixel behind the fastest usual lens, and its dead time.
SPAD_SIDE = 50e-6  # [m]
F_NUMBER = 1.0
DEAD_TIME = 20e-9  # [s]
FILTER_INDEX = 2.0  # effective index of the filter's layers, usually 1.5 to 2.1 [1]


def spad_etendue() -> float:
    """Etendue that a SPAD pixel accepts behind a lens of its f-number, pi side^2 / (4 F^2) [m2 sr].

    Examples
    --------
    >>> f"{spad_etendue():.2e}"
    '1.96e-09'
    """
    return math.pi * SPAD_SIDE**2 / (4.0 * F_NUMBER**2)


def field_corner() -> float:
    """Angle of the outermost corner of the field of view off the boresight [rad].

    Examples
    --------
    >>> round(math.degrees(field_corner()), 1)
    16.0
    """
    across = math.hypot(instrument.PIXELS_LONG, instrument.PIXELS_SHORT)
    return math.atan(0.5 * across * instrument.PIXEL_ANGLE)


def filter_shift(angle: float) -> float:
    """Shift of an interference filter's band towards the blue, light at an angle to it [m].

    lambda [1 - sqrt(1 - sin^2 t / n^2)], n the effective index of its layers.

    Examples
    --------
    >>> round(filter_shift(field_corner()) * 1e9, 1)
    5.1
    """
    kept = math.sqrt(1.0 - (math.sin(angle) / FILTER_INDEX) ** 2)
    return instrument.LASER.wavelength * (1.0 - kept)


def buildable() -> PaperReceiver:
    """Return the receiver that a SPAD pixel can be fed by, its filter as wide as its own shift.

    Examples
    --------
    >>> round(buildable().aperture_radius * 1e3, 1)
    3.1
    """
    area = spad_etendue() / instrument.PIXEL_SOLID_ANGLE
    return PaperReceiver(
        aperture_radius=math.sqrt(area / math.pi), filter_width=filter_shift(field_corner())
    )


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What speaks against a receiver.

    Parameters
    ----------
    etendue_ratio : float
        Etendue of its pixel over that of a SPAD [1].
    filter_shift : float
        From the centre of the field to its corner [m].
    filter_width : float
        [m].
    sun_per_gate, sun_per_dead_time : float
        Counts of the sun by day in 10 ns, and in a SPAD's dead time [1].
    surface_per_gate : float
        Counts of the surface's spike in 10 ns [1].
    """

    etendue_ratio: float
    filter_shift: float
    filter_width: float
    sun_per_gate: float
    sun_per_dead_time: float
    surface_per_gate: float

    @property
    def can_exist(self) -> bool:
        """Whether nothing speaks against it."""
        return (
            self.etendue_ratio <= 1.0
            and self.filter_shift <= self.filter_width
            and self.sun_per_dead_time < 1.0
        )

    def sentences(self) -> list[str]:
        """Return the verdict in plain words."""
        opening = "can exist" if self.can_exist else "cannot be built"
        kept = "all" if self.filter_shift <= self.filter_width else "not all"
        return [
            f"The fitted receiver {opening} with a SPAD matrix: the etendue of its pixel is "
            f"{self.etendue_ratio:,.0f} times what a {SPAD_SIDE * 1e6:.0f} um pixel accepts at "
            f"f/{F_NUMBER:g}.",
            f"From the centre to the corner of the field ({math.degrees(field_corner()):.0f} deg) "
            f"an interference filter shifts by {self.filter_shift * 1e9:.1f} nm, its width is "
            f"{self.filter_width * 1e9:.1f} nm: {kept} pixels see the laser.",
            f"By day the sun gives {self.sun_per_gate:,.0f} counts in 10 ns, "
            f"{self.sun_per_dead_time:,.0f} in a dead time of {DEAD_TIME * 1e9:.0f} ns, where a "
            f"SPAD counts one at most; the surface's spike gives "
            f"{self.surface_per_gate / 1e6:,.0f} million.",
        ]


def judge(receiver: PaperReceiver, *, surface: Mapping[str, FloatArray]) -> Verdict:
    """Judge a receiver.

    Parameters
    ----------
    receiver : PaperReceiver
    surface : dict of array
        Power of the surface's echo per area of the aperture, by water [W/m2].
    """
    sun = receiver.background_rate(instrument.SUNS["day"])
    spike = max(float(receiver.signal_rate(power).max()) for power in surface.values())
    return Verdict(
        etendue_ratio=receiver.etendue / spad_etendue(),
        filter_shift=filter_shift(field_corner()),
        filter_width=receiver.filter_width,
        sun_per_gate=sun * instrument.MEASURING_TIME,
        sun_per_dead_time=sun * DEAD_TIME,
        surface_per_gate=spike * instrument.MEASURING_TIME,
    )

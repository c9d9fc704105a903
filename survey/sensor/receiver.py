"""The receiver in front of the detector: aperture, filter, gate."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True, kw_only=True)
class Receiver:
    """Telescope, filter and time gate.

    Parameters
    ----------
    aperture_radius : float
        Radius of the entrance pupil, perpendicular to the boresight [m].
    filter_width : float
        Width of the interference filter, taken as a box [m].
    optics_transmission : float
        Share of the light that passes optics and filter [1].
    gate_start : float
        Early edge of the first bin, after the pulse's centroid leaves [s].
    bin_width : float
        Width of a bin [s].
    bins : int
        Number of bins.

    Examples
    --------
    >>> receiver = Receiver(aperture_radius=0.1, filter_width=1e-9, optics_transmission=0.5,
    ...                     gate_start=1.3e-6, bin_width=1e-9, bins=300)
    >>> round(receiver.aperture_area, 4), round(receiver.gate_end * 1e9)
    (0.0314, 1600)
    """

    aperture_radius: float
    filter_width: float
    optics_transmission: float
    gate_start: float
    bin_width: float
    bins: int

    @property
    def aperture_area(self) -> float:
        """Area of the entrance pupil [m2]."""
        return pi * self.aperture_radius**2

    @property
    def gate_end(self) -> float:
        """Late edge of the last bin [s]."""
        return self.gate_start + self.bins * self.bin_width

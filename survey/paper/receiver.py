"""The receiver that the paper leaves open: aperture, filter, efficiency."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.optics.background import background_power
from survey.paper import instrument
from survey.sensor.photon_counting import photo_electron_rate

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class PaperReceiver:
    """One pixel's share of telescope, filter and photon counter.

    Parameters
    ----------
    aperture_radius : float
        r_r of equation (1) of [Lisenko2017] [m].
    filter_width : float
        Delta lambda [m].
    efficiency : float
        eta of equation (8), losses of the optics included [1].

    Examples
    --------
    >>> receiver = PaperReceiver(aperture_radius=0.35, filter_width=2.5e-9, efficiency=0.3)
    >>> f"{receiver.etendue:.2e} m2 sr, {receiver.background_rate(50.0) * 10e-9:.0f} counts"
    '2.46e-05 m2 sr, 24736 counts'
    """

    aperture_radius: float
    filter_width: float
    efficiency: float = instrument.EFFICIENCY

    @property
    def aperture_area(self) -> float:
        """Area of the entrance pupil [m2]."""
        return math.pi * self.aperture_radius**2

    @property
    def etendue(self) -> float:
        """Aperture times solid angle of a pixel [m2 sr]."""
        return self.aperture_area * instrument.PIXEL_SOLID_ANGLE

    def signal_rate(self, power_per_area: FloatArray) -> FloatArray:
        """Photo-electrons a second, equation (8), of power per area of the aperture [W/m2]."""
        return np.asarray(self._rate(power_per_area * self.aperture_area))

    def background_rate(self, brightness: float) -> float:
        """Photo-electrons of the sun a second, equations (1) and (8).

        Parameters
        ----------
        brightness : float
            L_b [W/(m2 um sr)].
        """
        power = background_power(
            radiance=brightness * instrument.PER_MICROMETRE,
            filter_width=self.filter_width,
            aperture_area=self.aperture_area,
            solid_angle=instrument.PIXEL_SOLID_ANGLE,
        )
        return float(self._rate(power))

    def _rate(self, power: float | FloatArray) -> Any:
        return photo_electron_rate(
            power=power,
            quantum_efficiency=self.efficiency,
            photon_energy=instrument.LASER.photon_energy,
        )

"""Spectra of wind waves: how much of the elevation's variance stands at which frequency.

Pierson and Moskowitz (1964) for fully developed seas, Hasselmann et al. (1973), JONSWAP, for those
that grow. Formulas and numbers as in Stewart, Introduction to Physical Oceanography (2008), section
16.4, but in hertz. There the first has its peak at omega = 0.877 g / U19.5, eq. (16.30); here at
the 0.817 g / U10 that goes with that.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.constants import g

FloatArray = NDArray[np.float64]

PHILLIPS = 0.0081
FULL_PEAK = 0.13  # f_p U10 / g of the fully developed sea
FETCH_PEAK = 3.5  # f_p U10 / g times the cube root of g F / U10^2: 22 / (2 pi)
FETCH_ALPHA, FETCH_ALPHA_POWER = 0.076, 0.22
ENHANCEMENT = 3.3
WIDTH_BELOW, WIDTH_ABOVE = 0.07, 0.09
FULL_FETCH = (FETCH_PEAK / FULL_PEAK) ** 3  # g F / U10^2 at which both peaks are one


def pierson_moskowitz(
    frequency: FloatArray, *, peak_frequency: float, alpha: float = PHILLIPS
) -> FloatArray:
    """Return alpha g^2 (2 pi)^-4 f^-5 exp[-1.25 (f / f_p)^-4] [m2/Hz].

    Parameters
    ----------
    frequency : array
        f, positive [Hz].
    peak_frequency : float
        f_p [Hz].
    alpha : float
        Level of the tail [1].

    Examples
    --------
    >>> pierson_moskowitz(np.array([0.13, 0.5]), peak_frequency=0.13).round(4)
    array([3.8568, 0.0159])
    """
    tail = alpha * g**2 * (2.0 * pi) ** -4.0 * frequency**-5.0
    return np.asarray(tail * np.exp(-1.25 * (peak_frequency / frequency) ** 4))


def jonswap(
    frequency: FloatArray, *, peak_frequency: float, alpha: float, enhancement: float = ENHANCEMENT
) -> FloatArray:
    """Return `pierson_moskowitz` times gamma^exp[-(f - f_p)^2 / (2 s^2 f_p^2)].

    s is 0.07 up to the peak and 0.09 above it.

    Parameters
    ----------
    frequency, peak_frequency, alpha
        See `pierson_moskowitz`.
    enhancement : float
        gamma, how much higher the peak is [1].

    Examples
    --------
    >>> jonswap(np.array([0.13, 0.5]), peak_frequency=0.13, alpha=0.012).round(4)
    array([18.8552,  0.0236])
    """
    width = np.where(frequency <= peak_frequency, WIDTH_BELOW, WIDTH_ABOVE)
    from_peak = (frequency - peak_frequency) / (width * peak_frequency)
    plain = pierson_moskowitz(frequency, peak_frequency=peak_frequency, alpha=alpha)
    return np.asarray(plain * enhancement ** np.exp(-0.5 * from_peak**2))


@dataclass(frozen=True, kw_only=True)
class WindSea:
    """Waves that the wind makes, by their spectrum.

    Parameters
    ----------
    wind_speed : float
        At 10 m height, positive [m/s].
    peak_frequency : float
        [Hz].
    alpha : float
        Level of the tail [1].
    enhancement : float
        gamma of JONSWAP; 1 is Pierson and Moskowitz's spectrum [1].
    """

    wind_speed: float
    peak_frequency: float
    alpha: float
    enhancement: float

    @classmethod
    def fully_developed(cls, *, wind_speed: float) -> WindSea:
        """Return the sea after long wind over wide water, Pierson and Moskowitz (1964).

        Its significant height is 0.24 U10^2 / g; in Stewart 0.21 U^2 / g, U at 19.5 m, eq. (16.33).

        Examples
        --------
        >>> round(1.0 / WindSea.fully_developed(wind_speed=10.0).peak_frequency, 2)
        7.84
        """
        return cls(
            wind_speed=wind_speed,
            peak_frequency=FULL_PEAK * g / wind_speed,
            alpha=PHILLIPS,
            enhancement=1.0,
        )

    @classmethod
    def fetch_limited(cls, *, wind_speed: float, fetch: float) -> WindSea:
        """Return the sea at a distance [m] from the lee shore, Hasselmann et al. (1973).

        alpha = 0.076 (U10^2 / F g)^0.22 and omega_p = 22 (g^2 / U10 F)^(1/3).
        Departure: beyond g F / U10^2 = 19,500, where the peak has come to that of the fully
        developed sea, waves grow no further.

        Examples
        --------
        >>> sea = WindSea.fetch_limited(wind_speed=10.0, fetch=20e3)
        >>> round(1.0 / sea.peak_frequency, 2), round(sea.alpha, 4)
        (3.65, 0.0143)
        """
        fetches = min(g * fetch / wind_speed**2, FULL_FETCH)
        return cls(
            wind_speed=wind_speed,
            peak_frequency=FETCH_PEAK * g / wind_speed / fetches ** (1.0 / 3.0),
            alpha=FETCH_ALPHA * fetches**-FETCH_ALPHA_POWER,
            enhancement=ENHANCEMENT,
        )

    def density(self, frequency: FloatArray) -> FloatArray:
        """Return the spectrum in deep water at positive frequencies [Hz] [m2/Hz]."""
        return jonswap(
            frequency,
            peak_frequency=self.peak_frequency,
            alpha=self.alpha,
            enhancement=self.enhancement,
        )

"""Light of the sun that reaches the receiver, after [Lisenko2017] equations (1), (5) and (6).

[Lisenko2017]: A. A. Lisenko, A. I. Potekaev, V. S. Shamanaev, Russian Physics Journal (2017).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, exp, pi

SURFACE_TRANSMITTANCE = 0.98  # T_down = T_up, [Lisenko2017]
PAPER_INDEX = 1.33  # m, [Lisenko2017]
SURFACE_BRIGHTNESS = ((2.0, 0.033), (5.0, 0.077))  # (U [m/s], rho_sf), sun at 20 degrees


def surface_irradiance(
    *, zenith: float, solar_irradiance: float, optical_thickness: float, legendre_moment: float
) -> float:
    """Irradiance of the sea by sun and sky, equation (5) of [Lisenko2017], E_perp's unit.

    Parameters
    ----------
    zenith : float
        Solar zenith angle [rad].
    solar_irradiance : float
        Spectral solar constant E_perp [W/m3, that is per metre of wavelength].
    optical_thickness : float
        Of the atmosphere, tau0 [1].
    legendre_moment : float
        First Legendre moment x1 of the atmospheric phase function [1].

    Examples
    --------
    >>> round(surface_irradiance(zenith=0.0, solar_irradiance=1.0, optical_thickness=0.0,
    ...                          legendre_moment=1.5), 12)
    1.0
    """
    mu = cos(zenith)
    numerator = 2.0 * (1.0 + 1.5 * mu + (1.0 - 1.5 * mu) * exp(-optical_thickness / mu))
    return numerator / (4.0 + (3.0 - legendre_moment) * optical_thickness) * solar_irradiance * mu


def surface_brightness(wind_speed: float) -> float:
    """Brightness coefficient rho_sf of the sea surface [1], the sun at 20 degrees.

    Linear through the two values that [Lisenko2017] prints. Departures: they are used for other
    winds, down to 0 and no further, and for other heights of the sun.

    Examples
    --------
    >>> round(surface_brightness(2.0), 3), round(surface_brightness(5.0), 3)
    (0.033, 0.077)
    """
    (low_wind, low), (high_wind, high) = SURFACE_BRIGHTNESS
    slope = (high - low) / (high_wind - low_wind)
    return max(0.0, low + slope * (wind_speed - low_wind))


@dataclass(frozen=True, kw_only=True)
class Sky:
    """Sun, sky and sea as a low-flying receiver sees them at nadir.

    Parameters
    ----------
    zenith, solar_irradiance, optical_thickness, legendre_moment
        See `surface_irradiance`.
    wind_speed : float
        Wind [m/s].
    water_reflectance : float
        Brightness coefficient rho_s of the water's own light [1].
    """

    zenith: float
    wind_speed: float
    optical_thickness: float
    solar_irradiance: float
    legendre_moment: float
    water_reflectance: float

    def radiance(self) -> float:
        """Spectral radiance towards the receiver, equation (6) of [Lisenko2017] [W/(m3 sr)].

        As printed: haze below the aircraft neglected, and without the T_down of equation (4).

        Examples
        --------
        >>> sky = Sky(zenith=0.349066, wind_speed=5.0, optical_thickness=0.3,
        ...           solar_irradiance=1.95e9, legendre_moment=1.5, water_reflectance=0.0097)
        >>> round(sky.radiance() * 1e-6, 1)  # W/(m2 um sr)
        51.8
        """
        irradiance = surface_irradiance(
            zenith=self.zenith,
            solar_irradiance=self.solar_irradiance,
            optical_thickness=self.optical_thickness,
            legendre_moment=self.legendre_moment,
        )
        from_water = SURFACE_TRANSMITTANCE**2 / PAPER_INDEX**2 * self.water_reflectance
        return (from_water + surface_brightness(self.wind_speed) / pi) * irradiance


def background_power(
    *, radiance: float, filter_width: float, aperture_area: float, solid_angle: float
) -> float:
    """Power of the background in one pixel, equation (1) of [Lisenko2017] [W].

    Parameters
    ----------
    radiance : float
        L_b [W/(m3 sr)].
    filter_width : float
        Width of the filter [m].
    aperture_area, solid_angle : float
        Of the receiver [m2] and of the pixel [sr]; departure: a square pixel has its own solid
        angle, the paper's circle of the same width is 1.27 times smaller.

    Examples
    --------
    >>> background_power(radiance=5e7, filter_width=1e-9, aperture_area=2.0, solid_angle=1e-4)
    1e-05
    """
    return radiance * filter_width * aperture_area * solid_angle

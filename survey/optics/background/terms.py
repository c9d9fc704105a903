"""The terms of the background as [Lisenko2017] prints them, equations (2) to (7)."""

from __future__ import annotations

from math import cos, exp, pi

TRANSMITTANCE_DOWN = 0.98  # T_down of the surface, [Lisenko2017]
TRANSMITTANCE_UP = 0.98  # T_up, [Lisenko2017]
PAPER_INDEX = 1.33  # m, [Lisenko2017]
PAPER_BRIGHTNESS = ((2.0, 0.033), (5.0, 0.077))  # (U [m/s], rho_sf), sun at 20 degrees


def haze_radiance(
    *, zenith: float, solar_irradiance: float, optical_thickness: float, layer_thickness: float
) -> float:
    """Radiance L_h of the air between sea and receiver at nadir, equation (2) of [Lisenko2017].

    This is single scattering, alike in all directions and without absorption.

    Parameters
    ----------
    zenith : float
        Solar zenith angle [rad].
    solar_irradiance : float
        Spectral solar constant E_perp, printed as pi S [W/m3, that is per metre of wavelength].
    optical_thickness : float
        Of the whole atmosphere, tau0 [1].
    layer_thickness : float
        Optical thickness tau of the air below the receiver, 0 to tau0 [1].

    Returns
    -------
    float
        [W/(m3 sr)].

    Examples
    --------
    >>> sun = {"zenith": 0.0, "solar_irradiance": 1.0, "optical_thickness": 0.3}
    >>> haze_radiance(**sun, layer_thickness=0.0)
    0.0
    >>> round(haze_radiance(**sun, layer_thickness=0.3), 5)
    0.01795
    """
    mu, above = cos(zenith), optical_thickness - layer_thickness
    slant = 1.0 + 1.0 / mu
    lit = exp(-above * slant) - exp(-optical_thickness * slant)
    return solar_irradiance * mu / (4.0 * pi * (1.0 + mu)) * exp(above) * lit


def water_radiance(*, irradiance: float, water_reflectance: float, layer_thickness: float) -> float:
    """Radiance L_s of the light that leaves the water, equation (3) of [Lisenko2017] [W/(m3 sr)].

    As printed, without the 1/pi that equation (4) has, though both coefficients go by one name.

    Parameters
    ----------
    irradiance : float
        E of the sea by sun and sky, equation (5) [W/m3].
    water_reflectance : float
        Brightness coefficient rho_s of the water [1]; it acts as a ratio per steradian.
    layer_thickness : float
        See `haze_radiance`.

    Examples
    --------
    >>> round(water_radiance(irradiance=1.0, water_reflectance=0.0097, layer_thickness=0.0), 6)
    0.005266
    """
    through = TRANSMITTANCE_DOWN * TRANSMITTANCE_UP / PAPER_INDEX**2
    return through * irradiance * water_reflectance * exp(-layer_thickness)


def surface_radiance(
    *,
    irradiance: float,
    brightness: float,
    layer_thickness: float,
    transmittance: float = TRANSMITTANCE_DOWN,
) -> float:
    """Radiance L_sf of the light that the surface reflects, equation (4) of [Lisenko2017].

    As printed, with the T_down that light from above the surface does not need.

    Parameters
    ----------
    irradiance : float
        E of the sea by sun and sky, equation (5) [W/m3].
    brightness : float
        Brightness coefficient rho_sf of the surface [1].
    layer_thickness : float
        See `haze_radiance`.
    transmittance : float
        T_down; 1 takes it away, as equations (6) and (7) do [1].

    Returns
    -------
    float
        [W/(m3 sr)].

    Examples
    --------
    >>> round(surface_radiance(irradiance=1.0, brightness=0.077, layer_thickness=0.0), 6)
    0.02402
    """
    return transmittance * brightness * irradiance / pi * exp(-layer_thickness)


def surface_irradiance(
    *, zenith: float, solar_irradiance: float, optical_thickness: float, legendre_moment: float
) -> float:
    """Irradiance of the sea by sun and sky, equation (5) of [Lisenko2017], E_perp's unit.

    Parameters
    ----------
    zenith, solar_irradiance, optical_thickness
        See `haze_radiance`.
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


def low_flight_radiance(*, irradiance: float, water_reflectance: float, brightness: float) -> float:
    """Radiance L_b seen from low above the sea, equation (6) of [Lisenko2017] [W/(m3 sr)].

    The sum of (2) to (4) at tau = 0, but as printed without the T_down of (4): 1.6 % more by the
    paper's own numbers.

    Parameters
    ----------
    irradiance, water_reflectance, brightness
        See `water_radiance` and `surface_radiance`.

    Examples
    --------
    >>> round(low_flight_radiance(irradiance=1.0, water_reflectance=0.0097, brightness=0.077), 6)
    0.029776
    """
    from_water = TRANSMITTANCE_DOWN * TRANSMITTANCE_UP * water_reflectance / PAPER_INDEX**2
    return (from_water + brightness / pi) * irradiance


def high_flight_radiance(
    *,
    zenith: float,
    solar_irradiance: float,
    optical_thickness: float,
    irradiance: float,
    water_reflectance: float,
    brightness: float,
) -> float:
    """Radiance L_b seen from 10 km or more, equation (7) of [Lisenko2017] [W/(m3 sr)].

    The sum of (2) to (4) at tau = tau0, but as printed without the T_down of (4) and without
    exp(-tau0) on the light of the sea: 0.74 by the paper's own numbers.

    Parameters
    ----------
    zenith, solar_irradiance, optical_thickness
        See `haze_radiance`.
    irradiance, water_reflectance, brightness
        See `water_radiance` and `surface_radiance`.

    Examples
    --------
    >>> round(high_flight_radiance(zenith=0.0, solar_irradiance=1.0, optical_thickness=0.3,
    ...     irradiance=1.0, water_reflectance=0.0097, brightness=0.077), 6)
    0.047729
    """
    mu = cos(zenith)
    lit = 1.0 - exp(-optical_thickness * (1.0 + 1.0 / mu))
    haze = solar_irradiance * mu / (4.0 * pi * (1.0 + mu)) * lit
    return haze + low_flight_radiance(
        irradiance=irradiance, water_reflectance=water_reflectance, brightness=brightness
    )


def surface_brightness(wind_speed: float) -> float:
    """Brightness coefficient rho_sf of the sea surface [1], the sun at 20 degrees.

    Linear between the two winds that [Lisenko2017] prints. Departures: for weaker winds the line
    is continued, down to 0 and no further; for stronger ones the last value stands, since glint
    at 20 degrees grows no more there; and it is used for other heights of the sun, where
    `CoxMunkGlint` should be taken.

    Examples
    --------
    >>> [round(surface_brightness(wind_speed), 3) for wind_speed in (2.0, 3.5, 5.0, 9.0)]
    [0.033, 0.055, 0.077, 0.077]
    """
    (low_wind, low), (high_wind, high) = PAPER_BRIGHTNESS
    slope = (high - low) / (high_wind - low_wind)
    return max(0.0, low + slope * (min(wind_speed, high_wind) - low_wind))

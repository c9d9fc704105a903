"""Sun and sky mirrored by a wind-roughened sea, towards a receiver straight above.

Slopes after C. Cox and W. Munk, Journal of the Optical Society of America 44, 838 (1954).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, exp, pi, sin, tan

from survey.optics.background.terms import surface_irradiance
from survey.optics.interface import fresnel_reflectance
from terrain.sea_surface import SeaSurface


def sunbeam(*, zenith: float, solar_irradiance: float, optical_thickness: float) -> float:
    """Irradiance by the sun alone, square to its rays, at sea level, E_perp's unit.

    Bouguer's law, E_perp exp(-tau0 / cos t0): the same share that equation (5) counts as direct.

    Parameters
    ----------
    zenith, solar_irradiance, optical_thickness
        See `survey.optics.background.haze_radiance`.

    Examples
    --------
    >>> round(sunbeam(zenith=0.0, solar_irradiance=1.0, optical_thickness=0.3), 4)
    0.7408
    """
    return solar_irradiance * exp(-optical_thickness / cos(zenith))


def sun_glint(
    *, beam: float, zenith: float, sun_azimuth: float, sea: SeaSurface, refractive_index: float
) -> float:
    """Radiance of the sun's glitter seen at nadir, Cox and Munk (1954) [beam's unit / sr].

    rho F p(slope) / (4 cos^4 b), where facets tilted by b, half the sun's zenith angle, mirror
    the sun upwards, p is the Gaussian density of their slope and rho Fresnel's reflectance at b.
    Departures: without the skewness and peakedness of Cox and Munk's density, without foam, and
    seen at nadir; towards the sun a pixel off nadir sees more, away from it less. The slopes were
    measured in winds of 1 to 14 m/s.

    Parameters
    ----------
    beam : float
        Irradiance F by the sun, square to its rays [any unit].
    zenith : float
        Solar zenith angle, 0 to below pi/2 [rad].
    sun_azimuth : float
        Direction of the sun, clockwise from grid north [rad].
    sea : SeaSurface
        The slopes and the wind's direction; not still water.
    refractive_index : float
        Of the water [1].

    Examples
    --------
    >>> sea = SeaSurface.from_wind(
    ...     level=0.0, wind_speed=5.0, wind_from=0.0)
    >>> round(sun_glint(beam=1.0, zenith=0.349066, sun_azimuth=0.0, sea=sea,
    ...                 refractive_index=1.33), 5)
    0.02249
    """
    tilt, from_wind = 0.5 * zenith, sun_azimuth - sea.wind_from
    up = tan(tilt) * cos(from_wind)
    across = tan(tilt) * sin(from_wind)
    up_variance, cross_variance = sea.upwind_slope_variance, sea.crosswind_slope_variance
    exponent = 0.5 * (up**2 / up_variance + across**2 / cross_variance)
    density = exp(-exponent) / (2.0 * pi * (up_variance * cross_variance) ** 0.5)
    rho = fresnel_reflectance(cos(tilt), 1.0 / refractive_index)
    return float(rho * beam * density / (4.0 * cos(tilt) ** 4))


def reflected_skylight(*, diffuse: float, refractive_index: float) -> float:
    """Radiance of the sky mirrored at nadir [diffuse's unit / sr].

    Departures: the sky is equally bright all over, and reflects as on level water: facets up to
    20 degrees alter Fresnel's reflectance by less than 2 %.

    Parameters
    ----------
    diffuse : float
        Irradiance of level water by the sky without the sun [any unit].
    refractive_index : float
        Of the water [1].

    Examples
    --------
    >>> round(reflected_skylight(diffuse=1.0, refractive_index=1.34), 5)
    0.00672
    """
    return float(fresnel_reflectance(1.0, 1.0 / refractive_index) * diffuse / pi)


@dataclass(frozen=True, kw_only=True)
class CoxMunkGlint:
    """Surface brightness by measured wave slopes, in the stead of the paper's two numbers.

    Parameters
    ----------
    sea, sun_azimuth, refractive_index
        See `sun_glint`.

    Raises
    ------
    ValueError
        When the water is still, and a mirror.
    """

    sea: SeaSurface
    sun_azimuth: float
    refractive_index: float

    def __post_init__(self) -> None:
        if not min(self.sea.upwind_slope_variance, self.sea.crosswind_slope_variance) > 0.0:
            raise ValueError("glint: still water mirrors the sun's disc; give the sea some wind")

    def brightness(
        self, *, zenith: float, optical_thickness: float, legendre_moment: float
    ) -> float:
        """Brightness coefficient rho_sf of equations (4), (6) and (7): pi L / E [1].

        L is `sun_glint` of the sunbeam plus `reflected_skylight` of what equation (5) leaves to
        the sky.

        Parameters
        ----------
        zenith, optical_thickness, legendre_moment
            See `survey.optics.background.surface_irradiance`.

        Raises
        ------
        ValueError
            When equation (5) gives less light than the sunbeam alone, which happens for
            legendre_moment below -2.

        Examples
        --------
        >>> sea = SeaSurface.from_wind(
        ...     level=0.0, wind_speed=5.0, wind_from=0.0)
        >>> glint = CoxMunkGlint(sea=sea, sun_azimuth=0.0, refractive_index=1.33)
        >>> round(glint.brightness(zenith=0.349066, optical_thickness=0.3,
        ...                        legendre_moment=1.5), 4)
        0.0623
        """
        irradiance = surface_irradiance(
            zenith=zenith,
            solar_irradiance=1.0,
            optical_thickness=optical_thickness,
            legendre_moment=legendre_moment,
        )
        beam = sunbeam(zenith=zenith, solar_irradiance=1.0, optical_thickness=optical_thickness)
        diffuse = irradiance - beam * cos(zenith)
        if diffuse < -1e-12:
            raise ValueError(
                f"glint: legendre_moment = {legendre_moment:g}: equation (5) leaves the sky a "
                "negative irradiance; take -2 or more"
            )
        from_sun = sun_glint(
            beam=beam,
            zenith=zenith,
            sun_azimuth=self.sun_azimuth,
            sea=self.sea,
            refractive_index=self.refractive_index,
        )
        from_sky = reflected_skylight(diffuse=diffuse, refractive_index=self.refractive_index)
        return pi * (from_sun + from_sky) / irradiance

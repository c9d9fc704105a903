"""What instruments and eyes make of a water: K_d, reflectance, Secchi depth, turbidity."""

from __future__ import annotations

from math import degrees, exp, inf, log
from typing import TYPE_CHECKING

from survey.optics.water.medium import Water
from survey.optics.water.spectra import NM, tabled

if TYPE_CHECKING:
    from survey.optics.water.column import WaterColumn

TYLER_COUPLING = 8.69


def lee_diffuse_attenuation(
    *, absorption: float, backscattering: float, sun_zenith: float
) -> float:
    """Diffuse attenuation K_d of sunlight in the upper layer, Lee, Du and Arnone (2005) [1/m].

    K_d = (1 + 0.005 t) a + 4.18 [1 - 0.52 exp(-10.8 a)] b_b, t the sun's zenith angle in degrees.
    Against radiative transfer 2 % wrong on average, 12 % at most (their abstract).

    Parameters
    ----------
    absorption, backscattering : float
        a and b_b [1/m].
    sun_zenith : float
        In air [rad].

    Examples
    --------
    >>> round(lee_diffuse_attenuation(absorption=0.179, backscattering=0.00293, sun_zenith=0), 3)
    0.19
    """
    beam = (1.0 + 0.005 * degrees(sun_zenith)) * absorption
    return beam + 4.18 * (1.0 - 0.52 * exp(-10.8 * absorption)) * backscattering


def diffuse_attenuation(water: Water) -> float:
    """Return K_d by Lee et al. (2005) under a sun at the zenith, near what a wide beam sees [1/m].

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> water = petzold_water("coastal", refractive_index=1.33, group_index=1.33)
    >>> f"{diffuse_attenuation(water):.3f} 1/m"
    '0.190 1/m'
    """
    return lee_diffuse_attenuation(
        absorption=water.absorption, backscattering=water.backscattering, sun_zenith=0.0
    )


def austin_petzold_attenuation(*, kd_490: float, wavelength: float) -> float:
    """K_d at a wavelength from that at 490 nm, Austin and Petzold (1986) [1/m].

    K_d = M [K_d(490) - K_w(490)] + K_w. Made from oceanic waters; against `OneParameterWaters`
    it is 8 % low at K_d(490) = 0.3 1/m and 17 % at 0.6.

    Parameters
    ----------
    kd_490 : float
        [1/m].
    wavelength : float
        400 to 700 nm [m].

    Raises
    ------
    ValueError
        When the wavelength lies outside the table.

    Examples
    --------
    >>> round(austin_petzold_attenuation(kd_490=0.1, wavelength=532e-9), 4)
    0.1065
    """
    table = "austin_petzold_1986.csv"
    slope = tabled(table, 1, wavelength=wavelength)
    water, water_490 = (tabled(table, 2, wavelength=at) for at in (wavelength, 490 * NM))
    return slope * (kd_490 - water_490) + water


def lee_reflectance(*, absorption: float, backscattering: float) -> float:
    """Remote-sensing reflectance above the surface, Lee, Carder and Arnone (2002) [1/sr].

    u = b_b / (a + b_b), r = (0.089 + 0.125 u) u, R = 0.52 r / (1 - 1.7 r).

    Examples
    --------
    >>> round(lee_reflectance(absorption=0.06, backscattering=0.006), 4)
    0.0048
    """
    share = backscattering / (absorption + backscattering)
    below = (0.089 + 0.125 * share) * share
    return 0.52 * below / (1.0 - 1.7 * below)


def tyler_secchi_depth(
    *, attenuation: float, diffuse_attenuation: float, coupling: float = TYLER_COUPLING
) -> float:
    """Depth at which a Secchi disk vanishes, Tyler (1968), Preisendorfer (1986) [m].

    Z = G / (c + K_d), both for the eye, which is most sensitive at 555 nm.

    Parameters
    ----------
    attenuation, diffuse_attenuation : float
        c and K_d [1/m].
    coupling : float
        G, 8.69 by Tyler; by contrast of the disk, light and eye [1].

    Examples
    --------
    >>> round(tyler_secchi_depth(attenuation=0.398, diffuse_attenuation=0.19), 1)
    14.8
    """
    return coupling / (attenuation + diffuse_attenuation)


def secchi_depth_of(water: WaterColumn) -> float:
    """Depth at which a Secchi disk vanishes in layered water [m].

    Where the integral of c + K_d reaches Tyler's coupling; in uniform water `tyler_secchi_depth`.
    Departures: with the coefficients at the laser's wavelength, not the eye's 555 nm, and with
    K_d of `diffuse_attenuation`.

    Examples
    --------
    >>> from survey.optics.water import WaterColumn, petzold_water
    >>> coastal = petzold_water("coastal", refractive_index=1.34, group_index=1.36)
    >>> round(secchi_depth_of(WaterColumn.uniform(coastal)), 1)
    14.8
    """
    depth, left = 0.0, TYLER_COUPLING
    for number, layer in enumerate(water.layers):
        rate = layer.water.attenuation + diffuse_attenuation(layer.water)
        below = water.layers[number + 1 : number + 2]
        thickness = below[0].top - layer.top if below else inf
        if rate * thickness >= left:
            return depth + left / rate
        depth, left = depth + thickness, left - rate * thickness
    raise AssertionError("the last layer has no end")


def lee_secchi_depth(*, diffuse_attenuation: float, reflectance: float) -> float:
    """Depth at which a Secchi disk vanishes, Lee et al. (2015) [m].

    Z = ln(|0.14 - R| / 0.013) / (2.5 K_d), at the wavelength where K_d is least.

    Parameters
    ----------
    diffuse_attenuation : float
        Least K_d of the visible [1/m].
    reflectance : float
        Remote-sensing reflectance R there [1/sr].

    Examples
    --------
    >>> round(lee_secchi_depth(diffuse_attenuation=0.1, reflectance=0.005), 2)
    9.36
    """
    return log(abs(0.14 - reflectance) / 0.013) / (2.5 * diffuse_attenuation)


def kirk_turbidity_scattering(*, turbidity: float, ratio: float = 1.0) -> float:
    """Scattering of particles by nephelometric turbidity, Kirk, Light and Photosynthesis [1/m].

    Kirk: "for turbid waters, by a convenient coincidence, b / T is about 1 1/m per NTU".

    Parameters
    ----------
    turbidity : float
        T [NTU].
    ratio : float
        b / T [1/m per NTU].

    Examples
    --------
    >>> kirk_turbidity_scattering(turbidity=2.5)
    2.5
    """
    return ratio * turbidity

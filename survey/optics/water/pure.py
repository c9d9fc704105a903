"""Pure water and pure sea water: absorption and scattering."""

from __future__ import annotations

from math import pi, sqrt

from survey.optics.water.spectra import NM, tabled

PAPER_ABSORPTION = 22e-3  # [Lisenko2017], 22 1/km: half of the accepted value
PAPER_SCATTERING = 1.5e-3  # [Lisenko2017], 1.5 1/km: that of fresh water
PAPER_WAVELENGTHS = (525 * NM, 535 * NM)  # printed for 0.53 um
ZERO_CELSIUS = 273.15

BOLTZMANN = 1.3806503e-23  # this and the next two as in the authors' program
AVOGADRO = 6.0221417930e23
MOLAR_MASS = 18e-3


def pope_fry_absorption(*, wavelength: float) -> float:
    """Absorption of pure water, Pope and Fry (1997), 400 to 700 nm [1/m].

    Salt changes it by less than its own error in the visible.

    Raises
    ------
    ValueError
        When the wavelength [m] lies outside the table.

    Examples
    --------
    >>> round(pope_fry_absorption(wavelength=532e-9), 4)
    0.0444
    """
    return tabled("pope_fry_1997.csv", 1, wavelength=wavelength)


def smith_baker_absorption(*, wavelength: float) -> float:
    """Absorption of the clearest natural waters, Smith and Baker (1981), 400 to 700 nm [1/m].

    Raises
    ------
    ValueError
        When the wavelength [m] lies outside the table.

    Examples
    --------
    >>> round(smith_baker_absorption(wavelength=530e-9), 4)
    0.0507
    """
    return tabled("smith_baker_1981.csv", 1, wavelength=wavelength)


def require_paper_wavelength(wavelength: float) -> None:
    """Refuse to take the paper's figures for pure water far from their 0.53 um.

    Raises
    ------
    ValueError
        When the wavelength [m] lies outside 525 to 535 nm.
    """
    low, high = PAPER_WAVELENGTHS
    if not low - 1e-15 <= wavelength <= high + 1e-15:
        raise ValueError(
            f"the paper's figures for pure water hold at 530 nm: {wavelength / NM:g} nm is outside "
            f"{low / NM:g} to {high / NM:g} nm"
        )


def morel_scattering(*, wavelength: float, salinity: float) -> float:
    """Scattering of pure water and sea water, Morel (1974) [1/m].

    b = 2.22e-3 (1 + 0.3 S / 37) (wavelength / 500 nm)^-4.32; the salt's share as Twardowski et al.
    (2007) state it.

    Parameters
    ----------
    wavelength : float
        In vacuum [m].
    salinity : float
        Practical salinity S [1].

    Examples
    --------
    >>> [round(morel_scattering(wavelength=532e-9, salinity=s) * 1e3, 2) for s in (0.0, 35.0)]
    [1.7, 2.18]
    """
    by_wavelength = (wavelength / (500 * NM)) ** -4.32
    return float(2.22e-3 * (1.0 + 0.3 * salinity / 37.0) * by_wavelength)


def zhang_scattering(
    *, wavelength: float, salinity: float, temperature: float, depolarisation: float = 0.039
) -> float:
    """Scattering of pure water and sea water, Zhang, Hu and He (2009) [1/m].

    Fluctuations of density and of salt, Optics Express 17, 5698; coefficients as in the authors'
    program.

    Parameters
    ----------
    wavelength : float
        In vacuum [m].
    salinity : float
        Practical salinity [1].
    temperature : float
        [K].
    depolarisation : float
        0.039 by Farinato and Rowell (1976) [1].

    Examples
    --------
    >>> water = {"wavelength": 532e-9, "temperature": 293.15}
    >>> [round(zhang_scattering(salinity=s, **water) * 1e3, 2) for s in (0.0, 35.0)]
    [1.51, 1.96]
    """
    index, index_by_salt = _index(wavelength, salinity, temperature)
    shape = (6.0 + 6.0 * depolarisation) / (6.0 - 7.0 * depolarisation)
    compressed = BOLTZMANN * temperature * _compressibility(salinity, temperature)
    density = 0.5 * pi**2 * compressed * _density_derivative(index) ** 2
    salt = salinity * MOLAR_MASS * index_by_salt**2 / AVOGADRO
    salt /= _density(salinity, temperature) * -_activity_by_salt(salinity, temperature)
    at_right_angle = (density + 2.0 * pi**2 * index**2 * salt) * shape / wavelength**4
    return 8.0 * pi / 3.0 * at_right_angle * (2.0 + depolarisation) / (1.0 + depolarisation)


def _index(wavelength: float, salinity: float, temperature: float) -> tuple[float, float]:
    """Index in vacuum and its derivative by salinity, Quan and Fry (1995), air by Ciddor (1996)."""
    nm, t = wavelength / NM, temperature - ZERO_CELSIUS
    wavenumber = (1e3 / nm) ** 2
    air = 1.0 + (5792105.0 / (238.0185 - wavenumber) + 167917.0 / (57.362 - wavenumber)) * 1e-8
    by_salt = 1.779e-4 - 1.05e-6 * t + 1.6e-8 * t**2 + 0.01155 / nm
    fresh = (
        1.31405 - 2.02e-6 * t**2 + (15.868 - 0.00423 * t) / nm - 4382.0 / nm**2 + 1.1455e6 / nm**3
    )
    return (fresh + by_salt * salinity) * air, by_salt * air


def _density_derivative(index: float) -> float:
    """Derivative of n^2 by the logarithm of density, Proutiere, Megnassan and Hucteau (1992)."""
    square = index**2
    return (square - 1.0) * (
        1.0 + 2.0 / 3.0 * (square + 2.0) * (index / 3.0 - 1.0 / (3.0 * index)) ** 2
    )


def _compressibility(salinity: float, temperature: float) -> float:
    """Isothermal compressibility, Millero et al. (1980) [1/Pa]."""
    t = temperature - ZERO_CELSIUS
    pure = 19652.21 + 148.4206 * t - 2.327105 * t**2 + 1.360477e-2 * t**3 - 5.155288e-5 * t**4
    by_salt = 54.6746 - 0.603459 * t + 1.09987e-2 * t**2 - 6.167e-5 * t**3
    by_root = 7.944e-2 + 1.6483e-2 * t - 5.3009e-4 * t**2
    return 1e-5 / (pure + by_salt * salinity + by_root * salinity * sqrt(salinity))


def _density(salinity: float, temperature: float) -> float:
    """Density, UNESCO 38 (1981) [kg/m3]."""
    t = temperature - ZERO_CELSIUS
    pure = 999.842594 + 6.793952e-2 * t - 9.09529e-3 * t**2 + 1.001685e-4 * t**3
    pure += -1.120083e-6 * t**4 + 6.536332e-9 * t**5
    by_salt = 8.24493e-1 - 4.0899e-3 * t + 7.6438e-5 * t**2 - 8.2467e-7 * t**3 + 5.3875e-9 * t**4
    by_root = -5.72466e-3 + 1.0227e-4 * t - 1.6546e-6 * t**2
    by_salt += by_root * sqrt(salinity) + 4.8314e-4 * salinity
    return pure + by_salt * salinity


def _activity_by_salt(salinity: float, temperature: float) -> float:
    """Derivative of the logarithm of water's activity by salinity, Millero and Leung."""
    t = temperature - ZERO_CELSIUS
    first = -5.58651e-4 + 2.40452e-7 * t - 3.12165e-9 * t**2 + 2.40808e-11 * t**3
    root = 1.79613e-5 - 9.9422e-8 * t + 2.08919e-9 * t**2 - 1.39872e-11 * t**3
    second = -2.31065e-6 - 1.37674e-9 * t - 1.93316e-11 * t**2
    return first + 1.5 * root * sqrt(salinity) + 2.0 * second * salinity

"""What is in the water beside itself: particles with chlorophyll, yellow substance."""

from __future__ import annotations

from math import exp, log10

from survey.optics.water.spectra import NM, tabled

MG_M3 = 1e-6  # kg/m3, in which the formulas take chlorophyll
GORDON_MOREL_FACTOR = 0.30
# From memory, no source seen: spread of the factor in oceanic (Case 1) waters, Gordon and Morel.
GORDON_MOREL_SPREAD = (0.12, 0.45)
YELLOW_SLOPE = 0.014 / NM
YELLOW_SHARE = 0.2


def bricaud_absorption(*, wavelength: float, chlorophyll: float) -> float:
    """Absorption of particles that go with chlorophyll, Bricaud et al. (1998): A C^E [1/m].

    Algae and what comes with them in oceanic waters; measured from 0.02 to 25 mg/m3 of chlorophyll
    (range from memory, no source seen).

    Parameters
    ----------
    wavelength : float
        400 to 700 nm [m].
    chlorophyll : float
        Concentration C [kg/m3].

    Raises
    ------
    ValueError
        When the wavelength lies outside the table.

    Examples
    --------
    >>> round(bricaud_absorption(wavelength=440e-9, chlorophyll=1e-6), 4)
    0.052
    """
    factor = tabled("bricaud_1998.csv", 1, wavelength=wavelength)
    exponent = tabled("bricaud_1998.csv", 2, wavelength=wavelength)
    return float(factor * (chlorophyll / MG_M3) ** exponent)


def yellow_absorption(*, wavelength: float, at_440: float, slope: float = YELLOW_SLOPE) -> float:
    """Absorption of yellow substance, Bricaud, Morel and Prieur (1981): a(440) exp(-S d) [1/m].

    Parameters
    ----------
    wavelength : float
        d is its distance from 440 nm [m].
    at_440 : float
        Absorption at 440 nm [1/m].
    slope : float
        S, by default 0.014 1/nm, their mean [1/m].

    Examples
    --------
    >>> round(yellow_absorption(wavelength=532e-9, at_440=1.0), 3)
    0.276
    """
    return at_440 * exp(-slope * (wavelength - 440 * NM))


def covarying_yellow_absorption(*, wavelength: float, chlorophyll: float) -> float:
    """Absorption of yellow substance where it goes with chlorophyll [1/m].

    At 440 nm a fifth of that of the particles: Prieur and Sathyendranath (1981) as Mobley's
    Ocean Optics Web Book states it, with `bricaud_absorption` for the particles.

    Examples
    --------
    >>> round(covarying_yellow_absorption(wavelength=440e-9, chlorophyll=1e-6), 4)
    0.0104
    """
    particles = bricaud_absorption(wavelength=440 * NM, chlorophyll=chlorophyll)
    return yellow_absorption(wavelength=wavelength, at_440=YELLOW_SHARE * particles)


def particle_scattering(*, wavelength: float, at_550: float) -> float:
    """Scattering of particles, going with 1 / wavelength as Gordon and Morel (1983) take it [1/m].

    Examples
    --------
    >>> round(particle_scattering(wavelength=532e-9, at_550=0.3), 4)
    0.3102
    """
    return at_550 * 550 * NM / wavelength


def gordon_morel_scattering(
    *, wavelength: float, chlorophyll: float, factor: float = GORDON_MOREL_FACTOR
) -> float:
    """Scattering of particles by chlorophyll, Gordon and Morel (1983) [1/m].

    b = 0.30 C^0.62 (550 nm / wavelength).

    Parameters
    ----------
    wavelength : float
        [m].
    chlorophyll : float
        Concentration C [kg/m3].
    factor : float
        0.30 on average; more where sediment is in the water [1/m at 1 mg/m3].

    Examples
    --------
    >>> round(gordon_morel_scattering(wavelength=550e-9, chlorophyll=10e-6), 3)
    1.251
    """
    at_550 = factor * (chlorophyll / MG_M3) ** 0.62
    return particle_scattering(wavelength=wavelength, at_550=at_550)


def loisel_morel_scattering(*, wavelength: float, chlorophyll: float) -> float:
    """Scattering of particles by chlorophyll, Loisel and Morel (1998) [1/m].

    b = 0.416 C^0.766 (wavelength / 550 nm)^v, with Morel and Maritorena's (2001) exponent:
    v = (log10 C - 0.3) / 2 below 2 mg/m3, 0 above.

    Parameters
    ----------
    wavelength : float
        [m].
    chlorophyll : float
        Concentration C [kg/m3].

    Examples
    --------
    >>> round(loisel_morel_scattering(wavelength=550e-9, chlorophyll=1e-6), 3)
    0.416
    """
    concentration = chlorophyll / MG_M3
    if concentration == 0.0:
        return 0.0
    exponent = 0.5 * min(log10(concentration) - 0.3, 0.0)
    return float(0.416 * concentration**0.766 * (wavelength / (550 * NM)) ** exponent)

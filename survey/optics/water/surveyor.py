"""From what surveyors measure to a water: the one-parameter mixture that would have shown it.

One figure cannot give both absorption and scattering. The mixtures of `OneParameterWaters` stand
for the rest; each figure's own relation carries a spread, from clear ("low") to turbid ("high").
"""

from __future__ import annotations

from collections.abc import Callable
from math import exp, log
from typing import Literal

from survey.optics.water.apparent import (
    austin_petzold_attenuation,
    kirk_turbidity_scattering,
    lee_diffuse_attenuation,
    lee_reflectance,
    lee_secchi_depth,
    tyler_secchi_depth,
)
from survey.optics.water.constituents import MG_M3
from survey.optics.water.mixing import OneParameterWaters
from survey.optics.water.spectra import NM

Estimate = Literal["low", "central", "high"]
SecchiRelation = Literal["tyler", "lee"]

# Smallest constant: used with satellites (validated around Korea); largest: Holmes (1970), from
# memory, no source seen.
SECCHI_COUPLINGS = {"low": 6.0, "central": 8.69, "high": 9.42}
# Depth seen over depth computed; 18 % is Lee et al.'s mean difference, from memory, no source seen.
LEE_SECCHI_RATIOS = {"low": 1.0 / 1.18, "central": 1.0, "high": 1.18}
# K_d by radiative transfer over Lee's formula: its largest error. The scatter of Austin and
# Petzold's regression is not in it: no source seen.
KD_RATIOS = {"low": 0.88, "central": 1.0, "high": 1.12}
# What a nephelometer sees at 90 degrees, per scattering: the average particle over functions of
# Fournier and Forand with b_b / b = 0.03 and 0.01 (computed here, tested).
TURBIDITY_RATIOS = {"low": 0.66, "central": 1.0, "high": 1.82}

CHLOROPHYLL_RANGE = (0.001 * MG_M3, 1000.0 * MG_M3)
EYE = 555 * NM
LEE_WAVELENGTHS = tuple(nm * NM for nm in (443, 488, 532, 555, 665))


def chlorophyll_of_secchi_depth(
    depth: float,
    *,
    waters: OneParameterWaters,
    sun_zenith: float,
    relation: SecchiRelation = "tyler",
    estimate: Estimate = "central",
) -> float:
    """Return the chlorophyll of the mixture in which a Secchi disk vanishes at a depth [kg/m3].

    Parameters
    ----------
    depth : float
        [m].
    waters : OneParameterWaters
    sun_zenith : float
        While it was read [rad].
    relation : {"tyler", "lee"}
        `tyler_secchi_depth` at 555 nm or `lee_secchi_depth` at the clearest of five wavelengths.
    estimate : {"low", "central", "high"}

    Raises
    ------
    ValueError
        When no such mixture has that depth.

    Examples
    --------
    >>> from survey.optics.phase import average_particle
    >>> waters = OneParameterWaters(
    ...     salinity=35.0, temperature=293.15, particles=average_particle())
    >>> found = chlorophyll_of_secchi_depth(10.0, waters=waters, sun_zenith=0.5)
    >>> round(found / MG_M3, 1)
    3.3
    """

    def tyler(chlorophyll: float) -> float:
        mixture = waters.mixture(wavelength=EYE, chlorophyll=chlorophyll)
        return tyler_secchi_depth(
            attenuation=mixture.attenuation,
            diffuse_attenuation=_attenuation(waters, EYE, chlorophyll, sun_zenith),
            coupling=SECCHI_COUPLINGS[estimate],
        )

    def lee(chlorophyll: float) -> float:
        least, clearest = min(
            (_attenuation(waters, at, chlorophyll, sun_zenith), at) for at in LEE_WAVELENGTHS
        )
        mixture = waters.mixture(wavelength=clearest, chlorophyll=chlorophyll)
        reflectance = lee_reflectance(
            absorption=mixture.absorption, backscattering=mixture.backscattering
        )
        computed = lee_secchi_depth(diffuse_attenuation=least, reflectance=reflectance)
        return LEE_SECCHI_RATIOS[estimate] * computed

    predicted = tyler if relation == "tyler" else lee
    return _chlorophyll(predicted, depth, "a Secchi depth of {:.3g} m", estimate)


def chlorophyll_of_kd_490(
    kd_490: float,
    *,
    wavelength: float,
    waters: OneParameterWaters,
    sun_zenith: float,
    estimate: Estimate = "central",
) -> float:
    """Return the chlorophyll of the mixture with a measured K_d(490) [kg/m3].

    The figure is taken to the laser's wavelength by `austin_petzold_attenuation`, so that the
    water has the K_d that matters there.

    Parameters
    ----------
    kd_490 : float
        [1/m].
    wavelength : float
        Of the laser [m].
    waters : OneParameterWaters
    sun_zenith : float
        While it was measured [rad].
    estimate : {"low", "central", "high"}

    Raises
    ------
    ValueError
        When no such mixture has that attenuation.
    """

    def predicted(chlorophyll: float) -> float:
        computed = _attenuation(waters, wavelength, chlorophyll, sun_zenith)
        return computed / KD_RATIOS[estimate]

    wanted = austin_petzold_attenuation(kd_490=kd_490, wavelength=wavelength)
    what = f"K_d(490) of {kd_490:g} 1/m, at {wavelength / NM:g} nm {{:.3g}} 1/m,"
    return _chlorophyll(predicted, wanted, what, estimate)


def chlorophyll_of_turbidity(
    turbidity: float, *, waters: OneParameterWaters, estimate: Estimate = "central"
) -> float:
    """Return the chlorophyll of the mixture with a measured turbidity [NTU], in kg/m3.

    Scattering at 550 nm by `kirk_turbidity_scattering`.

    Raises
    ------
    ValueError
        When no such mixture has that turbidity.
    """
    per_ntu = kirk_turbidity_scattering(turbidity=1.0, ratio=TURBIDITY_RATIOS[estimate])

    def predicted(chlorophyll: float) -> float:
        mixture = waters.mixture(wavelength=550 * NM, chlorophyll=chlorophyll)
        particles = mixture.components[1]
        return particles.scattering / per_ntu

    return _chlorophyll(predicted, turbidity, "a turbidity of {:.3g} NTU", estimate)


def _attenuation(
    waters: OneParameterWaters, wavelength: float, chlorophyll: float, sun_zenith: float
) -> float:
    mixture = waters.mixture(wavelength=wavelength, chlorophyll=chlorophyll)
    return lee_diffuse_attenuation(
        absorption=mixture.absorption, backscattering=mixture.backscattering, sun_zenith=sun_zenith
    )


def _chlorophyll(
    predicted: Callable[[float], float], figure: float, what: str, estimate: Estimate
) -> float:
    """Return where a monotonous prediction by chlorophyll meets a figure.

    An end of the spread that no water reaches, such as less than pure water, is the last water.
    """
    from scipy.optimize import brentq

    first, last = (predicted(end) for end in CHLOROPHYLL_RANGE)
    low, high = sorted((first, last))
    if not low <= figure <= high:
        if estimate == "central":
            raise ValueError(f"{what.format(figure)} lies outside {low:.3g} to {high:.3g}")
        return CHLOROPHYLL_RANGE[0 if abs(figure - first) < abs(figure - last) else 1]
    clear, turbid = (log(end) for end in CHLOROPHYLL_RANGE)
    met = brentq(lambda x: predicted(exp(float(x))) - figure, clear, turbid, xtol=1e-9)
    return exp(float(met))

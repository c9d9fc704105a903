"""Phase function of Fournier and Forand: hyperbolically distributed particles."""

from __future__ import annotations

import numpy as np

from survey.optics.phase.function import FloatArray, PhaseFunction

INDEX_LIMITS = (1.001, 1.35)
SLOPE_LIMITS = (3.01, 4.99)
# [Mobley2002]: index that goes with a slope, n = 1.01 + 0.1542 (mu - 3).
FAMILY_INDEX, FAMILY_GRADIENT = 1.01, 0.1542
# Half the width in 1 - D of the neighbourhood of D = 1 where a series stands for 0 / 0.
SERIES_REACH = 1e-4


def fournier_forand(*, particle_index: float, size_slope: float) -> PhaseFunction:
    """Fournier and Forand (1994) in the form of Fournier and Jonasz (1999).

    With nu = (3 - mu) / 2, s = sin^2(angle / 2), D = 4 s / [3 (n - 1)^2], D180 = D at s = 1::

        P = {nu (1 - D) - (1 - D^nu) + [D (1 - D^nu) - nu (1 - D)] / s} / [4 pi (1 - D)^2 D^nu]
            + (1 - D180^nu) (3 cos^2 - 1) / [16 pi (D180 - 1) D180^nu]

    Parameters
    ----------
    particle_index : float
        Real refractive index n of the particles over that of water, 1.001 to 1.35 [1].
    size_slope : float
        Exponent mu of the number of particles by size, 3.01 to 4.99 [1].

    Raises
    ------
    ValueError
        When an argument lies outside its range.

    Examples
    --------
    >>> phase = fournier_forand(particle_index=1.10, size_slope=3.5835)
    >>> round(phase.backscatter_fraction, 4)
    0.0183
    """
    _require(particle_index=particle_index, size_slope=size_slope)
    # Towards zero angle P goes as D^(-nu) / s, which is the angle to the power mu - 5.
    return PhaseFunction.from_function(
        name=f"Fournier-Forand n = {particle_index:.4f}, mu = {size_slope:.4f}",
        function=lambda angle: _density(angle, particle_index, size_slope),
        small_angle_slope=size_slope - 5.0,
    )


def fournier_forand_of_backscatter(backscatter_fraction: float) -> PhaseFunction:
    """Fournier and Forand's function with a given b_b / b, Mobley, Sundman and Boss (2002).

    Of the pairs (n, mu) with that backscatter fraction, the one on n = 1.01 + 0.1542 (mu - 3).

    Raises
    ------
    ValueError
        When no slope of 3.01 to 4.99 gives that fraction.

    Examples
    --------
    >>> fournier_forand_of_backscatter(0.0134).name
    'Fournier-Forand n = 1.0905, mu = 3.5222'
    """

    from scipy.optimize import brentq

    def excess(slope: float) -> float:
        return _of_slope(slope) - backscatter_fraction

    low, high = backscatter_reach()
    if not low <= backscatter_fraction <= high:
        raise ValueError(
            f"backscatter_fraction = {backscatter_fraction:g}: must lie in {low:.2g} to {high:.2g}"
        )
    slope = float(
        brentq(lambda mu: _of_slope(mu) - backscatter_fraction, *SLOPE_LIMITS, xtol=1e-12)
    )
    return fournier_forand(particle_index=_family_index(slope), size_slope=slope)


def backscatter_reach() -> tuple[float, float]:
    """Return the least and greatest b_b / b that a slope of 3.01 to 4.99 gives [1]."""
    low, high = (_of_slope(slope) for slope in SLOPE_LIMITS)
    return low, high


def _of_slope(slope: float) -> float:
    return closed_backscatter_fraction(particle_index=_family_index(slope), size_slope=slope)


def closed_backscatter_fraction(*, particle_index: float, size_slope: float) -> float:
    """Return b_b / b of the formula, Fournier and Jonasz (1999), D90 being D at 90 degrees [1]::

        B = 1 - [1 - D90^(nu + 1) - (1 - D90^nu) / 2] / [(1 - D90) D90^nu]

    Examples
    --------
    >>> round(closed_backscatter_fraction(particle_index=1.10, size_slope=3.5835), 4)
    0.0183
    """
    nu = 0.5 * (3.0 - size_slope)
    d90 = 2.0 / (3.0 * (particle_index - 1.0) ** 2)
    ahead = 1.0 - d90 ** (nu + 1.0) - 0.5 * (1.0 - d90**nu)
    return float(1.0 - ahead / ((1.0 - d90) * d90**nu))


def _family_index(size_slope: float) -> float:
    return FAMILY_INDEX + FAMILY_GRADIENT * (size_slope - 3.0)


def _density(angle: FloatArray, n: float, mu: float) -> FloatArray:
    nu = 0.5 * (3.0 - mu)
    s = np.sin(0.5 * angle) ** 2
    d, d180 = 4.0 * s / (3.0 * (n - 1.0) ** 2), 4.0 / (3.0 * (n - 1.0) ** 2)
    wide = (1.0 - d180**nu) * (3.0 * np.cos(angle) ** 2 - 1.0)
    return np.asarray(
        _bracket(d, s, nu) / (4.0 * np.pi * d**nu) + wide / (16.0 * np.pi * (d180 - 1.0) * d180**nu)
    )


def _bracket(d: FloatArray, s: FloatArray, nu: float) -> FloatArray:
    """Return {nu (1 - D) - ... } / (1 - D)^2, by its series to first order close to D = 1."""
    x = 1.0 - d
    near = np.abs(x) < SERIES_REACH
    apart = np.where(near, 1.0, x)
    power = 1.0 - d**nu
    exact = (nu * x - power + (d * power - nu * x) / s) / apart**2
    second, third = nu * (nu - 1.0) / 2.0, nu * (nu - 1.0) * (nu - 2.0) / 6.0
    series = second - third * x + (-second - nu + (second + third) * x) / s
    return np.where(near, series, exact)


def _require(*, particle_index: float, size_slope: float) -> None:
    faults = [
        f"{name} = {value:g}: must lie in {low:g} to {high:g}"
        for name, value, (low, high) in (
            ("particle_index", particle_index, INDEX_LIMITS),
            ("size_slope", size_slope, SLOPE_LIMITS),
        )
        if not low <= value <= high
    ]
    if faults:
        raise ValueError("\n".join(faults))

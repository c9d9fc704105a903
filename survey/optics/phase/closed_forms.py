"""Phase functions with a short formula: Henyey and Greenstein, molecules of sea water."""

from __future__ import annotations

import numpy as np

from survey.optics.phase.function import FloatArray, PhaseFunction

# Beyond these a peak is narrower than the grid of angles resolves.
ASYMMETRY_LIMITS = (-0.98, 0.99999)
ZHANG_DEPOLARISATION = 0.039
MOREL_DEPOLARISATION = 0.09


def henyey_greenstein(asymmetry: float) -> PhaseFunction:
    """Henyey and Greenstein (1941): (1 - g^2) / [4 pi (1 + g^2 - 2 g cos)^(3/2)].

    For benchmarks only: with the g of sea water it has 1-2 % of the forward peak.

    Raises
    ------
    ValueError
        When the asymmetry lies outside -0.98 to 0.99999.

    Examples
    --------
    >>> round(henyey_greenstein(0.75).mean_cosine, 5)
    0.75
    """
    _require(_asymmetry_faults(asymmetry=asymmetry))
    return PhaseFunction.from_function(
        name=f"Henyey-Greenstein g = {asymmetry}",
        function=lambda angle: _henyey_greenstein(angle, asymmetry),
        small_angle_slope=0.0,
    )


def two_term_henyey_greenstein(
    *, forward_share: float, forward_asymmetry: float, backward_asymmetry: float
) -> PhaseFunction:
    """Sum of two functions of Henyey and Greenstein, Kattawar (1975): s P(g1) + (1 - s) P(g2).

    Parameters
    ----------
    forward_share : float
        Weight s of the first, 0 to 1 [1].
    forward_asymmetry, backward_asymmetry : float
        g1 and g2, the second below 0 for a peak in the backward direction [1].

    Raises
    ------
    ValueError
        When the share lies outside 0 to 1 or an asymmetry outside -0.98 to 0.99999.

    Examples
    --------
    >>> phase = two_term_henyey_greenstein(
    ...     forward_share=0.97, forward_asymmetry=0.93, backward_asymmetry=-0.4)
    >>> round(phase.mean_cosine, 4)
    0.8901
    """
    faults = _asymmetry_faults(
        forward_asymmetry=forward_asymmetry, backward_asymmetry=backward_asymmetry
    )
    if not 0.0 <= forward_share <= 1.0:
        faults.append(f"forward_share = {forward_share:g}: must lie in 0 to 1")
    _require(faults)

    def shape(angle: FloatArray) -> FloatArray:
        first = _henyey_greenstein(angle, forward_asymmetry)
        second = _henyey_greenstein(angle, backward_asymmetry)
        return forward_share * first + (1.0 - forward_share) * second

    return PhaseFunction.from_function(
        name=f"Henyey-Greenstein {forward_share} g = {forward_asymmetry}, {backward_asymmetry}",
        function=shape,
        small_angle_slope=0.0,
    )


def molecular(depolarisation: float = ZHANG_DEPOLARISATION) -> PhaseFunction:
    """Scattering by water itself: 3 [1 + d + (1 - d) cos^2] / [8 pi (2 + d)].

    Einstein's and Smoluchowski's fluctuations as Morel (1974) writes them.

    Parameters
    ----------
    depolarisation : float
        d, 0 to 1: 0.039 for sea water by Zhang, Hu and He (2009), 0.09 by Morel (1974), 0 for the
        3 (1 + cos^2) / (16 pi) of Rayleigh [1].

    Raises
    ------
    ValueError
        When the depolarisation lies outside 0 to 1.

    Examples
    --------
    >>> round(float(molecular(0.0).density(0.0) * 16 * 3.14159265 / 3), 5)
    2.0
    """
    d = depolarisation
    if not 0.0 <= d <= 1.0:
        raise ValueError(f"depolarisation = {d:g}: must lie in 0 to 1")

    def shape(angle: FloatArray) -> FloatArray:
        density: FloatArray = 3 * (1 + d + (1 - d) * np.cos(angle) ** 2) / (8 * np.pi * (2 + d))
        return density

    return PhaseFunction.from_function(
        name=f"molecular, depolarisation {d}", function=shape, small_angle_slope=0.0
    )


def _henyey_greenstein(angle: FloatArray, g: float) -> FloatArray:
    # 1 + g^2 - 2 g cos, written so that a narrow peak keeps its digits.
    distance = (1.0 - g) ** 2 + 4.0 * g * np.sin(0.5 * angle) ** 2
    return np.asarray((1.0 - g * g) / (4.0 * np.pi * distance**1.5))


def _asymmetry_faults(**asymmetries: float) -> list[str]:
    low, high = ASYMMETRY_LIMITS
    return [
        f"{name} = {value:g}: must lie in {low:g} to {high:g}"
        for name, value in asymmetries.items()
        if not low <= value <= high
    ]


def _require(faults: list[str]) -> None:
    if faults:
        raise ValueError("\n".join(faults))

"""Charge of multiplied photo-electrons: the noise of the gain, and that of the amplifier."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.constants import e as elementary_charge

FloatArray = NDArray[np.float64]


def quick(chance: np.random.Generator) -> np.random.Generator:
    """Return a generator that draws twice as fast, seeded from an addressed one."""
    return np.random.Generator(np.random.SFC64(chance.integers(1 << 63)))


def multiplied(
    electrons: NDArray[np.int64], *, gain_variance: float, chance: np.random.Generator
) -> FloatArray:
    """Return the charge that electrons make, in units of the mean gain.

    Departure: the gain of an electron follows a gamma distribution, with the mean and the variance
    of the true one; sums of it are drawn in one go.

    Parameters
    ----------
    electrons : array of int
        Electrons before multiplication.
    gain_variance : float
        Variance of one gain over its squared mean, F - 1 [1].
    chance : Generator

    Examples
    --------
    >>> chance = np.random.default_rng(1)
    >>> charge = multiplied(np.full(100_000, 4), gain_variance=1.5, chance=chance)
    >>> round(charge.mean()), round(charge.var())  # 4, and 4 x 1.5
    (4, 6)
    """
    charge = electrons.astype(np.float64)
    if gain_variance > 0.0:
        some = electrons > 0
        charge[some] = chance.standard_gamma(charge[some] / gain_variance) * gain_variance
    return charge


def amplifier_variance(*, noise_current: float, gain: float, time: float) -> float:
    """Variance of the charge that an amplifier's white noise adds, in photo-electrons squared [1].

    A one-sided density i_n over a time T integrates to i_n^2 T / 2, long against 1 / bandwidth.

    Parameters
    ----------
    noise_current : float
        i_n at the amplifier's input [A/sqrt(Hz)].
    gain : float
        Electrons per photo-electron [1].
    time : float
        T [s].

    Examples
    --------
    >>> round(amplifier_variance(noise_current=2e-12, gain=100.0, time=1e-9) ** 0.5, 2)
    2.79
    """
    return (noise_current / (elementary_charge * gain)) ** 2 * time / 2.0

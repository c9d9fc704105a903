"""Photon counting after [Lisenko2017], equations (8) to (11), and the inverses of (11).

[Lisenko2017]: A. A. Lisenko, A. I. Potekaev, V. S. Shamanaev, Russian Physics Journal (2017).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import erfc, gammaincinv, gammaln, pdtrc, xlogy
from scipy.stats import norm

FloatArray = NDArray[np.float64]

STIRLING_FROM = 16.0
CROWDED_FROM = 1e4  # counts from which Temme's expansion is exact to 1e-10 near the threshold
NEWTON_STEPS = 4
NEAR = 0.1  # how near, as a share of the threshold


def photo_electron_rate(*, power: Any, quantum_efficiency: float, photon_energy: float) -> Any:
    """Photo-electrons per second n_s = eta P_s / (h nu), equation (8) of [Lisenko2017] [1/s].

    Parameters
    ----------
    power : float or array
        P_s, power on the detector [W], not below 0.
    quantum_efficiency : float
        eta, above 0 and at most 1 [1].
    photon_energy : float
        h nu, above 0 [J].

    Raises
    ------
    ValueError
        When an argument is out of bounds.

    Examples
    --------
    >>> round(photo_electron_rate(power=3.7e-12, quantum_efficiency=0.5, photon_energy=3.7e-19))
    5000000
    """
    _require(np.all(np.asarray(power) >= 0.0), "power is below 0 W")
    _require(0.0 < quantum_efficiency <= 1.0, "quantum_efficiency is not above 0 and at most 1")
    _require(photon_energy > 0.0, "photon_energy is not above 0 J")
    return quantum_efficiency * power / photon_energy


def count_probability(*, count: Any, mean: Any) -> Any:
    """Probability w(n, n_s) of exactly n counts, equation (9) of [Lisenko2017] [1].

    The printed n_s^n exp(-n_s) / n! after Loader (2000), "Fast and accurate computation of
    binomial probabilities", which keeps its digits at large n: 10 at a thousand million.

    Parameters
    ----------
    count : int or array
        n, not below 0.
    mean : float or array
        n_s, the mean count, not below 0 [1].

    Examples
    --------
    >>> [f"{count_probability(count=2, mean=mean):.6e}" for mean in (1e-6, 2.0)]
    ['4.999995e-13', '2.706706e-01']
    >>> f"{count_probability(count=10**9, mean=1e9):.9e}"
    '1.261566261e-05'
    """
    n, mean = np.broadcast_arrays(np.asarray(count, np.float64), np.asarray(mean, np.float64))
    _require(np.all(n >= 0.0), "count is below 0")
    _require(np.all(mean >= 0.0), "mean is below 0")
    many = np.maximum(n, STIRLING_FROM)
    with np.errstate(divide="ignore"):
        excess = (mean - many) / many
        growth = np.where(excess > -0.5, np.log1p(excess), np.log(mean / many))
    deviance = many * (excess - growth)
    body = np.exp(-deviance - _stirling_error(many)) / np.sqrt(2.0 * np.pi * many)
    direct = np.exp(xlogy(n, mean) - mean - gammaln(n + 1.0))
    return np.where(n < STIRLING_FROM, direct, body)[()]


def _stirling_error(n: FloatArray) -> FloatArray:
    """Return ln n! less Stirling's n ln n - n + ln(2 pi n) / 2, for n from 16."""
    inverse = 1.0 / n
    square = inverse * inverse
    return inverse * (
        1.0 / 12.0 - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square / 1680.0))
    )


def signal_to_noise(*, signal: Any, background: Any, internal: Any, time: float) -> Any:
    """Ratio of powers n_s^2 tau_g / (n_s + n_b + n_n), equation (10) of [Lisenko2017] [1].

    10 means 3.2 in amplitude.

    Parameters
    ----------
    signal, background, internal : float or array
        n_s, n_b and n_n: photo-electrons of signal, background and internal noise, not below 0
        and not all of them 0 [1/s].
    time : float
        tau_g, the measuring time, above 0 [s].

    Examples
    --------
    >>> float(signal_to_noise(signal=2e9, background=1.9e9, internal=1e8, time=1e-8))
    10.0
    """
    rates = [np.asarray(rate, np.float64) for rate in (signal, background, internal)]
    _require(all(np.all(rate >= 0.0) for rate in rates), "a rate is below 0 per second")
    _require(bool(np.all(sum(rates) > 0.0)), "there is neither signal nor noise")
    _require(time > 0.0, "time is not above 0 s")
    return rates[0] ** 2 * time / sum(rates)


def firing_probability(*, threshold: Any, mean: Any) -> Any:
    """Probability w(n >= n_L, n_s) of reaching a threshold, equation (11) of [Lisenko2017] [1].

    Parameters
    ----------
    threshold : int or array
        n_L, whole and at least 1.
    mean : float or array
        n_s, the mean count, not below 0 [1].

    Examples
    --------
    >>> round(float(firing_probability(threshold=1, mean=0.5)), 6)
    0.393469
    """
    threshold = np.asarray(threshold, np.float64)
    _require(bool(np.all(threshold >= 1.0)), "threshold is below 1")
    _require(bool(np.all(np.asarray(mean) >= 0.0)), "mean is below 0")
    return _reached(threshold, np.asarray(mean, np.float64))[()]


def _reached(threshold: FloatArray, mean: FloatArray) -> FloatArray:
    """Return w(n >= n_L): scipy's, and Temme's where its series for large counts falls short.

    Over 10^6 counts that series stops before it has converged, further than 4.5 standard
    deviations out, and gives too little: at 10^9 counts a quarter.
    """
    threshold, mean = np.broadcast_arrays(threshold, mean)
    crowded = (threshold > CROWDED_FROM) & (np.abs(mean - threshold) < NEAR * threshold)
    result = np.empty(threshold.shape)
    result[~crowded] = pdtrc(threshold[~crowded] - 1.0, mean[~crowded])
    result[crowded] = _temme(threshold[crowded], mean[crowded])
    return result


def _temme(a: FloatArray, x: FloatArray) -> FloatArray:
    """Return the incomplete gamma function P(a, x) for large a and x near it.

    N. M. Temme, SIAM Journal on Mathematical Analysis 10, 757 (1979).
    """
    excess = (x - a) / a
    eta = np.sign(excess) * np.sqrt(2.0 * np.maximum(excess - np.log1p(excess), 0.0))
    first = np.polynomial.polynomial.polyval(eta, (-1 / 3, 1 / 12, -2 / 135, 1 / 864, 1 / 2835))
    second = np.polynomial.polynomial.polyval(eta, (-1 / 540, -1 / 288, 1 / 378))
    rest = np.exp(-0.5 * a * eta**2) / np.sqrt(2.0 * np.pi * a) * (first + second / a)
    return np.asarray(0.5 * erfc(-eta * np.sqrt(0.5 * a)) - rest)


def firing_threshold(*, false_alarm: float, noise: Any) -> FloatArray:
    """Smallest n_L that noise alone reaches with at most this probability, from equation (11).

    Parameters
    ----------
    false_alarm : float
        Probability, above 0 and below 1 [1].
    noise : float or array
        Mean counts of the noise, not below 0 [1].

    Examples
    --------
    >>> firing_threshold(false_alarm=1e-3, noise=np.array([0.01, 1.0, 1e9])).tolist()
    [2.0, 6.0, 1000097724.0]
    """
    _require(0.0 < false_alarm < 1.0, "false_alarm is not above 0 and below 1")
    mean = np.atleast_1d(np.asarray(noise, np.float64))
    _require(bool(np.all(mean >= 0.0)), "noise is below 0")
    values, place = np.unique(mean, return_inverse=True)
    deviate = float(norm.isf(false_alarm))
    guess = values + deviate * np.sqrt(values) + (deviate**2 + 2.0) / 6.0
    threshold = np.maximum(1.0, np.ceil(guess))
    low = _reached(threshold, values) > false_alarm
    while low.any():
        threshold[low] += 1.0
        low[low] = _reached(threshold[low], values[low]) > false_alarm
    high = threshold > 1.0
    while high.any():
        high[high] = _reached(threshold[high] - 1.0, values[high]) <= false_alarm
        threshold[high] -= 1.0
        high &= threshold > 1.0
    return np.asarray(threshold[place].reshape(np.shape(noise)))


def least_signal(*, probability: Any, threshold: Any, noise: Any = 0.0) -> FloatArray:
    """Smallest mean signal n_s,min that is detected with a probability, from equation (11) [1].

    Parameters
    ----------
    probability : float or array
        Of reaching the threshold, above 0 and below 1 [1].
    threshold : int or array
        n_L, whole and at least 1.
    noise : float or array
        Mean counts of the noise that come on top, not below 0 [1].

    Examples
    --------
    >>> round(float(least_signal(probability=0.9, threshold=1)), 6)  # -ln 0.1
    2.302585
    """
    inside = (np.asarray(probability) > 0.0) & (np.asarray(probability) < 1.0)
    _require(bool(np.all(inside)), "probability is not above 0 and below 1")
    _require(bool(np.all(np.asarray(threshold) >= 1.0)), "threshold is below 1")
    _require(bool(np.all(np.asarray(noise) >= 0.0)), "noise is below 0")
    return np.asarray(np.maximum(_mean_reaching(threshold, probability) - noise, 0.0))


def _mean_reaching(threshold: Any, probability: Any) -> FloatArray:
    """Return the mean count that reaches a threshold so often: scipy's, mended by Newton."""
    threshold, probability = np.broadcast_arrays(threshold, probability)
    mean = np.asarray(gammaincinv(threshold, probability))
    many = threshold > CROWDED_FROM
    for _ in range(NEWTON_STEPS if many.any() else 0):
        reached = _reached(threshold[many] * 1.0, mean[many])
        slope = count_probability(count=threshold[many] - 1, mean=mean[many]) / reached
        mean[many] -= np.log(reached / probability[many]) / slope
    return mean


def _require(sound: Any, fault: str) -> None:
    if not sound:
        raise ValueError(fault)

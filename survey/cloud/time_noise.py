"""How late or early an echo is told by its counting noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

ALONE = 8.0 / (3.0 * np.sqrt(3.0))
OVER_NOISE = 4.0 * np.sqrt(np.pi) / np.sqrt(8.0 * np.log(2.0))


def time_noise(*, counts: FloatArray, snr: FloatArray, pulse_sigma: float) -> FloatArray:
    """Return the standard error of an echo's time by its counting noise [s].

    The crest of counts that are convolved with the pulse, Gaussian of deviation s, errs with
    s^2 8 / (3 sqrt 3) / N for N counts alone, and with 4 sqrt(pi) s^3 b / N^2 over a noise of
    variance b in a unit of time: quotients of the variance of the slope and the squared curvature
    at the crest. In a gate of one full width at half maximum B = 2.355 s b, hence 3.01 s^2 B / N^2.

    Parameters
    ----------
    counts, snr : array
        Of the echo: N, and N over the standard deviation of all counts in the gate [1].
    pulse_sigma : float
        Standard deviation of the pulse as the detector sees it [s].

    Examples
    --------
    >>> alone = time_noise(counts=np.array(400.0), snr=np.array(20.0), pulse_sigma=4e-9)
    >>> round(float(alone) * 1e9, 4)
    0.2482
    """
    counts, variance = np.maximum(counts, 1.0), (counts / np.maximum(snr, 0.1)) ** 2
    noise = np.maximum(variance - counts, 0.0)
    return np.asarray(pulse_sigma * np.sqrt(ALONE * counts + OVER_NOISE * noise) / counts)

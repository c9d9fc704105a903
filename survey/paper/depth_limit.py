"""The depth at which the signal-to-noise ratio falls below what is required."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from survey.paper import instrument
from survey.paper.receiver import PaperReceiver
from survey.sensor.photon_counting import signal_to_noise

FloatArray = NDArray[np.float64]


def limit_depth(*, depth: FloatArray, snr: FloatArray) -> float:
    """Return the depth below its peak where the ratio falls below 10 [m].

    Log-linear between depths; 0 where the peak itself is lower, the last depth where it stays
    higher.

    Examples
    --------
    >>> limit_depth(depth=np.array([0.0, 1.0, 2.0]), snr=np.array([1e3, 1e2, 1.0]))
    1.5
    """
    top = int(snr.argmax())
    if snr[top] <= instrument.REQUIRED_SNR:
        return 0.0
    below = np.flatnonzero(snr[top:] < instrument.REQUIRED_SNR)
    if not below.size:
        return float(depth[-1])
    low = top + int(below[0])
    high = np.log(snr[low - 1] / instrument.REQUIRED_SNR)
    drop = high - np.log(max(snr[low], np.finfo(float).tiny) / instrument.REQUIRED_SNR)
    return float(depth[low - 1] + (depth[low] - depth[low - 1]) * high / drop)


def column_limit(
    *, receiver: PaperReceiver, depth: FloatArray, column: FloatArray, brightness: float
) -> float:
    """Return the depth to which water-column backscatter exceeds the required ratio [m].

    Parameters
    ----------
    receiver : PaperReceiver
    depth, column : array (depths,)
        [m] and power per area of the aperture [W/m2].
    brightness : float
        L_b [W/(m2 um sr)].
    """
    snr = signal_to_noise(
        signal=receiver.signal_rate(column),
        background=receiver.background_rate(brightness),
        internal=instrument.INTERNAL_NOISE,
        time=instrument.MEASURING_TIME,
    )
    return limit_depth(depth=depth, snr=snr)

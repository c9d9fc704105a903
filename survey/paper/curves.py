"""Power and signal-to-noise ratio against depth, the curves of figures 1-3."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.paper import instrument
from survey.paper.light import Light
from survey.paper.receiver import PaperReceiver
from survey.sensor.photon_counting import signal_to_noise

FloatArray = NDArray[np.float64]

SHOWN_TO = 56.0


@dataclass(frozen=True, kw_only=True)
class Curves:
    """Panels (a) and (b) of a figure.

    Parameters
    ----------
    depth : array (depths,)
        [m].
    power, power_error : array (depths,)
        P(h) of surface, column and bottom, and its standard error [W].
    snr, snr_error : dict of array (depths,)
        Equation (10) by the sun's brightness [W/(m2 um sr)], a ratio of powers.
    """

    depth: FloatArray
    power: FloatArray
    power_error: FloatArray
    snr: dict[float, FloatArray]
    snr_error: dict[float, FloatArray]


def curves(light: Light, receiver: PaperReceiver, *, illumination: int) -> Curves:
    """Return the curves of one water under one illumination (FLOOD or ISOLATED)."""
    shown = light.depth < SHOWN_TO
    batches = light.total[:, illumination, shown]
    per_area, error = batches.mean(axis=0), batches.std(axis=0, ddof=1) / len(batches) ** 0.5
    signal = receiver.signal_rate(per_area)
    relative = error / np.maximum(per_area, np.finfo(float).tiny)
    snr, snr_error = {}, {}
    for brightness in instrument.BRIGHTNESSES:
        noise = receiver.background_rate(brightness)
        snr[brightness] = signal_to_noise(
            signal=signal,
            background=noise,
            internal=instrument.INTERNAL_NOISE,
            time=instrument.MEASURING_TIME,
        )
        snr_error[brightness] = snr[brightness] * (2.0 - signal / (signal + noise)) * relative
    return Curves(
        depth=light.depth[shown],
        power=per_area * receiver.aperture_area,
        power_error=error * receiver.aperture_area,
        snr=snr,
        snr_error=snr_error,
    )

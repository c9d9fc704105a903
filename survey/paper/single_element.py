"""The matrix against a lidar of one pixel: down to which depth each sees the bottom."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.paper import instrument
from survey.paper.depth_limit import limit_depth
from survey.paper.light import Light
from survey.paper.receiver import PaperReceiver
from survey.paper.verdict import buildable
from survey.sensor.photon_counting import signal_to_noise
from survey.transport.response_walks import FLOOD, ISOLATED

FloatArray = NDArray[np.float64]

MATRIX, MATRIX_BUILDABLE = "matrix", "matrix_buildable"
EQUAL_PULSE, EQUAL_AREA = "single_equal_pulse_energy", "single_equal_energy_per_area"


@dataclass(frozen=True, kw_only=True)
class Contender:
    """A lidar: its receiver, who lights a pixel, and how much of the pulse that pixel gets.

    Parameters
    ----------
    receiver : PaperReceiver
    illumination : int
        FLOOD or ISOLATED.
    energy : float
        Of a pixel over its share in the matrix [1].
    """

    receiver: PaperReceiver
    illumination: int
    energy: float


@dataclass(frozen=True, kw_only=True)
class Sight:
    """How well a lidar sees bottoms of one water.

    Parameters
    ----------
    optical_depth : array (depths,)
        c z of the bottom [1].
    snr, snr_error : dict of array (depths,)
        Equation (10) by sun: the echo's highest power over sun and column, and its standard error.
    contrast : array (depths,)
        Highest power of the echo over that of the column at the same depth [1].
    limit : dict
        c z by sun where the ratio falls below 10 [1].
    even : float or None
        c z where the echo falls below the column, if it does [1].
    """

    optical_depth: FloatArray
    snr: dict[str, FloatArray]
    snr_error: dict[str, FloatArray]
    contrast: FloatArray
    limit: dict[str, float]
    even: float | None


def contenders(fitted: PaperReceiver) -> dict[str, Contender]:
    """Return the matrix, with the fitted receiver and with one that can be built, and its rivals.

    The rivals have one pixel of the matrix, a beam as narrow as the pixel and the fitted receiver.
    """
    return {
        EQUAL_PULSE: Contender(
            receiver=fitted, illumination=ISOLATED, energy=float(instrument.PIXELS)
        ),
        MATRIX: Contender(receiver=fitted, illumination=FLOOD, energy=1.0),
        EQUAL_AREA: Contender(receiver=fitted, illumination=ISOLATED, energy=1.0),
        MATRIX_BUILDABLE: Contender(receiver=buildable(), illumination=FLOOD, energy=1.0),
    }


def compare(lights: Mapping[str, Light], fitted: PaperReceiver) -> dict[str, dict[str, Sight]]:
    """Return what each contender sees, by contender and water."""
    return {
        name: {water: sight(light, contender) for water, light in lights.items()}
        for name, contender in contenders(fitted).items()
    }


def sight(light: Light, contender: Contender) -> Sight:
    """Return how well a lidar sees the bottom of one water.

    The column counts as noise of a known mean, as if it went on below the bottom.
    """
    receiver, which = contender.receiver, contender.illumination
    attenuation = light.water.attenuation
    echoes = receiver.signal_rate(light.sweep_peak[:, which]) * contender.energy
    echo = echoes.mean(axis=0)
    column = receiver.signal_rate(_at_bottoms(light, which)) * contender.energy
    relative_error = echoes.std(axis=0, ddof=1) / len(echoes) ** 0.5 / np.maximum(echo, 1e-300)
    snr, error, limit = {}, {}, {}
    for sun, brightness in instrument.SUNS.items():
        noise = column + receiver.background_rate(brightness)
        snr[sun] = signal_to_noise(
            signal=echo,
            background=noise,
            internal=instrument.INTERNAL_NOISE,
            time=instrument.MEASURING_TIME,
        )
        error[sun] = snr[sun] * (2.0 - echo / (echo + noise)) * relative_error
        limit[sun] = attenuation * limit_depth(depth=light.sweep_depth, snr=snr[sun])
    contrast = echo / column
    return Sight(
        optical_depth=attenuation * light.sweep_depth,
        snr=snr,
        snr_error=error,
        contrast=contrast,
        limit=limit,
        even=None if np.all(contrast >= 1.0) else attenuation * _even(light, contrast),
    )


def sentences(sights: Mapping[str, Mapping[str, Sight]]) -> list[str]:
    """Return the outcome in two sentences."""
    waters = list(instrument.WATERS)

    limits = {
        name: np.array([sights[name][water].limit["day"] for water in waters]) for name in sights
    }
    depths = {name: _listed([f"{limit:.1f}" for limit in limits[name]]) for name in limits}
    by_pulse = _listed([f"{x:.0f}" for x in 100.0 * (limits[EQUAL_PULSE] / limits[MATRIX] - 1.0)])
    by_area = _listed([f"{x:.0f}" for x in 100.0 * (limits[MATRIX] / limits[EQUAL_AREA] - 1.0)])
    return [
        f"At equal pulse energy, all of it in one pixel, a single-element lidar with the fitted "
        f"receiver sees the bottom by day to c z = {depths[EQUAL_PULSE]} in {_listed(waters)}, the "
        f"flooding matrix to {depths[MATRIX]}: for its 2,048 places a pulse the matrix leaves the "
        f"single element {by_pulse} % more depth.",
        f"At equal energy per lit area the single element reaches {depths[EQUAL_AREA]} and the "
        f"matrix {by_area} % more, by light scattered over from its "
        f"neighbours, so neither stops at the paper's 3.5 to 4; a matrix of pixels that can be "
        f"built, though, sees to {depths[MATRIX_BUILDABLE]}.",
    ]


def _at_bottoms(light: Light, which: int) -> FloatArray:
    column = np.maximum(light.column[:, which].mean(axis=0), 1e-300)
    return np.asarray(np.exp(np.interp(light.sweep_depth, light.depth, np.log(column))))


def _even(light: Light, contrast: FloatArray) -> float:
    return limit_depth(depth=light.sweep_depth, snr=instrument.REQUIRED_SNR * contrast)


def _listed(words: list[str]) -> str:
    return ", ".join(words[:-1]) + " and " + words[-1]

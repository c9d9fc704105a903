"""The avalanche photodiode below breakdown: a current in proportion to the light."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from survey.sensor.detector import Readings
from survey.sensor.multiplication import amplifier_variance, multiplied, quick
from survey.sensor.response import spread
from survey.sensor.scatter import Scatter

FloatArray = NDArray[np.float64]


def mcintyre_excess_noise(*, gain: float, ionisation_ratio: float) -> float:
    """Excess noise factor F = k M + (1 - k)(2 - 1/M) of an avalanche [1].

    R. J. McIntyre, IEEE Transactions on Electron Devices 13, 164 (1966), electrons injected.

    Parameters
    ----------
    gain : float
        M, at least 1 [1].
    ionisation_ratio : float
        k, of holes to electrons, 0 to 1 [1].

    Examples
    --------
    >>> round(mcintyre_excess_noise(gain=100.0, ionisation_ratio=0.02), 4)
    3.9502
    """
    k = ionisation_ratio
    return k * gain + (1.0 - k) * (2.0 - 1.0 / gain)


def gaussian_response(bandwidth: float) -> float:
    """Standard deviation in time of a Gaussian low-pass with this -3 dB bandwidth [s].

    Examples
    --------
    >>> f"{gaussian_response(300e6):.3e}"
    '4.417e-10'
    """
    return sqrt(log(2.0)) / (2.0 * pi * bandwidth)


@dataclass(frozen=True, kw_only=True)
class LinearApd:
    """Multiplies photo-electrons, with noise of its own, into a sampled current.

    Readings are charges over the mean gain, so that a photo-electron reads 1 on average. The
    low-pass is Gaussian; the delay of the electronics is taken as calibrated away.

    Parameters
    ----------
    quantum_efficiency : float
        Photo-electrons per photon, 0 to 1 [1].
    dark_count_rate : float
        Dark electrons that are multiplied, per pixel [1/s].
    gain, ionisation_ratio : float
        See `mcintyre_excess_noise`.
    amplifier_noise : float
        Density of the noise current at the amplifier's input [A/sqrt(Hz)].
    bandwidth : float
        At -3 dB [Hz].
    full_scale : float
        Reading of one pulse and bin at which the amplifier clips [photo-electrons].
    bin_width : float
        Of a sample [s].
    pulses : int
        Pulses of a frame, whose currents are summed.
    """

    quantum_efficiency: float
    dark_count_rate: float
    gain: float
    ionisation_ratio: float
    amplifier_noise: float
    bandwidth: float
    full_scale: float
    bin_width: float
    pulses: int = 1

    @property
    def photo_electrons_per_photon(self) -> float:
        """Photo-electrons per photon behind the optics [1]."""
        return self.quantum_efficiency

    @property
    def timing_sigma(self) -> float:
        """Standard deviation of the low-pass [s]."""
        return gaussian_response(self.bandwidth)

    @property
    def excess_noise_factor(self) -> float:
        """F after McIntyre [1]."""
        return mcintyre_excess_noise(gain=self.gain, ionisation_ratio=self.ionisation_ratio)

    def read(self, light: FloatArray, chance: np.random.Generator) -> Readings:
        """Draw the sampled current of one frame."""
        draws, variance = quick(chance), self.excess_noise_factor - 1.0
        electrons = draws.poisson(light * self.pulses)
        charge = multiplied(electrons, gain_variance=variance, chance=draws)
        noise = draws.standard_normal(light.shape, dtype=np.float32)
        noise *= np.float32(sqrt(self._added_variance))
        charge += noise
        limit = self.full_scale * self.pulses
        counts = np.minimum(self._low_pass(charge), limit)
        return Readings(counts=counts.astype(np.float32), blind=counts >= limit)

    def mean(self, light: FloatArray) -> FloatArray:
        """Return the mean reading."""
        return self._low_pass(light * self.pulses)

    def scatter(self, light: FloatArray, mean: FloatArray) -> Scatter:
        """Tell excess noise, and the amplifier's before the low-pass, which is no less."""
        return Scatter(
            mean=mean,
            gain_variance=np.full(light.shape, self.excess_noise_factor - 1.0),
            added_variance=np.full(light.shape, self._added_variance),
        )

    def added(self, light: FloatArray, more: FloatArray, mean: FloatArray) -> FloatArray:
        """Return the mean reading of more light, whatever was there."""
        return self._low_pass(more * self.pulses)

    @property
    def _added_variance(self) -> float:
        noise = amplifier_variance(
            noise_current=self.amplifier_noise, gain=self.gain, time=self.bin_width
        )
        return self.pulses * noise

    def _low_pass(self, charge: FloatArray) -> FloatArray:
        return spread(charge, sigma=self.timing_sigma / self.bin_width)

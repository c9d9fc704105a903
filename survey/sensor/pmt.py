"""The photomultiplier: counts while its pulses are apart, a current where they overlap."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d

from survey.sensor.detector import Readings
from survey.sensor.multiplication import amplifier_variance, multiplied, quick
from survey.sensor.response import spread
from survey.sensor.scatter import Scatter

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def pulses_are_apart(*, rate: FloatArray, rc: float) -> BoolArray:
    """Tell where 1 / rate >= R C, so that single photons can be counted [Lisenko2017].

    Parameters
    ----------
    rate : array
        Photo-electrons per second [1/s].
    rc : float
        Time constant of the anode's load [s].

    Examples
    --------
    >>> pulses_are_apart(rate=np.array([1e8, 5e8, 6e8]), rc=2e-9).tolist()
    [True, True, False]
    """
    return np.asarray(rate * rc <= 1.0)


def dynode_excess_noise(secondary_emission: float) -> float:
    """Excess noise factor F = d / (d - 1) of a long chain of like dynodes [1].

    Each electron makes a Poisson number of secondaries, d on average and above 1: the variance of
    such a branching over its squared mean is 1/d + 1/d^2 + ... = 1 / (d - 1).

    Examples
    --------
    >>> dynode_excess_noise(5.0)
    1.25
    """
    return secondary_emission / (secondary_emission - 1.0)


@dataclass(frozen=True, kw_only=True)
class Pmt:
    """A photomultiplier with a counter and a current channel on each anode.

    The mode of a bin follows the expected rate. A counted pulse is one before which the line was
    quiet for R C (paralyzable); in current mode R C spreads the reading.

    Parameters
    ----------
    quantum_efficiency : float
        Electrons that reach the first dynode, per photon, 0 to 1 [1].
    dark_count_rate : float
        Dark electrons of the cathode, per pixel [1/s].
    gain : float
        Electrons at the anode per photo-electron [1].
    secondary_emission : float
        See `dynode_excess_noise`.
    rc : float
        Time constant of the anode's load, the width of its pulses [s].
    amplifier_noise : float
        Density of the noise current of the current channel [A/sqrt(Hz)].
    transit_time_sigma : float
        Standard deviation of the transit time [s].
    full_scale : float
        Reading of one pulse and bin at which the current clips [photo-electrons].
    bin_width : float
        Of a bin [s].
    pulses : int
        Pulses of a frame, whose readings are summed.
    """

    quantum_efficiency: float
    dark_count_rate: float
    gain: float
    secondary_emission: float
    rc: float
    amplifier_noise: float
    transit_time_sigma: float
    full_scale: float
    bin_width: float
    pulses: int = 1

    @property
    def photo_electrons_per_photon(self) -> float:
        """Photo-electrons per photon behind the optics [1]."""
        return self.quantum_efficiency

    @property
    def timing_sigma(self) -> float:
        """Standard deviation of the transit time [s]."""
        return self.transit_time_sigma

    @property
    def excess_noise_factor(self) -> float:
        """F of the current channel [1]."""
        return dynode_excess_noise(self.secondary_emission)

    def read(self, light: FloatArray, chance: np.random.Generator) -> Readings:
        """Draw the counts, or the current, of every bin of one frame."""
        mean, counted = self._mean(light)
        draws, current = quick(chance), ~counted
        electrons = draws.poisson(mean)
        charge = multiplied(
            electrons[current], gain_variance=self.excess_noise_factor - 1.0, chance=draws
        )
        charge += sqrt(self._added_variance) * draws.standard_normal(charge.shape)
        limit = self.full_scale * self.pulses
        counts = electrons.astype(np.float32)
        counts[current] = np.minimum(charge, limit)
        return Readings(counts=counts, blind=current & (counts >= limit))

    def mean(self, light: FloatArray) -> FloatArray:
        """Return the mean counts, or the mean current, of every bin."""
        return self._mean(light)[0]

    def scatter(self, light: FloatArray, mean: FloatArray) -> Scatter:
        """Tell the noise of the current channel where it is used."""
        counted = self._counted(self._arriving(light))
        return Scatter(
            mean=mean,
            gain_variance=np.where(counted, 0.0, self.excess_noise_factor - 1.0),
            added_variance=np.where(counted, 0.0, self._added_variance),
        )

    def added(self, light: FloatArray, more: FloatArray, mean: FloatArray) -> FloatArray:
        """Return how much the mean readings grow; more light may change a bin's mode."""
        return self._mean(np.maximum(light + more, 0.0))[0] - mean

    @property
    def _added_variance(self) -> float:
        noise = amplifier_variance(
            noise_current=self.amplifier_noise, gain=self.gain, time=self.bin_width
        )
        return self.pulses * noise

    def _mean(self, light: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Return the mean readings of a frame, and which bins are counted."""
        arriving = self._arriving(light)
        counted = self._counted(arriving)
        quiet = np.exp(-_just_before(arriving, self.rc / self.bin_width))
        width = hypot(self.transit_time_sigma, self.rc)
        current = spread(light, sigma=width / self.bin_width)
        return self.pulses * np.where(counted, arriving * quiet, current), counted

    def _arriving(self, light: FloatArray) -> FloatArray:
        return spread(light, sigma=self.transit_time_sigma / self.bin_width)

    def _counted(self, arriving: FloatArray) -> BoolArray:
        return pulses_are_apart(rate=arriving / self.bin_width, rc=self.rc)


def _just_before(light: FloatArray, time: float) -> FloatArray:
    """Return the photo-electrons in a time [bins] before the middle of every bin.

    Examples
    --------
    >>> _just_before(np.array([4.0, 8.0, 8.0]), 0.5).tolist()
    [2.0, 4.0, 4.0]
    >>> _just_before(np.array([4.0, 8.0, 8.0]), 1.0).tolist()
    [2.0, 6.0, 8.0]
    """
    whole = int(np.ceil(time - 0.5)) if time > 0.5 else 0
    shares = np.zeros(2 * whole + 1)
    shares[whole:] = np.clip(time + 0.5 - np.arange(whole + 1.0), 0.0, 1.0)
    shares[whole] = min(time, 0.5)
    return np.asarray(convolve1d(light, shares, axis=-1, mode="constant"))

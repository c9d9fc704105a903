"""What is no bottom: sun, darkness and the water's own light, and the thresholds above them.

Readings are summed over a gate of one pulse width that slides by one bin. A gate fires when it
holds at least n_L; n_L is set for each gate such that its noise alone reaches it with the false
alarm rate divided by the number of gates: a pixel then fires falsely in one flash with at most the
stated rate. The detector tells which mean readings light has and how they scatter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, uniform_filter
from scipy.stats import norm

from survey.cloud.kernels.gates import windowed
from survey.sensor.detector import Detector
from survey.sensor.scatter import Scatter

FloatArray = NDArray[np.float64]
Readout = NDArray[np.floating | np.integer]

NEIGHBOURS = 9
DOUBTFUL = 3.0


@dataclass(frozen=True, kw_only=True)
class RangingSettings:
    """How counts are judged.

    Parameters
    ----------
    false_alarm_rate : float
        Highest probability of a false echo, per pixel and flash, over the whole gate [1].
    gate : float
        Width of the sliding gate, about a pulse [s].
    """

    false_alarm_rate: float
    gate: float


@dataclass(frozen=True, kw_only=True)
class NoiseModel:
    """Readings that are no bottom, and the thresholds they ask for; arrays (rows, columns, bins).

    Parameters
    ----------
    detector : Detector
        Whose readings they are.
    steady_light : float
        Photo-electrons that sun and darkness make in a bin of one pulse [1].
    bottomless_light : array
        Mean photo-electrons of a bin of one pulse over water without a bottom, surface echo and
        steady light included.
    steady, bottomless : array
        Mean readings under these lights.
    bins : Scatter
        Readings of the bins, over water without a bottom.
    gate : Scatter
        Readings of the gate that is centred on the bin, over water without a bottom.
    surface_threshold, bottom_threshold : array
        n_L of that gate.
    allowance : array
        By how much ``bottom_threshold`` is raised for the Monte Carlo error [counts].
    deviate : float
        That over the error of a gate [1].
    model_flashes : int
        How many flashes the model is the mean of.
    doubt : array or float
        What a gate must hold above ``bottomless`` for the Monte Carlo error of the flash itself,
        see `of_flash`.
    gate_bins : int
        Bins of a gate, odd.
    pulse : array (taps,)
        The pulse in bins, for the matched filter.
    false_alarm_rate : float
        See `RangingSettings` [1].
    bin_start, bin_width : float
        Early edge of the first bin, and width [s].
    surface_walk : array (rows, columns) or float
        How much later than its light the surface echo reads, see
        `survey.cloud.ranging.surface_walk` [s].
    """

    detector: Detector
    steady_light: float
    bottomless_light: FloatArray
    steady: FloatArray
    bottomless: FloatArray
    bins: Scatter
    gate: Scatter
    surface_threshold: FloatArray
    bottom_threshold: FloatArray
    gate_bins: int
    pulse: FloatArray
    false_alarm_rate: float
    bin_start: float
    bin_width: float
    allowance: FloatArray
    deviate: float
    model_flashes: int
    doubt: FloatArray | float = 0.0
    surface_walk: FloatArray | float = 0.0

    @property
    def pulse_sigma(self) -> float:
        """Standard deviation of the pulse, the detector's jitter included [s]."""
        bins = np.arange(self.pulse.shape[0]) - self.pulse.shape[0] // 2
        return float(np.sqrt((self.pulse * bins**2).sum()) * self.bin_width)

    @classmethod
    def build(
        cls,
        *,
        settings: RangingSettings,
        detector: Detector,
        steady_light: float,
        bottomless_light: FloatArray,
        flash_variance: FloatArray,
        model_flashes: int,
        pulse: FloatArray,
        bin_start: float,
        bin_width: float,
    ) -> NoiseModel:
        """Set the thresholds.

        ``flash_variance`` (rows, columns, bins) is the squared Monte Carlo error of a flash and
        ``model_flashes`` how many of them the model is the mean of: thresholds are raised by the
        error of model and flash together, averaged over 9 x 9 pixels. The pulse makes the errors
        of a gate's bins rise and fall together, so they are summed. The surface is sought over the
        strongest steady readings within a gate.
        """
        gate_bins = 2 * int(settings.gate / bin_width / 2.0) + 1
        per_gate = settings.false_alarm_rate / bottomless_light.shape[-1]
        even_light = np.full(bottomless_light.shape, steady_light)
        steady = detector.scatter(even_light, detector.mean(even_light))
        bottomless = detector.scatter(bottomless_light, detector.mean(bottomless_light))
        error = _common_error(flash_variance, model_flashes)
        uncertain = reading_error(detector, bottomless_light, error, bottomless.mean)
        deviate = float(norm.isf(per_gate))
        allowance = deviate * gate_sums(uncertain, gate_bins)
        gate = gate_scatter(bottomless, gate_sums(bottomless.mean, gate_bins), gate_bins)
        strongest = maximum_filter1d(steady.mean, gate_bins, axis=-1) * gate_bins
        return cls(
            detector=detector,
            steady_light=steady_light,
            bottomless_light=bottomless_light,
            steady=steady.mean,
            bottomless=bottomless.mean,
            bins=bottomless,
            gate=gate,
            surface_threshold=gate_scatter(steady, strongest, gate_bins).threshold(per_gate),
            bottom_threshold=replace(gate, mean=gate.mean + allowance).threshold(per_gate),
            gate_bins=gate_bins,
            pulse=pulse,
            false_alarm_rate=settings.false_alarm_rate,
            bin_start=bin_start,
            bin_width=bin_width,
            allowance=allowance,
            deviate=deviate,
            model_flashes=model_flashes,
        )

    def at_rate(self, false_alarm_rate: float) -> NoiseModel:
        """Return the model with thresholds over the bottom for another false-alarm rate."""
        per_gate = false_alarm_rate / self.bottomless.shape[-1]
        deviate = float(norm.isf(per_gate))
        allowance = self.allowance * (deviate / self.deviate)
        raised = replace(self.gate, mean=self.gate.mean + allowance)
        return replace(
            self,
            false_alarm_rate=false_alarm_rate,
            bottom_threshold=raised.threshold(per_gate),
            allowance=allowance,
            deviate=deviate,
        )

    def without(self, light: FloatArray) -> NoiseModel:
        """Return the model of water that does not send back a part of its light.

        ``light`` (rows, columns, bins) are its photo-electrons. What else has raised the
        thresholds, such as the doubt of a flash, stays.
        """
        left = np.maximum(self.bottomless_light - light, self.steady_light)
        bins = self.detector.scatter(left, self.detector.mean(left))
        fallen = self._threshold(self.bins) - self._threshold(bins)
        return replace(
            self,
            bottomless_light=left,
            bottomless=bins.mean,
            bins=bins,
            gate=gate_scatter(bins, gate_sums(bins.mean, self.gate_bins), self.gate_bins),
            bottom_threshold=self.bottom_threshold - np.maximum(fallen, 0.0),
        )

    def _threshold(self, bins: Scatter) -> FloatArray:
        """Return n_L over such readings, without the doubt of a flash."""
        mean = gate_sums(bins.mean, self.gate_bins) + self.allowance
        gate = gate_scatter(bins, mean, self.gate_bins)
        return gate.threshold(self.false_alarm_rate / bins.mean.shape[-1])

    def of_flash(self, variance: NDArray[np.floating]) -> NoiseModel:
        """Return the model with the doubt of a flash whose light without a bottom errs so.

        Over a shallow bed the same walks tell the column less well than over the deep water of
        the model: where the flash errs more, averaged over the same pixels, thresholds rise.

        One path of light, rare and bright, stands out like a bottom, beyond what the mean error of
        many pixels lets expect. The error of its own pixel and bins is then as large as the light:
        of n replicates one that holds it makes an excess of one standard error, two of four 1.7.

        Parameters
        ----------
        variance : array (rows, columns, bins)
            Squared Monte Carlo error of the flash's photo-electrons, those of the bottom left out.
        """
        allowance = self.deviate * self._gate_error(_common_error(variance, self.model_flashes))
        own = self._gate_error(np.sqrt(variance, dtype=np.float64))
        return replace(
            self,
            bottom_threshold=self.bottom_threshold + np.maximum(allowance - self.allowance, 0.0),
            doubt=DOUBTFUL * own,
        )

    def _gate_error(self, error: FloatArray) -> FloatArray:
        """Return by how much a gate's reading may be off when its light errs so in every bin."""
        uncertain = reading_error(self.detector, self.bottomless_light, error, self.bottomless)
        return gate_sums(uncertain, self.gate_bins)


def _common_error(variance: NDArray[np.floating], model_flashes: int) -> FloatArray:
    """Return the error of flash and model together, averaged over 9 x 9 pixels."""
    smooth = uniform_filter(
        np.asarray(variance, dtype=np.float64), size=(NEIGHBOURS, NEIGHBOURS, 1)
    )
    return np.sqrt(np.maximum(smooth, 0.0) * (1.0 + 1.0 / model_flashes))


def gate_sums(counts: Readout, gate_bins: int) -> FloatArray:
    """Return the sum over a gate of odd width around every bin of the last axis.

    Examples
    --------
    >>> gate_sums(np.array([1.0, 2.0, 3.0, 4.0]), 3).tolist()
    [3.0, 6.0, 9.0, 7.0]
    """
    values = np.ascontiguousarray(counts, dtype=np.float64)
    result, rows = np.empty_like(values), (-1, values.shape[-1])
    running = np.empty(values.shape[-1] + 1)
    windowed(values.reshape(rows), gate_bins, running, result.reshape(rows))
    return result


def reading_error(
    detector: Detector, light: FloatArray, error: FloatArray, mean: FloatArray
) -> FloatArray:
    """Return by how much the mean readings may be off when all light is off by its error.

    Where light blinds a detector, too little of it gives too many readings later.
    """
    above, below = detector.added(light, error, mean), detector.added(light, -error, mean)
    return np.maximum(np.abs(above), np.abs(below))


def gate_scatter(bins: Scatter, mean: FloatArray, gate_bins: int) -> Scatter:
    """Return the scatter of gates with these means; the noisiest gain of a gate holds for all."""
    return Scatter(
        mean=mean,
        gain_variance=maximum_filter1d(bins.gain_variance, gate_bins, axis=-1),
        added_variance=gate_sums(bins.added_variance, gate_bins),
    )

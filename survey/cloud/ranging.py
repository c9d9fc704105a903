"""From photon counts to ranges: first surface, last bottom peak, by the threshold of eq. (11).

Counts are summed over a gate of one pulse width that slides by one bin. A gate fires when it holds
at least n_L counts; n_L is set for each gate such that its noise alone reaches it with the false
alarm rate divided by the number of gates: a pixel then fires falsely in one flash with at most the
stated rate. For the bottom, noise is sun, dark counts, and what water without a bottom sends back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, uniform_filter
from scipy.stats import norm

from survey.sensor.detector import firing_probability, firing_threshold

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

SURFACE_SEARCH_GATES = 1.5
GUARD_GATES = 1.0
NEIGHBOURS = 9


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
    """Counts that are no bottom, and the thresholds they ask for; arrays (rows, columns, bins).

    Parameters
    ----------
    steady : float
        Sun and dark counts of a bin [1].
    bottomless : array
        Mean counts of a bin over water without a bottom, surface echo and steady noise included.
    surface_threshold, bottom_threshold : array
        n_L of the gate that is centred on the bin.
    gate_bins : int
        Bins of a gate, odd.
    pulse : array (taps,)
        The pulse in bins, for the matched filter.
    bin_start, bin_width : float
        Early edge of the first bin, and width [s].
    """

    steady: float
    bottomless: FloatArray
    surface_threshold: FloatArray
    bottom_threshold: FloatArray
    gate_bins: int
    pulse: FloatArray
    bin_start: float
    bin_width: float

    @classmethod
    def build(
        cls,
        *,
        settings: RangingSettings,
        steady: float,
        bottomless: FloatArray,
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
        of a gate's bins rise and fall together, so they are summed.
        """
        smooth = uniform_filter(flash_variance, size=(NEIGHBOURS, NEIGHBOURS, 1))
        gate_bins = 2 * int(settings.gate / bin_width / 2.0) + 1
        per_gate = settings.false_alarm_rate / bottomless.shape[-1]
        steady_gate = np.full(1, steady * gate_bins)
        error = gate_sums(np.sqrt(np.maximum(smooth, 0.0) * (1.0 + 1.0 / model_flashes)), gate_bins)
        noise = gate_sums(bottomless, gate_bins) + norm.isf(per_gate) * error
        return cls(
            steady=steady,
            bottomless=bottomless,
            surface_threshold=firing_threshold(false_alarm=per_gate, noise=steady_gate),
            bottom_threshold=firing_threshold(false_alarm=per_gate, noise=noise),
            gate_bins=gate_bins,
            pulse=pulse,
            bin_start=bin_start,
            bin_width=bin_width,
        )


@dataclass(frozen=True, kw_only=True)
class Echo:
    """One echo in each pixel; arrays (rows, columns), nan where there is none.

    Parameters
    ----------
    time : array
        Two-way time [s].
    counts : array
        Counts above the expected noise [1].
    snr : array
        Those counts over the square root of all counts in the gate [1].
    """

    time: FloatArray
    counts: FloatArray
    snr: FloatArray

    @property
    def found(self) -> BoolArray:
        """Tell which pixels have the echo."""
        return np.isfinite(self.time)


def gate_sums(counts: FloatArray | NDArray[np.int32], gate_bins: int) -> FloatArray:
    """Return the sum over a gate of odd width around every bin of the last axis.

    Examples
    --------
    >>> gate_sums(np.array([1.0, 2.0, 3.0, 4.0]), 3).tolist()
    [3.0, 6.0, 9.0, 7.0]
    """
    half = gate_bins // 2
    padding = [(0, 0)] * (counts.ndim - 1) + [(half + 1, half)]
    running = np.cumsum(np.pad(np.asarray(counts, dtype=np.float64), padding), axis=-1)
    return np.asarray(running[..., gate_bins:] - running[..., :-gate_bins])


def first_echo(*, counts: NDArray[np.int32], noise: NoiseModel) -> Echo:
    """Find the crest that begins with the first gate that fires over sun and dark counts.

    From the strongest of the gates soon after it, go on to the first gate that none within half a
    gate exceeds: a strong pulse fires long before its crest.
    """
    sums = gate_sums(counts, noise.gate_bins)
    fires = sums >= noise.surface_threshold
    start = fires.argmax(axis=-1)
    late = start + int(SURFACE_SEARCH_GATES * noise.gate_bins)
    bins = np.arange(sums.shape[-1])
    near = (bins >= start[..., None]) & (bins <= late[..., None])
    strongest = np.where(near, sums, -1.0).argmax(axis=-1)
    crest = sums == maximum_filter1d(sums, noise.gate_bins, axis=-1)
    peak = (crest & (bins >= strongest[..., None])).argmax(axis=-1)
    steady = np.full_like(noise.bottomless, noise.steady)
    return _measured(counts, np.where(fires.any(axis=-1), peak, -1), steady, noise)


def last_echo(*, counts: NDArray[np.int32], noise: NoiseModel, surface_time: FloatArray) -> Echo:
    """Find the last peak over the noise of bottomless water.

    The search begins one gate after ``surface_time`` (rows, columns) [s]; nan there says that the
    pixel sees no water. A peak on the first gate searched is the flank of something earlier and
    no bottom. Of the last run of gates that fire, the one with most counts above the noise counts;
    a run ends where a gate falls under half way from noise to threshold, for the tail of an echo
    fires here and there.
    """
    bins = np.arange(counts.shape[-1])
    dry = ~np.isfinite(surface_time)
    surface_bin = np.where(dry, 0.0, (surface_time - noise.bin_start) / noise.bin_width)
    begin = surface_bin.astype(np.int64) + int(GUARD_GATES * noise.gate_bins)
    sums, expected = (gate_sums(each, noise.gate_bins) for each in (counts, noise.bottomless))
    searched = (bins >= begin[..., None]) & ~dry[..., None]
    fires = (sums >= noise.bottom_threshold) & searched
    holds = (sums >= 0.5 * (expected + noise.bottom_threshold)) & searched
    last = _last_run(fires, holds)
    peak = np.where(last, sums - expected, -np.inf).argmax(axis=-1)
    found = fires.any(axis=-1) & (peak > begin)
    return _measured(counts, np.where(found, peak, -1), noise.bottomless, noise)


def _last_run(fires: BoolArray, holds: BoolArray) -> BoolArray:
    """Return what fires in the last run along the last axis; where nothing holds, a run ends.

    Examples
    --------
    >>> fires = np.array([True, False, True, False, True, False])
    >>> holds = np.array([True, False, True, True, True, False])
    >>> _last_run(fires, holds).tolist()
    [False, False, True, False, True, False]
    """
    after = np.cumsum(fires[..., ::-1], axis=-1)[..., ::-1]
    breaks_after = np.cumsum((~holds & (after > 0))[..., ::-1], axis=-1)[..., ::-1]
    return np.asarray(fires & (breaks_after == 0))


def bottom_detection_probability(*, bottom: FloatArray, noise: NoiseModel) -> FloatArray:
    """Probability (rows, columns) that the gate fires in which the true echo is strongest.

    ``bottom`` are the expected photo-electrons of the bottom (rows, columns, bins): truth, used to
    judge a flight and never to find an echo.
    """
    echo = gate_sums(bottom, noise.gate_bins)
    best = echo.argmax(axis=-1)[..., None]
    mean = echo + gate_sums(noise.bottomless, noise.gate_bins)
    probability = firing_probability(
        threshold=np.take_along_axis(noise.bottom_threshold, best, -1),
        mean=np.take_along_axis(mean, best, -1),
    )
    return np.asarray(probability[..., 0])


def _measured(
    counts: NDArray[np.int32], peak: NDArray[np.int64], expected: FloatArray, noise: NoiseModel
) -> Echo:
    """Return the echo around a bin; -1 says that there is none."""
    found = peak >= 0
    at = np.maximum(peak, 0)[..., None]
    excess = counts - expected
    lag = _matched_peak(excess, at[..., 0], noise)
    time = noise.bin_start + (lag + 0.5) * noise.bin_width
    above = np.take_along_axis(gate_sums(excess, noise.gate_bins), at, -1)[..., 0]
    everything = np.take_along_axis(gate_sums(counts, noise.gate_bins), at, -1)[..., 0]
    snr = above / np.sqrt(np.maximum(everything, 1.0))
    return Echo(
        time=np.where(found, time, np.nan),
        counts=np.where(found, above, np.nan),
        snr=np.where(found, snr, np.nan),
    )


def _matched_peak(excess: FloatArray, near: NDArray[np.int64], noise: NoiseModel) -> FloatArray:
    """Return where, in bins, the counts match the pulse best: near a bin, between bins."""
    reach = noise.gate_bins // 2 + 1
    half = noise.pulse.shape[0] // 2
    window = np.arange(-reach - half, reach + half + 1)
    bins = excess.shape[-1]
    place = near[..., None] + window
    inside = (place >= 0) & (place < bins)
    local = np.take_along_axis(excess, np.clip(place, 0, bins - 1), -1) * inside
    matched = np.stack(
        [local[..., i : i + noise.pulse.shape[0]] @ noise.pulse for i in range(2 * reach + 1)],
        axis=-1,
    )
    top = np.clip(matched.argmax(axis=-1), 1, 2 * reach - 1)[..., None]
    left, centre, right = (np.take_along_axis(matched, top + k, -1)[..., 0] for k in (-1, 0, 1))
    curvature = left - 2.0 * centre + right
    safe = np.where(curvature < 0.0, curvature, -1.0)
    shift = np.clip(0.5 * (left - right) / safe, -0.5, 0.5)
    return np.asarray(near + top[..., 0] - reach + shift)

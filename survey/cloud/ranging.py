"""From a detector's readings to ranges: first surface, last bottom peak, by a threshold.

Thresholds are those of `survey.cloud.noise`, for readings summed over a gate of one pulse width.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from survey.cloud.echo import Echo
from survey.cloud.echo_time import timing_error
from survey.cloud.noise import NoiseModel, Readout, gate_scatter, gate_sums

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

SURFACE_SEARCH_GATES = 1.5
GUARD_GATES = 1.0


def first_echo(*, counts: Readout, noise: NoiseModel) -> Echo:
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
    echo = _measured(counts, np.where(fires.any(axis=-1), peak, -1), noise.steady, noise)
    return replace(echo, time=echo.time - noise.surface_walk)


def surface_walk(noise: NoiseModel) -> FloatArray:
    """Return how much later than its light the surface echo reads (rows, columns) [s].

    A detector that sees first photons tells strong echoes early. How early the surface is told is
    taken from the model, as a survey would calibrate it over water of known level.
    """
    light = noise.bottomless_light
    light = light * (noise.bottomless.sum() / light.sum())
    read, true = (first_echo(counts=each, noise=noise) for each in (noise.bottomless, light))
    return np.nan_to_num(read.time - true.time, nan=0.0)


def last_echo(*, counts: Readout, noise: NoiseModel, surface_time: FloatArray) -> Echo:
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
    sure = (sums >= noise.bottom_threshold) & (sums - expected >= noise.doubt)
    fires = sure & searched
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
    more = noise.detector.added(noise.bottomless_light, bottom, noise.bottomless)
    echo = gate_sums(more, noise.gate_bins)
    best = echo.argmax(axis=-1)[..., None]
    lit = noise.detector.scatter(noise.bottomless_light + bottom, noise.bottomless + more)
    mean = echo + gate_sums(noise.bottomless, noise.gate_bins)
    gate = gate_scatter(lit, mean, noise.gate_bins).at(best)
    threshold = np.take_along_axis(noise.bottom_threshold, best, -1)
    return gate.firing_probability(threshold)[..., 0]


def blind_at(*, blind: BoolArray, time: FloatArray, noise: NoiseModel) -> BoolArray:
    """Tell which pixels were blind in some bin of the gate around a time (rows, columns) [s].

    ``blind`` (rows, columns, bins) is what the detector says; truth knows the time.
    """
    bins = blind.shape[-1]
    known = np.isfinite(time)
    place = (np.where(known, time, noise.bin_start) - noise.bin_start) / noise.bin_width
    centre = np.clip(place, 0, bins - 1).astype(np.int64)[..., None]
    dark = maximum_filter1d(blind, noise.gate_bins, axis=-1)
    return np.asarray(np.take_along_axis(dark, centre, -1)[..., 0] & known)


def _measured(
    counts: Readout, peak: NDArray[np.int64], expected: FloatArray, noise: NoiseModel
) -> Echo:
    """Return the echo around a bin; -1 says that there is none."""
    found = peak >= 0
    at = np.maximum(peak, 0)[..., None]
    excess = counts - expected
    lag = _matched_peak(excess, at[..., 0], noise)
    time = noise.bin_start + (lag + 0.5) * noise.bin_width
    above = np.take_along_axis(gate_sums(excess, noise.gate_bins), at, -1)[..., 0]
    everything = np.take_along_axis(gate_sums(counts, noise.gate_bins), at, -1)[..., 0]
    spread = replace(noise.gate.at(at), mean=np.maximum(everything, 1.0)[..., None]).variance
    snr = above / np.sqrt(spread[..., 0])
    error = timing_error(signal=above, at=at, expected=expected, noise=noise)
    return Echo(
        time=np.where(found, time, np.nan),
        counts=np.where(found, above, np.nan),
        snr=np.where(found, snr, np.nan),
        time_error=np.where(found, error, np.nan),
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

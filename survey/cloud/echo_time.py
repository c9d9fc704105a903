"""When an echo came, and how well that is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from survey.cloud.echo import Echo
from survey.cloud.noise import NoiseModel, Readout

FloatArray = NDArray[np.float64]
Whole = NDArray[np.int64]

SEARCH = 0.5  # standard deviations of the pulse to each side of the peak
LEAST = 1e-9


def likeliest_echo(*, counts: Readout, peak: Whole, noise: NoiseModel) -> Echo:
    """Return the likeliest echoes around peaks (rows, columns), -1 where there is none.

    The likelihood of Poisson counts c over a known noise b, of an echo of s counts and the pulse's
    shape p: sum of c log(1 + s p / b), less s. Noise that is added to readings counts as so much
    more b. Its highest bin is refined by a parabola.
    """
    found = peak >= 0
    row, column = np.nonzero(found)
    at = peak[found]
    result = np.full((4, *peak.shape), np.nan)
    if len(at) > 0:
        result[:, row, column] = _measured(counts, at, row, column, noise)
    time, above, snr, error = result
    return Echo(time=time, counts=above, snr=snr, time_error=error)


def _measured(
    counts: Readout, at: Whole, row: Whole, column: Whole, noise: NoiseModel
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return time, counts, ratio to chance and standard error of time of n echoes."""
    half = noise.gate_bins // 2
    place = at[:, None] + np.arange(-half, half + 1)
    inside = (place >= 0) & (place < counts.shape[-1])
    index = (row[:, None], column[:, None], np.clip(place, 0, counts.shape[-1] - 1))
    everything = (counts[index] * inside).sum(axis=-1, keepdims=True)
    above = everything[:, 0] - (noise.bottomless[index] * inside).sum(axis=-1)
    scatter = replace(
        noise.gate,
        mean=np.maximum(everything, 1.0),
        gain_variance=noise.gate.gain_variance[row, column, at][:, None],
        added_variance=noise.gate.added_variance[row, column, at][:, None],
    )
    signal = whole_signal(above, noise)
    lag, width = _likeliest_lag(counts, at, row, column, signal, noise), noise.bin_width
    time = noise.bin_start + (at + lag + 0.5) * width
    error = _least_error(at, row, column, signal, noise)
    return time, above, above / np.sqrt(scatter.variance[:, 0]), error * width


def _likeliest_lag(
    counts: Readout, at: Whole, row: Whole, column: Whole, signal: FloatArray, noise: NoiseModel
) -> FloatArray:
    """Return by how many bins the likeliest time lies behind that of the peak."""
    reach = 1 + int(np.ceil(SEARCH * noise.pulse_sigma / noise.bin_width))
    half = noise.pulse.shape[0] // 2
    local, noisy = _windows(counts, at, row, column, reach + half, noise)
    share = signal[:, None] * noise.pulse
    likely = np.empty((len(at), 2 * reach + 1))
    for i in range(2 * reach + 1):
        part = slice(i, i + len(noise.pulse))
        likely[:, i] = (local[:, part] * np.log1p(share / noisy[:, part])).sum(axis=-1)
    top = np.clip(likely.argmax(axis=-1), 1, 2 * reach - 1)[:, None]
    left, centre, right = (np.take_along_axis(likely, top + k, -1)[:, 0] for k in (-1, 0, 1))
    curvature = left - 2.0 * centre + right
    safe = np.where(curvature < 0.0, curvature, -1.0)
    return np.asarray(top[:, 0] - reach + np.clip(0.5 * (left - right) / safe, -0.5, 0.5))


def _windows(
    counts: Readout, at: Whole, row: Whole, column: Whole, half: int, noise: NoiseModel
) -> tuple[FloatArray, FloatArray]:
    """Return counts and noise (n, 2 half + 1) around bins; no counts beyond the gate."""
    place = at[:, None] + np.arange(-half, half + 1)
    inside = (place >= 0) & (place < counts.shape[-1])
    kept = np.clip(place, 0, counts.shape[-1] - 1)
    noisy = _variance(noise, row, column, kept)
    return counts[row[:, None], column[:, None], kept] * inside, np.maximum(noisy, LEAST)


def _least_error(
    at: Whole, row: Whole, column: Whole, signal: FloatArray, noise: NoiseModel
) -> FloatArray:
    """Return the least standard error of time of an unbiased estimate [bins], Cramer's and Rao's.

    One over the square root of the sum of (s p')^2 / (s p + b).
    """
    half = noise.pulse.shape[0] // 2
    place = np.clip(at[:, None] + np.arange(-half, half + 1), 0, noise.bottomless.shape[-1] - 1)
    noisy = np.maximum(_variance(noise, row, column, place), LEAST)
    gain = 1.0 + noise.bins.gain_variance[row[:, None], column[:, None], place]
    mean, slope = signal[:, None] * noise.pulse, signal[:, None] * _slope(noise.pulse)
    return np.asarray(1.0 / np.sqrt((slope**2 / (gain * mean + noisy)).sum(axis=-1)))


def _variance(noise: NoiseModel, row: Whole, column: Whole, place: Whole) -> FloatArray:
    """Return the noise's variance (n, bins) at some bins of n pixels."""
    index, bins = (row[:, None], column[:, None], place), noise.bins
    counted = bins.mean[index] * (1.0 + bins.gain_variance[index])
    return np.asarray(counted + bins.added_variance[index])


def timing_error(
    *, signal: FloatArray, at: Whole, expected: FloatArray, noise: NoiseModel
) -> FloatArray:
    """Return the standard error of the time at which counts match the pulse best [s].

    That time is where the sum of p' times the counts is zero: its error is the root of the sum of
    p'^2 (s p + b), over that of s p'^2. Arrays (rows, columns), ``at`` with one more axis of 1,
    ``signal`` counts in the gate, ``expected`` (rows, columns, bins) the noise.
    """
    half = noise.pulse.shape[0] // 2
    place = np.clip(at + np.arange(-half, half + 1), 0, expected.shape[-1] - 1)
    gain, added = (
        np.take_along_axis(part, place, -1)
        for part in (noise.bins.gain_variance, noise.bins.added_variance)
    )
    strength, slope = whole_signal(signal, noise)[..., None], _slope(noise.pulse)
    mean = np.take_along_axis(expected, place, -1) + strength * noise.pulse
    spread = np.sqrt((slope**2 * ((1.0 + gain) * mean + added)).sum(axis=-1))
    return np.asarray(noise.bin_width * spread / (strength[..., 0] * (slope**2).sum()))


def whole_signal(above: FloatArray, noise: NoiseModel) -> FloatArray:
    """Return the counts of whole pulses, of which so many were above the noise in the gate.

    No less than one count in the gate, for an error of time must have a bound.
    """
    middle, half = noise.pulse.shape[0] // 2, noise.gate_bins // 2
    share = noise.pulse[max(0, middle - half) : middle + half + 1].sum()
    return np.asarray(np.maximum(above, 1.0) / share)


def _slope(pulse: FloatArray) -> FloatArray:
    """Return the pulse's change from bin to bin."""
    return np.asarray(0.5 * (np.append(pulse[1:], 0.0) - np.append(0.0, pulse[:-1])))

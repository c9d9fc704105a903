"""The bottom by a matched filter: alone where it is strong, with its neighbours where it is weak.

1. Readings, and what bottomless water makes of them, are added up over the pulse: weights are
   those of a Gaussian a little longer than pulse and jitter together, which costs 1 % of the ratio
   of signal to noise and forgives slopes.
2. By what the column is off, its pixel and the 24 around it tell from the water above a bin: never
   from the bin itself or what lies below.
3. What is left is judged three times: in the pixel alone, and with the 8 and the 24 pixels around
   it at equal time after the surface. A neighbour counts for no more than it would take to be
   found alone, and a pixel is found with its neighbours only where it has an echo of its own.
4. Each judgement has a third of the false-alarm rate, shared out over the bins. The tails are those
   of `survey.cloud.tails`; errors of the Monte Carlo and of the column's fit widen them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter
from scipy.special import ndtr
from scipy.stats import norm

from survey.cloud.echo import Echo
from survey.cloud.echo_time import likeliest_echo
from survey.cloud.kernels.matched_filter import (
    NONE,
    excesses,
    filtered,
    last_peaks,
    pooled,
    scales,
)
from survey.cloud.noise import DOUBTFUL, NEIGHBOURS, NoiseModel, Readout, reading_error
from survey.cloud.tails import TailTable

FloatArray = NDArray[np.float64]
Singles = NDArray[np.float32]
Whole = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

FILTER_WIDTH = 1.2  # of the filter over that of the pulse
FILTER_REACH = 2.5  # standard deviations of the filter
POOLS = (1, 2)  # pixels to each side: 3 x 3 and 5 x 5
JUDGEMENTS = 1 + len(POOLS)
SCALE_DOUBT = 0.05  # standard deviation of the column's scale before it is fitted
SHAPE_DOUBT = 0.01  # of the column in a gate, whatever the scale
RARE = 3.0  # times the mean error around: what is more is a rare path's
MONTE_CARLO_TAIL = 1.3  # few rare paths make more large errors than Gauss
OWN_DEVIATIONS = 1.0
TAIL_SHARE, TAIL_GATES = 0.02, 10.0


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """What an echo is measured against, in the pixel or in a pool of pixels.

    Parameters
    ----------
    reach : int
        Pixels of the pool to each side, 0 for the pixel alone.
    variance : array (rows, columns, places)
        Of the filtered readings over water without a bottom [counts^2].
    threshold : array (rows, columns, places)
        By how much they must exceed the fitted column [counts].
    """

    reach: int
    variance: Singles
    threshold: Singles


@dataclass(frozen=True, kw_only=True)
class MatchedSearch:
    """The search of one flash for its bottoms.

    Parameters
    ----------
    noise : NoiseModel
        Of the flash's pose.
    taps : array (taps,)
        The filter, its largest weight 1.
    late, begin : array (rows, columns)
        Bins of the surface and of the first gate searched; -1 where there is no water.
    step : int
        Bins between the places at which variances and thresholds are told.
    expected : array (rows, columns, bins)
        Filtered readings over water without a bottom.
    variance : array (rows, columns, places)
        Of filtered readings by chance [counts^2].
    error : array (rows, columns, places)
        Squared error of the expected ones, as the Monte Carlo makes it [counts^2].
    doubt : array (rows, columns, places)
        What filtered readings must hold above the column for this pixel's own such error.
    tail : TailTable
        By how much chance may exceed its mean.
    deviate : float
        The same of the errors, over their standard deviation [1].
    """

    noise: NoiseModel
    taps: Singles
    late: Whole
    begin: Whole
    step: int
    expected: Singles
    variance: Singles
    error: Singles
    doubt: Singles
    tail: TailTable
    deviate: float

    @classmethod
    def over(
        cls, *, noise: NoiseModel, variance: NDArray[np.floating], surface_time: FloatArray
    ) -> MatchedSearch:
        """Prepare the search of a flash.

        Parameters
        ----------
        noise : NoiseModel
            Of its pose.
        variance : array (rows, columns, bins)
            Squared Monte Carlo error of the flash's photo-electrons without those of the bottom.
        surface_time : array (rows, columns)
            Two-way time to the water [s]; nan where a pixel sees none.
        """
        taps = filter_taps(noise.pulse_sigma / noise.bin_width)
        step = max(1, noise.gate_bins // 3)
        wet = np.isfinite(surface_time)
        bins = np.where(wet, surface_time - noise.bin_start, 0.0) / noise.bin_width
        late = np.where(wet, bins.astype(np.int64), NONE)
        off = reading_error(
            noise.detector, noise.bottomless_light, np.sqrt(variance), noise.bottomless
        )
        own = _filtered(off, taps, step)
        mean = uniform_filter(own, size=(NEIGHBOURS, NEIGHBOURS, 1))
        rare = np.minimum(own, np.float32(RARE) * mean)
        common = uniform_filter(rare**2, size=(NEIGHBOURS, NEIGHBOURS, 1))
        chance = _chance(noise, taps, noise.false_alarm_rate)
        return cls(
            noise=noise,
            taps=taps,
            late=late,
            begin=np.where(wet, np.maximum(late + noise.gate_bins, 0), NONE),
            step=step,
            expected=_filtered(noise.bottomless, taps),
            variance=_filtered(noise.bins.variance, taps**2, step),
            error=common * np.float32(1.0 + 1.0 / noise.model_flashes),
            doubt=np.float32(DOUBTFUL) * _over_the_step(own),
            tail=chance.tail,
            deviate=chance.deviate,
        )

    def at_rate(self, false_alarm_rate: float) -> MatchedSearch:
        """Return the search with another false-alarm rate of a pixel and flash."""
        chance = _chance(self.noise, self.taps, false_alarm_rate)
        return replace(self, tail=chance.tail, deviate=chance.deviate)

    def echo(self, counts: Readout, asked: BoolArray | None = None) -> Echo:
        """Return the bottom's echo in readings (rows, columns, bins).

        One whose likeliest time lies before the first gate searched is the flank of the surface's,
        or of a bottom's that is merged with it, and none. ``asked`` are the pixels (rows, columns)
        in which it is looked for: all of them unless told.
        """
        seen = _filtered(counts, self.taps)
        alone, *pools = self._judgements
        excess, clipped = np.empty_like(seen), np.empty_like(seen)
        scale, _ = self._fitted(seen)
        excesses(seen, self.expected, scale, alone.threshold, self.step, excess, clipped)
        wanted = np.ones(self.late.shape, np.bool_) if asked is None else asked
        peak = self._last_peaks(excess, alone.threshold, excess, self.doubt, wanted)
        for pool in pools:
            unseen = wanted & (peak == NONE)
            together = self._pooled(clipped, 1, pool.reach, unseen)
            weak = self._last_peaks(together, pool.threshold, excess, self._own_least, unseen)
            peak = np.where(unseen, weak, peak)
        echo = likeliest_echo(counts=counts, peak=peak, noise=self.noise)
        first = self.noise.bin_start + self.begin * self.noise.bin_width
        return echo.only(echo.time >= first)

    def probability(self, bottom: FloatArray) -> FloatArray:
        """Probability (rows, columns) that the true echo is found, alone or with its neighbours.

        The greatest of the judgements', each where its pool's echo is strongest; sums of counts
        are taken as normal, which is off by up to 0.2 where they are few. ``bottom`` are the
        expected photo-electrons of the bottom (rows, columns, bins): truth.
        """
        noise = self.noise
        more = noise.detector.added(noise.bottomless_light, bottom, noise.bottomless)
        gain = float(noise.bins.gain_variance.max())
        mean = _filtered(more, self.taps, self.step)
        alone = self._judgements[0]
        own = ndtr((mean - self._own_least) / np.sqrt(alone.variance + (1.0 + gain) * mean))
        result = np.zeros(mean.shape[:2])
        for judged in self._judgements:
            pooled_mean = self._pooled(np.minimum(mean, alone.threshold), self.step, judged.reach)
            together = mean if judged.reach == 0 else pooled_mean
            spread = np.sqrt(judged.variance + (1.0 + gain) * np.maximum(together, 0.0))
            fires = ndtr((together - judged.threshold) / np.maximum(spread, 1e-9)) * own
            best = together.argmax(axis=-1)[..., None]
            np.maximum(result, np.take_along_axis(fires, best, -1)[..., 0], out=result)
        return np.where(self.late == NONE, 0.0, result)

    def without(self, light: FloatArray) -> MatchedSearch:
        """Return the search over water that does not send back a part of its light."""
        noise = self.noise.without(light)
        return replace(
            self,
            noise=noise,
            expected=_filtered(noise.bottomless, self.taps),
            variance=_filtered(noise.bins.variance, self.taps**2, self.step),
        )

    @cached_property
    def _expected_by_step(self) -> Singles:
        return np.ascontiguousarray(self.expected[..., :: self.step])

    @cached_property
    def _around(self) -> tuple[Singles, Singles]:
        """Expected filtered readings of the largest pool at every step, and their variance."""
        parts = (self._expected_by_step, self.variance + self.error)
        expected, variance = (self._pooled(part, self.step, POOLS[-1]) for part in parts)
        least = np.float32(1e-9)
        return np.maximum(expected, least), np.maximum(variance, least)

    @cached_property
    def _judgements(self) -> list[Judgement]:
        """The pixel's own judgement, and those of its pools."""
        _, scale_error = self._fitted(self.expected)
        return [self._judged(reach, scale_error) for reach in (0, *POOLS)]

    @cached_property
    def _own_least(self) -> Singles:
        """What a pixel must hold itself to be found with its neighbours."""
        return np.maximum(OWN_DEVIATIONS * np.sqrt(self._judgements[0].variance), self.doubt)

    def _fitted(self, seen: Singles) -> tuple[Singles, Singles]:
        """Return by what the column is off at every step, and the variance of that."""
        expected, variance = self._around
        by_step = np.ascontiguousarray(seen[..., :: self.step])
        around = self._pooled(by_step, self.step, POOLS[-1])
        scale, error = np.empty_like(expected), np.empty_like(expected)
        half = self.taps.shape[0] // 2
        share = self.step / (FILTER_WIDTH * self.noise.pulse_sigma / self.noise.bin_width)
        scales(
            around, expected, variance, np.maximum(self.begin, 0) + half, self.step,
            2 * half // self.step + 1, min(1.0, share / (2.0 * sqrt(pi))), SCALE_DOUBT,
            scale, error,
        )  # fmt: skip
        return scale, error

    def _judged(self, reach: int, scale_error: Singles) -> Judgement:
        """Return what chance asks, and the errors of what is expected."""
        expected, variance, error = (
            self._pooled(part, self.step, reach)
            for part in (self._expected_by_step, self.variance, self.error)
        )
        error = error + expected**2 * (scale_error + np.float32(SHAPE_DOUBT**2))
        chance = self.tail.above(variance)
        return Judgement(
            reach=reach,
            variance=np.maximum(variance + error, np.float32(1e-12)),
            threshold=np.sqrt(chance**2 + self.deviate**2 * error).astype(np.float32),
        )

    def _pooled(
        self, values: Singles, step: int, reach: int, asked: BoolArray | None = None
    ) -> Singles:
        """Return the sums of the pixels around each, or around those asked for."""
        if reach == 0:
            return values
        result = np.empty_like(values)
        everywhere = np.ones(self.late.shape, np.bool_)
        pooled(values, self.late, everywhere if asked is None else asked, step, reach, result)
        return result

    def _last_peaks(
        self, excess: Singles, threshold: Singles, own: Singles, least: Singles, asked: BoolArray
    ) -> Whole:
        peak = np.empty(excess.shape[:2], np.int64)
        last_peaks(
            excess, threshold, own, least, self.begin, asked, self.step,
            TAIL_SHARE, int(TAIL_GATES * self.noise.gate_bins), peak,
        )  # fmt: skip
        return peak


def filter_taps(sigma: float) -> Singles:
    """Return the filter's weights for a pulse of this width in bins, the largest of them 1.

    Examples
    --------
    >>> print(filter_taps(1.0).round(2))
    [0.04 0.25 0.71 1.   0.71 0.25 0.04]
    """
    width = max(FILTER_WIDTH * sigma, 0.3)
    half = int(np.ceil(FILTER_REACH * width))
    return np.exp(-0.5 * (np.arange(-half, half + 1) / width) ** 2).astype(np.float32)


def false_alarm_of_a_bin(*, rate: float, bins: int, sigma: float) -> float:
    """Probability that a bin may fire falsely for a pixel to do so with ``rate``.

    Filtered noise rises and falls slowly: of the bins that would fire, many stand together. Rice's
    formula for the crossings of Gaussian noise, whose correlation is a Gaussian sqrt(2) as wide as
    the filter's ``sigma`` in bins, gives z / (2 sigma sqrt(pi)) separate events a bin that fires.
    (S. O. Rice, Bell System Technical Journal 24, 46 (1945)).

    Examples
    --------
    >>> f"{false_alarm_of_a_bin(rate=1e-3, bins=300, sigma=5.0):.2e}"
    '1.31e-05'
    """
    alone = rate / bins
    together = float(norm.isf(alone)) / (2.0 * sqrt(pi) * max(sigma, 1e-9))
    return alone / min(1.0, together)


@dataclass(frozen=True, kw_only=True)
class _Chance:
    """How far chance reaches at a false-alarm rate; see `MatchedSearch`."""

    tail: TailTable
    deviate: float


def _chance(noise: NoiseModel, taps: Singles, rate: float) -> _Chance:
    """Return what each judgement's share of a pixel's false-alarm rate asks for."""
    false_alarm = false_alarm_of_a_bin(
        rate=rate / JUDGEMENTS,
        bins=noise.bottomless.shape[-1],
        sigma=FILTER_WIDTH * noise.pulse_sigma / noise.bin_width,
    )
    gain_variance = float(noise.bins.gain_variance.max())
    return _Chance(
        tail=_tail(tuple(taps.tolist()), false_alarm, gain_variance),
        deviate=MONTE_CARLO_TAIL * float(norm.isf(false_alarm)),
    )


@lru_cache(maxsize=16)
def _tail(taps: tuple[float, ...], false_alarm: float, gain_variance: float) -> TailTable:
    return TailTable.build(
        weights=np.array(taps), false_alarm=false_alarm, gain_variance=gain_variance
    )


def _over_the_step(values: Singles) -> Singles:
    """Return the greater of the values at both ends of every step."""
    later = np.concatenate([values[..., 1:], values[..., -1:]], axis=-1)
    return np.asarray(np.maximum(values, later))


def _filtered(values: Readout, taps: Singles, step: int = 1) -> Singles:
    """Return filtered values (rows, columns, bins) about every step-th bin."""
    flat = values.reshape(-1, values.shape[-1]).astype(np.float32)
    result = np.empty_like(flat)
    filtered(flat, taps, result)
    by_step = np.ascontiguousarray(result[:, ::step])
    return np.asarray(by_step.reshape(*values.shape[:2], -1))

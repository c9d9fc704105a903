"""The single-photon avalanche diode (SPAD): Geiger mode, one digital pulse for every avalanche."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from survey.sensor.detector import Readings, TimeTags
from survey.sensor.response import spread
from survey.sensor.scatter import Scatter
from survey.sensor.spad_events import NOTHING, Candidates, Diodes, Found, avalanches
from survey.sensor.spad_mean import mean_avalanches

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class Look:
    """When the array is armed, in some of a frame's pulses.

    Parameters
    ----------
    armed : array (rows, columns, bins) or (1, 1, bins)
        Where the bias is above breakdown.
    pulses : int
        Pulses of the frame that look so.
    """

    armed: BoolArray
    pulses: int


@dataclass(frozen=True, kw_only=True)
class Spad:
    """An array of SPADs with a counter for every bin of every pixel.

    Dead time is not prolonged by photons that meet a dead pixel (nonparalyzable); each pulse finds
    all pixels live. An afterpulse comes after the dead time, exponentially late. Crosstalk sets off
    the four nearest neighbours at once, each with the same probability.

    Parameters
    ----------
    quantum_efficiency : float
        Avalanches per photon on the active area, above 0 and at most 1 [1].
    fill_factor : float
        Share of the pixel that is active, microlenses included [1].
    dark_count_rate : float
        Avalanches in the dark, per pixel [1/s].
    dead_time : float
        After every avalanche [s]; longer than the gate, and only the first photon is seen.
    afterpulse_probability : float
        Afterpulses per avalanche after the dead time, below 1 [1].
    afterpulse_lifetime : float
        Mean time from the end of the dead time to the afterpulse [s].
    crosstalk_probability : float
        That an avalanche sets off a given one of the four nearest neighbours [1].
    jitter_sigma : float
        Standard deviation of the timing [s].
    max_counts_per_bin : int
        Where the counter of a bin is full.
    bin_width : float
        Of a bin [s].
    looks : tuple of Look
        When the array is armed; a frame's pulses are those of all looks.
    keep_tags : bool
        Whether readings carry the counts one by one.
    """

    quantum_efficiency: float
    fill_factor: float
    dark_count_rate: float
    dead_time: float
    afterpulse_probability: float
    afterpulse_lifetime: float
    crosstalk_probability: float
    jitter_sigma: float
    max_counts_per_bin: int
    bin_width: float
    looks: tuple[Look, ...]
    keep_tags: bool = False

    @property
    def photo_electrons_per_photon(self) -> float:
        """Avalanches that a photon behind the optics would start in a live pixel [1]."""
        return self.quantum_efficiency * self.fill_factor

    @property
    def timing_sigma(self) -> float:
        """Standard deviation of the timing [s]."""
        return self.jitter_sigma

    def read(self, light: FloatArray, chance: np.random.Generator) -> Readings:
        """Let the array fire through all pulses of one frame."""
        seeds = chance.integers(0, 1 << 64, size=light.shape[0] * light.shape[1], dtype=np.uint64)
        found, dead, number = self._fired(light, seeds, room=0)
        if self.keep_tags:
            found, dead, number = self._fired(light, seeds, room=number)
        counts = np.minimum(found.counts, self.max_counts_per_bin).reshape(light.shape)
        watched = sum(look.pulses * look.armed for look in self.looks)
        blind = (2 * dead > watched) | (counts >= self.max_counts_per_bin)
        tags = self._tags(found, light.shape[1]) if self.keep_tags else None
        return Readings(counts=counts, blind=blind, tags=tags)

    def mean(self, light: FloatArray) -> FloatArray:
        """Return the mean counts of one frame."""
        shape = light.shape
        steps = ceil(self.bin_width / self.dead_time) if self.dead_time > 0.0 else 1
        total = np.zeros((shape[2], shape[0] * shape[1]))
        for look in self.looks:
            armed = np.ascontiguousarray(look.armed.reshape(-1, shape[2]).T)
            by_bin = np.ascontiguousarray((light * look.armed).reshape(-1, shape[2]).T)
            total += look.pulses * mean_avalanches(by_bin, armed, self._diodes(shape), steps)
        counts = np.ascontiguousarray(total.T).reshape(shape)
        return spread(counts, sigma=self.jitter_sigma / self.bin_width)

    def scatter(self, light: FloatArray, mean: FloatArray) -> Scatter:
        """Counts scatter as Poisson's or less: dead time only evens them out.

        Afterpulses widen: counts come in clusters of geometric size, whose variance over mean is
        (1 + p) / (1 - p) where they all fall into one gate.
        """
        p = self.afterpulse_probability
        return Scatter(
            mean=mean,
            gain_variance=np.full(light.shape, 2.0 * p / (1.0 - p)),
            added_variance=np.zeros(light.shape),
        )

    def added(self, light: FloatArray, more: FloatArray, mean: FloatArray) -> FloatArray:
        """Return how much the mean counts change; more light may blind a pixel for later light."""
        return self.mean(np.maximum(light + more, 0.0)) - mean

    def _fired(
        self, light: FloatArray, seeds: NDArray[np.uint64], *, room: int
    ) -> tuple[Found, NDArray[np.int32], int]:
        """Fire all looks, with longer lists of candidates until they suffice.

        Returns what was found, in how many armed pulses each pixel was dead in each bin, and the
        number of counts.
        """
        length = 4 * seeds.size + 64
        while True:
            fired = self._fired_with(light, seeds.copy(), room, length)
            if fired is not None:
                return fired
            length *= 4

    def _fired_with(
        self, light: FloatArray, state: NDArray[np.uint64], room: int, length: int
    ) -> tuple[Found, NDArray[np.int32], int] | None:
        pixels, bins = state.size, light.shape[2]
        counts, dead = np.zeros((pixels, bins), np.int32), np.zeros(light.shape, np.int32)
        tags = np.empty(room, np.int32), np.empty(room, np.int32), np.empty(room, np.float32)
        waiting = _candidates(bins, length)
        number, pulse = 0, 0
        for look in self.looks:
            photons = np.zeros((pixels, bins + 1))
            armed_light = (light * look.armed).reshape(pixels, bins) / self.quantum_efficiency
            np.cumsum(armed_light, axis=1, out=photons[:, 1:])
            found = Found(counts, np.zeros((pixels, bins + 1), np.int32), *tags)
            number = avalanches(
                found, photons, np.ascontiguousarray(look.armed.reshape(-1, bins)),
                self._diodes(light.shape), pulse, look.pulses, waiting, state, number,
            )  # fmt: skip
            if number == NOTHING:
                return None
            pulse += look.pulses
            dead += np.cumsum(found.deaths[:, :bins], axis=1).reshape(light.shape) * look.armed
        return found, dead, number

    def _diodes(self, shape: tuple[int, ...]) -> Diodes:
        return Diodes(
            rows=shape[0],
            columns=shape[1],
            efficiency=self.quantum_efficiency,
            dead_time=self.dead_time / self.bin_width,
            afterpulse_probability=self.afterpulse_probability,
            afterpulse_lifetime=self.afterpulse_lifetime / self.bin_width,
            crosstalk_probability=self.crosstalk_probability,
            jitter=self.jitter_sigma / self.bin_width,
        )

    def _tags(self, found: Found, columns: int) -> TimeTags:
        return TimeTags(
            row=found.tag_pixel // columns,
            column=found.tag_pixel % columns,
            pulse=found.tag_pulse,
            time=found.tag_time * np.float32(self.bin_width),
        )


def _candidates(bins: int, length: int) -> Candidates:
    return Candidates(
        first=np.empty(bins, np.int32),
        next=np.empty(length, np.int32),
        time=np.empty(length),
        pixel=np.empty(length, np.int32),
        kind=np.empty(length, np.int8),
    )

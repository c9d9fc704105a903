"""What every detector does: expected photo-electrons in, readings of every bin out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from survey.sensor.scatter import Scatter

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TimeTags:
    """Counts one by one, in no stated order; arrays (m,).

    Parameters
    ----------
    row, column : array
        Pixel.
    pulse : array
        Pulse of the frame's burst, from 0.
    time : array
        Time after the receiver's gate opens [s].
    """

    row: NDArray[np.int32]
    column: NDArray[np.int32]
    pulse: NDArray[np.int32]
    time: NDArray[np.float32]


@dataclass(frozen=True, kw_only=True)
class Readings:
    """What a detector puts out for one frame, all its pulses summed.

    Parameters
    ----------
    counts : array (rows, columns, bins)
        Whole counts, or a current as the photo-electrons that make it on average.
    blind : array (rows, columns, bins)
        Bins in which more light would not have read as more: a full counter, or a detector that
        was dead in more than half of the pulses.
    tags : TimeTags, optional
        The counts one by one, where the detector tells them and was asked to.
    """

    counts: NDArray[Any]
    blind: NDArray[np.bool_]
    tags: TimeTags | None = None


class Detector(Protocol):
    """A matrix of pixels behind the optics; arrays (rows, columns, bins)."""

    @property
    def photo_electrons_per_photon(self) -> float:
        """What the transport multiplies light by [1]."""

    @property
    def dark_count_rate(self) -> float:
        """Counts or electrons in the dark, per pixel [1/s]."""

    @property
    def timing_sigma(self) -> float:
        """Standard deviation by which the detector widens a pulse [s]."""

    def read(self, light: FloatArray, chance: np.random.Generator) -> Readings:
        """Draw the readings of one frame for the photo-electrons expected of one pulse."""

    def mean(self, light: FloatArray) -> FloatArray:
        """Return the mean readings of one frame."""

    def scatter(self, light: FloatArray, mean: FloatArray) -> Scatter:
        """Tell how the readings scatter about such a mean, which this light has."""

    def added(self, light: FloatArray, more: FloatArray, mean: FloatArray) -> FloatArray:
        """Return how much the mean readings grow from ``mean`` when more light comes on top."""

"""The two ways to look for the bottom in a flash's readings, by the name a scenario gives them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from survey.cloud.echo import Echo
from survey.cloud.matched import MatchedSearch
from survey.cloud.noise import NoiseModel, Readout
from survey.cloud.ranging import bottom_detection_probability, last_echo

FloatArray = NDArray[np.float64]


class BottomSearch(Protocol):
    """The search of one flash; arrays (rows, columns, bins)."""

    @classmethod
    def over(
        cls, *, noise: NoiseModel, variance: NDArray[np.floating], surface_time: FloatArray
    ) -> Self:
        """Prepare it: noise at the pose, squared Monte Carlo error, times to the water [s]."""

    def echo(self, counts: Readout) -> Echo:
        """Return the bottom's echo."""

    def probability(self, bottom: FloatArray) -> FloatArray:
        """Probability (rows, columns) that the light of a true bottom is found."""

    def without(self, light: FloatArray) -> Self:
        """Return the search over water that does not send back a part of its light."""


@dataclass(frozen=True, kw_only=True)
class ThresholdSearch:
    """The plain one: the last gate over the threshold of equation (11) of [Lisenko2017].

    Parameters
    ----------
    noise : NoiseModel
        With the doubt of the flash.
    surface_time : array (rows, columns)
        Two-way time to the water [s]; nan where a pixel sees none.
    """

    noise: NoiseModel
    surface_time: FloatArray

    @classmethod
    def over(
        cls, *, noise: NoiseModel, variance: NDArray[np.floating], surface_time: FloatArray
    ) -> ThresholdSearch:
        """Raise the thresholds by the doubt of the flash."""
        return cls(noise=noise.of_flash(variance), surface_time=surface_time)

    def echo(self, counts: Readout) -> Echo:
        """Return the last echo over the thresholds."""
        return last_echo(counts=counts, noise=self.noise, surface_time=self.surface_time)

    def probability(self, bottom: FloatArray) -> FloatArray:
        """Probability that the true echo's gate fires, equation (11)."""
        return bottom_detection_probability(bottom=bottom, noise=self.noise)

    def without(self, light: FloatArray) -> ThresholdSearch:
        """Return the search with the thresholds of the light that is left."""
        return replace(self, noise=self.noise.without(light))


SEARCHES: Mapping[str, type[BottomSearch]] = {
    "threshold": ThresholdSearch,
    "matched": MatchedSearch,
}

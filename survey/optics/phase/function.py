"""A phase function on a grid of angles: density, cumulative, sampler table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

SMALLEST_ANGLE = 1e-6
SAMPLER_CELLS = 1 << 16


def angle_grid() -> FloatArray:
    """Return the angles that every phase function is kept at, (12001,) [rad]."""
    peak = np.geomspace(SMALLEST_ANGLE, 0.1, 6000, endpoint=False)
    return np.concatenate([peak, np.linspace(0.1, np.pi, 6001)])


@dataclass(frozen=True, kw_only=True)
class PhaseFunction:
    """Scattering per solid angle, its integral over the sphere being one.

    Below the smallest angle of the grid the density follows the power law ``small_angle_slope``,
    whose integral is added in closed form.

    Parameters
    ----------
    name : str
        What it is called in reports.
    angle : array (n,)
        Scattering angles, ascending to pi [rad].
    density_on_grid : array (n,)
        Density at those angles [1/sr].
    small_angle_slope : float
        Exponent of the density below the first angle, above -2 [1].
    """

    name: str
    angle: FloatArray
    density_on_grid: FloatArray
    small_angle_slope: float

    @classmethod
    def from_function(
        cls, *, name: str, function: Callable[[FloatArray], FloatArray], small_angle_slope: float
    ) -> PhaseFunction:
        """Normalise any positive function of the angle [rad].

        Raises
        ------
        ValueError
            When the function is not positive or has no finite integral.
        """
        angle = angle_grid()
        values = np.asarray(function(angle), dtype=np.float64)
        if not small_angle_slope > -2.0:
            raise ValueError(f"{name}: small_angle_slope = {small_angle_slope:g}: must be above -2")
        shape = cls(
            name=name, angle=angle, density_on_grid=values, small_angle_slope=small_angle_slope
        )
        whole = shape.cumulative_on_grid[-1]
        if not (np.all(values > 0.0) and np.isfinite(whole)):
            raise ValueError(f"{name}: must be positive everywhere and have a finite integral")
        return cls(
            name=name,
            angle=angle,
            density_on_grid=values / whole,
            small_angle_slope=small_angle_slope,
        )

    @cached_property
    def cumulative_on_grid(self) -> FloatArray:
        """Integral of the density over the cone of each grid angle [1]."""
        weighted = 2.0 * np.pi * self.density_on_grid * np.sin(self.angle)
        steps = 0.5 * (weighted[1:] + weighted[:-1]) * np.diff(self.angle)
        core = weighted[0] * self.angle[0] / (2.0 + self.small_angle_slope)
        return np.asarray(core + np.concatenate([[0.0], np.cumsum(steps)]))

    def density(self, angle: ArrayLike) -> FloatArray:
        """Return the density at angles [rad], in 1/sr."""
        theta = np.asarray(angle, dtype=np.float64)
        inside = np.exp(
            np.interp(
                np.log(np.maximum(theta, SMALLEST_ANGLE)),
                np.log(self.angle),
                np.log(self.density_on_grid),
            )
        )
        core = np.maximum(theta, 1e-12) / self.angle[0]
        below = inside * core**self.small_angle_slope
        return np.asarray(np.where(theta < self.angle[0], below, inside))

    def fraction_within(self, angle: float) -> float:
        """Return the share of scattering into angles up to ``angle`` [rad]."""
        core = min(angle / self.angle[0], 1.0) ** (2.0 + self.small_angle_slope)
        return float(core * np.interp(angle, self.angle, self.cumulative_on_grid))

    @property
    def mean_cosine(self) -> float:
        """Mean cosine of the scattering angle [1]."""
        cumulative = self.cumulative_on_grid
        middle = np.cos(0.5 * (self.angle[1:] + self.angle[:-1]))
        return float(cumulative[0] + np.sum(middle * np.diff(cumulative)))

    @property
    def backscatter_fraction(self) -> float:
        """Share scattered by more than 90 degrees [1]."""
        return 1.0 - self.fraction_within(0.5 * np.pi)

    def sampler_table(self) -> FloatArray:
        """Return 1 - cos(angle) at evenly spaced cumulative values, (2^16 + 1,).

        Linear interpolation with a uniform random number between the entries samples the density;
        1 - cos is stored since it keeps the digits of small angles.
        """
        uniform = np.linspace(0.0, 1.0, SAMPLER_CELLS + 1)
        cumulative = self.cumulative_on_grid
        angle = np.interp(uniform, cumulative, self.angle)
        core = uniform < cumulative[0]
        exponent = 1.0 / (2.0 + self.small_angle_slope)
        angle[core] = self.angle[0] * (uniform[core] / cumulative[0]) ** exponent
        angle[-1] = np.pi
        return 2.0 * np.sin(0.5 * angle) ** 2

    def cosine_table(self, *, entries: int = 8193) -> FloatArray:
        """Return the density at evenly spaced cosines from -1 to 1 [1/sr], for wide angles."""
        return self.density(np.arccos(np.linspace(-1.0, 1.0, entries)))

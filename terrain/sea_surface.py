"""The mean sea surface, the waves on it, and the slopes that no waves resolve."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from terrain.tide import Tide

if TYPE_CHECKING:
    from terrain.waves import WaveField, WaveLattice

COX_MUNK_UPWIND_PER_SPEED = 3.16e-3
COX_MUNK_CROSSWIND_CALM = 0.003
COX_MUNK_CROSSWIND_PER_SPEED = 1.92e-3


@dataclass(frozen=True, kw_only=True)
class SeaSurface:
    """A sea with Gaussian facet slopes, level or with waves that are resolved.

    Parameters
    ----------
    level : float
        Mean water level in the vertical datum [m].
    upwind_slope_variance, crosswind_slope_variance : float
        Variance of the slope along and across the wind, of all waves that the wind makes [1].
    wind_from : float
        Direction the wind blows from, clockwise from grid north [rad].
    waves : WaveField, optional
        Waves that light meets one by one; without them the surface is level.
    whitecap_coverage : float
        Share of the surface that is white, a Lambertian reflector of `FOAM_REFLECTANCE` [1].
    tide : Tide, optional
        What `at` adds to the level; without it the level stays.
    """

    level: float
    upwind_slope_variance: float
    crosswind_slope_variance: float
    wind_from: float
    waves: WaveField | None = None
    whitecap_coverage: float = 0.0
    tide: Tide | None = None

    @classmethod
    def from_wind(
        cls,
        *,
        level: float,
        wind_speed: float,
        wind_from: float,
        waves: WaveField | None = None,
        whitecap_coverage: float = 0.0,
        tide: Tide | None = None,
    ) -> SeaSurface:
        """Return the surface that Cox and Munk (1954, clean sea) measured at a wind speed.

        Slope variance 3.16e-3 U upwind and 0.003 + 1.92e-3 U crosswind, U at 12.5 m height.
        Below 1 m/s this is an extrapolation; at 0 the sea is a mirror (departure: the 0.003 of
        the regression is dropped there).

        Examples
        --------
        >>> sea = SeaSurface.from_wind(level=0.0, wind_speed=5.0, wind_from=0.0)
        >>> round(sea.slope_variance, 4)
        0.0284
        """
        calm = wind_speed == 0.0
        return cls(
            level=level,
            upwind_slope_variance=COX_MUNK_UPWIND_PER_SPEED * wind_speed,
            crosswind_slope_variance=0.0
            if calm
            else COX_MUNK_CROSSWIND_CALM + COX_MUNK_CROSSWIND_PER_SPEED * wind_speed,
            wind_from=wind_from,
            waves=waves,
            whitecap_coverage=whitecap_coverage,
            tide=tide,
        )

    def at(self, time: float) -> SeaSurface:
        """Return the sea at the level of a time [s], without a tide; its waves go on.

        Examples
        --------
        >>> tide = Tide(amplitude=1.0, period=44700.0, high_water=0.0)
        >>> sea = SeaSurface.from_wind(level=0.2, wind_speed=5.0, wind_from=0.0, tide=tide)
        >>> sea.at(0.0).level, round(sea.at(22350.0).level, 6)
        (1.2, -0.8)
        """
        if self.tide is None:
            return self
        return replace(self, level=self.level + self.tide.height(time), tide=None)

    @property
    def lowest_level(self) -> float:
        """Level at low water [m]."""
        return self.level - (0.0 if self.tide is None else self.tide.amplitude)

    @property
    def slope_variance(self) -> float:
        """Total slope variance of the waves that the wind makes [1]."""
        return self.upwind_slope_variance + self.crosswind_slope_variance

    @property
    def wave_height(self) -> float:
        """Significant height of the resolved waves and swell, 0 of a level sea [m]."""
        return 0.0 if self.waves is None else self.waves.significant_height

    @property
    def resolved_slope_variance(self) -> tuple[float, float]:
        """Expected slope variance of the resolved wind waves along and across the wind [1]."""
        if self.waves is None:
            return 0.0, 0.0
        return self.along_and_across(self.waves.wind_slope_covariance)

    def sheet(
        self, *, time: float, west: float, east: float, south: float, north: float
    ) -> WaveLattice:
        """Return the surface over a box [m] at a time [s]; level where there are no waves."""
        if self.waves is not None:
            return self.waves.lattice(
                time=time, level=self.level, west=west, east=east, south=south, north=north
            )
        from terrain.waves.lattice import build_lattice

        level = np.full((3, 3), self.level)
        return build_lattice(x0=west, y0=south, spacing=1.0, level=self.level, coefficients=level)

    def along_and_across(self, covariance: NDArray[np.float64]) -> tuple[float, float]:
        """Return the variances along and across the wind of slopes towards east and north."""
        along = np.array([np.sin(self.wind_from), np.cos(self.wind_from)])
        across = np.array([along[1], -along[0]])
        return float(along @ covariance @ along), float(across @ covariance @ across)

    @property
    def remaining_slope_variance(self) -> tuple[float, float]:
        """Slope variance along and across the wind that no resolved wave has, not below 0 [1].

        This is the roughness of the resolved waves' facets. Swell takes nothing from it: what Cox
        and Munk found goes with the local wind alone.
        """
        along, across = self.resolved_slope_variance
        return (
            max(self.upwind_slope_variance - along, 0.0),
            max(self.crosswind_slope_variance - across, 0.0),
        )

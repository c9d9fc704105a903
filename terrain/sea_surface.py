"""The mean sea surface and the slopes on it that no mesh resolves."""

from __future__ import annotations

from dataclasses import dataclass

COX_MUNK_UPWIND_PER_SPEED = 3.16e-3
COX_MUNK_CROSSWIND_CALM = 0.003
COX_MUNK_CROSSWIND_PER_SPEED = 1.92e-3


@dataclass(frozen=True, kw_only=True)
class SeaSurface:
    """A level sea with Gaussian facet slopes.

    Parameters
    ----------
    level : float
        Mean water level in the vertical datum [m].
    upwind_slope_variance, crosswind_slope_variance : float
        Variance of the slope along and across the wind [1].
    wind_from : float
        Direction the wind blows from, clockwise from grid north [rad].
    """

    level: float
    upwind_slope_variance: float
    crosswind_slope_variance: float
    wind_from: float

    @classmethod
    def from_wind(cls, *, level: float, wind_speed: float, wind_from: float) -> SeaSurface:
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
        )

    @property
    def slope_variance(self) -> float:
        """Total slope variance [1]."""
        return self.upwind_slope_variance + self.crosswind_slope_variance

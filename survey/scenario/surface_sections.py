"""The section [surface]: the water's level, the wind on it, and the waves that light meets."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from survey.scenario.sections import Bearing, Elevation, Positive, Section


class Waves(Section):
    """Waves of the section's wind, resolved from `shortest_m` up; shorter ones stay roughness.

    `fetch_km`, the distance to the lee shore, goes with "jonswap". After `patch_m` the waves repeat
    themselves.
    """

    spectrum: Literal["pierson_moskowitz", "jonswap"]
    """Fully developed, or limited by fetch."""
    fetch_km: Annotated[float, Field(ge=0.01, le=20_000.0)] | None = None
    """Distance to the lee shore, with `jonswap`."""
    shortest_m: Annotated[float, Field(ge=0.5, le=50.0)] = 2.0
    """Shortest wave that is resolved; what is shorter stays roughness."""
    patch_m: Positive = 512.0
    """Length after which wind waves repeat themselves."""


class Swell(Section):
    """Waves from far away: significant height and peak period."""

    height_m: Positive
    """Significant height."""
    period_s: Annotated[float, Field(ge=1.0, le=30.0)]
    """Period at the peak."""
    from_deg: Bearing
    """Direction from which it comes."""


class Tide(Section):
    """One constituent, M2 unless told; `high_water_h` counts from the mission's start."""

    amplitude_m: Annotated[float, Field(gt=0.0, le=10.0)]
    """Half the range."""
    period_h: Annotated[float, Field(ge=1.0, le=1000.0)] = 12.4206
    """Period; that of M2 unless told."""
    high_water_h: float = 0.0
    """High water after the mission's start."""


class Surface(Section):
    """The water level in the vertical datum, the wind, and the waves; without them it is level.

    The level is the mean one where there is a tide.
    `wave_depth_m` is the depth that waves feel; without one they run as over deep water.
    """

    water_level_m: Elevation
    """Mean water level in the vertical datum."""
    tide: Tide | None = None
    """Rise and fall about it."""
    wind_speed_m_s: Annotated[float, Field(ge=0.0, le=20.0)] = 5.0
    """Wind over the water, which makes its slopes."""
    wind_from_deg: Bearing = 0.0
    """Direction from which that wind comes."""
    whitecaps: bool = False
    """Whether foam covers the sea as the wind says."""
    wave_depth_m: Positive | None = None
    """Depth that waves feel; deep unless told."""
    waves: Waves | None = None
    """Waves of the wind, one by one; level unless told."""
    swell: list[Swell] = Field(default_factory=list)
    """Waves from far away."""

    @property
    def tidal_amplitude_m(self) -> float:
        """How far the water rises and falls about its mean level."""
        return 0.0 if self.tide is None else self.tide.amplitude_m

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
    fetch_km: Annotated[float, Field(ge=0.01, le=20_000.0)] | None = None
    shortest_m: Annotated[float, Field(ge=0.5, le=50.0)] = 2.0
    patch_m: Positive = 512.0


class Swell(Section):
    """Waves from far away: significant height and peak period."""

    height_m: Positive
    period_s: Annotated[float, Field(ge=1.0, le=30.0)]
    from_deg: Bearing


class Tide(Section):
    """One constituent, M2 unless told; `high_water_h` counts from the mission's start."""

    amplitude_m: Annotated[float, Field(gt=0.0, le=10.0)]
    period_h: Annotated[float, Field(ge=1.0, le=1000.0)] = 12.4206
    high_water_h: float = 0.0


class Surface(Section):
    """The water level in the vertical datum, the wind, and the waves; without them it is level.

    The level is the mean one where there is a tide.
    `wave_depth_m` is the depth that waves feel; without one they run as over deep water.
    """

    water_level_m: Elevation
    tide: Tide | None = None
    wind_speed_m_s: Annotated[float, Field(ge=0.0, le=20.0)] = 5.0
    wind_from_deg: Bearing = 0.0
    whitecaps: bool = False
    wave_depth_m: Positive | None = None
    waves: Waves | None = None
    swell: list[Swell] = Field(default_factory=list)

    @property
    def tidal_amplitude_m(self) -> float:
        """How far the water rises and falls about its mean level."""
        return 0.0 if self.tide is None else self.tide.amplitude_m

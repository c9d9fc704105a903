"""The section [surface] turned into a sea, in SI units and radians.

`terrain.waves` is imported when waves are asked for, so that checking a scenario stays quick.
"""

from __future__ import annotations

from math import inf, radians
from typing import TYPE_CHECKING

from survey.scenario.surface_sections import Surface, Waves

if TYPE_CHECKING:
    from terrain.sea_surface import SeaSurface
    from terrain.tide import Tide
    from terrain.waves import WaveField, WindSea

KILO = 1e3
HOUR = 3600.0
WAVES = 8  # purpose of random numbers, beside those of `survey.transport.random`


def build_sea(given: Surface, *, seed: int) -> SeaSurface:
    """Return the sea of a section; one seed makes one realisation of its waves."""
    from terrain.sea_surface import SeaSurface
    from terrain.waves.whitecaps import whitecap_coverage

    return SeaSurface.from_wind(
        level=given.water_level_m,
        wind_speed=given.wind_speed_m_s,
        wind_from=radians(given.wind_from_deg),
        waves=_waves(given, seed) if given.waves or given.swell else None,
        whitecap_coverage=whitecap_coverage(given.wind_speed_m_s) if given.whitecaps else 0.0,
        tide=_tide(given),
    )


def _tide(given: Surface) -> Tide | None:
    from terrain.tide import Tide

    if given.tide is None:
        return None
    return Tide(
        amplitude=given.tide.amplitude_m,
        period=given.tide.period_h * HOUR,
        high_water=given.tide.high_water_h * HOUR,
    )


def wind_sea(given: Surface) -> WindSea | None:
    """Return the spectrum of the wind's waves; None where none are resolved."""
    if given.waves is None:
        return None
    from terrain.waves import WindSea

    if given.waves.spectrum == "pierson_moskowitz" or given.waves.fetch_km is None:
        return WindSea.fully_developed(wind_speed=given.wind_speed_m_s)
    return WindSea.fetch_limited(wind_speed=given.wind_speed_m_s, fetch=given.waves.fetch_km * KILO)


def wave_depth(given: Surface) -> float:
    """Return the depth that waves feel [m]."""
    return inf if given.wave_depth_m is None else given.wave_depth_m


def resolution(given: Surface) -> Waves:
    """Return the section's waves, or those whose resolution swell alone has."""
    return given.waves or Waves(spectrum="pierson_moskowitz")


def _waves(given: Surface, seed: int) -> WaveField:
    from survey.transport.random import chance
    from terrain.waves import Swell, WaveField

    return WaveField.realised(
        wind_sea=wind_sea(given),
        wind_from=radians(given.wind_from_deg),
        swell=[
            Swell(height=one.height_m, period=one.period_s, comes_from=radians(one.from_deg))
            for one in given.swell
        ],
        depth=wave_depth(given),
        shortest=resolution(given).shortest_m,
        patch=resolution(given).patch_m,
        chance=chance(seed=seed, purpose=WAVES, frame=0),
    )

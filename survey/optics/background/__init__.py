"""Light of the sun that reaches the receiver, after [Lisenko2017] equations (1) to (7).

[Lisenko2017]: A. A. Lisenko, A. I. Potekaev, V. S. Shamanaev, "Statistical estimates of the signals
of a lidar with a matrix photodetector reflected from the sea bottom", Russian Physics Journal
(2017). Beside it stands sun glint by the slopes of Cox and Munk (1954).
"""

from survey.optics.background.glint import CoxMunkGlint, reflected_skylight, sun_glint, sunbeam
from survey.optics.background.receiver import background_power, round_field
from survey.optics.background.sky import Sky
from survey.optics.background.terms import (
    haze_radiance,
    high_flight_radiance,
    low_flight_radiance,
    surface_brightness,
    surface_irradiance,
    surface_radiance,
    water_radiance,
)

__all__ = [
    "CoxMunkGlint",
    "Sky",
    "background_power",
    "haze_radiance",
    "high_flight_radiance",
    "low_flight_radiance",
    "reflected_skylight",
    "round_field",
    "sun_glint",
    "sunbeam",
    "surface_brightness",
    "surface_irradiance",
    "surface_radiance",
    "water_radiance",
]

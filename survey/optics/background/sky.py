"""Sun, air and sea together."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal

from survey.optics.background.glint import CoxMunkGlint
from survey.optics.background.terms import (
    haze_radiance,
    high_flight_radiance,
    low_flight_radiance,
    surface_brightness,
    surface_irradiance,
    surface_radiance,
    water_radiance,
)


@dataclass(frozen=True, kw_only=True)
class Sky:
    """Sun, sky and sea as a receiver sees them at nadir.

    Parameters
    ----------
    zenith, solar_irradiance, optical_thickness, legendre_moment
        See `survey.optics.background.surface_irradiance`.
    wind_speed : float
        Wind [m/s].
    water_reflectance : float
        Brightness coefficient rho_s of the water's own light [1].
    model : {"low_flight", "high_flight", "layered"}
        Equation (6), equation (7), or the sum of (2), (3) and (4).
    layer_thickness : float
        Optical thickness tau of the air below the receiver, for "layered" [1].
    glint : CoxMunkGlint, optional
        How the surface reflects; without it the numbers that the paper prints.

    Raises
    ------
    ValueError
        A line for each quantity out of bounds.
    """

    zenith: float
    wind_speed: float
    optical_thickness: float
    solar_irradiance: float
    legendre_moment: float
    water_reflectance: float
    model: Literal["low_flight", "high_flight", "layered"] = "low_flight"
    layer_thickness: float = 0.0
    glint: CoxMunkGlint | None = None

    def __post_init__(self) -> None:
        faults = [
            f"sky: {name} = {getattr(self, name):g}: must {rule}"
            for name, good, rule in (
                ("zenith", 0.0 <= self.zenith < 0.5 * pi, "be 0 to below pi/2"),
                ("wind_speed", self.wind_speed >= 0.0, "not be negative"),
                ("optical_thickness", self.optical_thickness >= 0.0, "not be negative"),
                ("solar_irradiance", self.solar_irradiance >= 0.0, "not be negative"),
                ("legendre_moment", abs(self.legendre_moment) <= 3.0, "be -3 to 3"),
                ("water_reflectance", self.water_reflectance >= 0.0, "not be negative"),
                (
                    "layer_thickness",
                    0.0 <= self.layer_thickness <= self.optical_thickness,
                    f"be 0 to optical_thickness {self.optical_thickness:g}",
                ),
            )
            if not good
        ]
        if faults:
            raise ValueError("\n".join(faults))

    @property
    def irradiance(self) -> float:
        """Irradiance E of the sea, equation (5) of [Lisenko2017] [W/m3]."""
        return surface_irradiance(
            zenith=self.zenith,
            solar_irradiance=self.solar_irradiance,
            optical_thickness=self.optical_thickness,
            legendre_moment=self.legendre_moment,
        )

    @property
    def brightness(self) -> float:
        """Brightness coefficient rho_sf of the surface, the paper's or Cox and Munk's [1]."""
        if self.glint is None:
            return surface_brightness(self.wind_speed)
        return self.glint.brightness(
            zenith=self.zenith,
            optical_thickness=self.optical_thickness,
            legendre_moment=self.legendre_moment,
        )

    def radiance(self) -> float:
        """Spectral radiance L_b towards the receiver by the chosen model [W/(m3 sr)].

        Examples
        --------
        >>> sky = Sky(zenith=0.349066, wind_speed=5.0, optical_thickness=0.3,
        ...           solar_irradiance=1.95e9, legendre_moment=1.5, water_reflectance=0.0097)
        >>> round(sky.radiance() * 1e-6, 1)  # W/(m2 um sr)
        51.8
        """
        return {
            "low_flight": self._low_flight,
            "high_flight": self._high_flight,
            "layered": self._layered,
        }[self.model]()

    def _low_flight(self) -> float:
        return low_flight_radiance(
            irradiance=self.irradiance,
            water_reflectance=self.water_reflectance,
            brightness=self.brightness,
        )

    def _high_flight(self) -> float:
        return high_flight_radiance(
            zenith=self.zenith,
            solar_irradiance=self.solar_irradiance,
            optical_thickness=self.optical_thickness,
            irradiance=self.irradiance,
            water_reflectance=self.water_reflectance,
            brightness=self.brightness,
        )

    def _layered(self) -> float:
        haze = haze_radiance(
            zenith=self.zenith,
            solar_irradiance=self.solar_irradiance,
            optical_thickness=self.optical_thickness,
            layer_thickness=self.layer_thickness,
        )
        water = water_radiance(
            irradiance=self.irradiance,
            water_reflectance=self.water_reflectance,
            layer_thickness=self.layer_thickness,
        )
        surface = surface_radiance(
            irradiance=self.irradiance,
            brightness=self.brightness,
            layer_thickness=self.layer_thickness,
        )
        return haze + water + surface

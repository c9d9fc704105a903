"""The section [water]: the ways to state a water, in layers or as a profile."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from survey.scenario.phase_sections import AVERAGE_PARTICLE, AnyPhase, PetzoldType
from survey.scenario.sections import NotNegative, Positive, Section, Text

Coefficient = Annotated[float, Field(ge=0.0, le=1000.0)]
PositiveCoefficient = Annotated[float, Field(gt=0.0, le=1000.0)]
Chlorophyll = Annotated[float, Field(ge=0.0, le=1000.0)]
Salinity = Annotated[float, Field(ge=0.0, le=45.0)]
Temperature = Annotated[float, Field(ge=-2.0, le=40.0)]
RefractiveIndex = Annotated[float, Field(ge=1.0, le=2.0)]


class Water(Section):
    """What every way to state a water has, be it in [water] or in a layer."""

    type: str


class PetzoldWater(Water):
    """A measured water; coefficients and phase function may be replaced."""

    type: PetzoldType
    absorption_per_m: Coefficient | None = None
    """Absorption, in place of the measured one."""
    scattering_per_m: Coefficient | None = None
    """Scattering, in place of the measured one."""
    phase_function: AnyPhase | None = None
    """Phase function, in place of the measured one."""


class StatedWater(Water):
    """Any water, by its coefficients at the laser's wavelength."""

    type: Literal["stated"]
    absorption_per_m: PositiveCoefficient
    """Absorption at the laser's wavelength."""
    scattering_per_m: PositiveCoefficient
    """Scattering at the laser's wavelength."""
    phase_function: AnyPhase = AVERAGE_PARTICLE
    """How it scatters."""


class MolecularPart(Water):
    """Waters that begin with pure water; the phase function is that of the particles in it."""

    salinity_psu: Salinity = 35.0
    """Salinity of the pure sea water."""
    temperature_degc: Temperature = 20.0
    """Its temperature."""
    phase_function: AnyPhase = AVERAGE_PARTICLE
    """Phase function of the particles."""


class ComponentsWater(MolecularPart):
    """Pure water, chlorophyll with its particles, yellow substance.

    Without `particle_scattering_550_per_m` the particles scatter as chlorophyll says.
    """

    type: Literal["components"]
    pure_absorption: Literal["pope_fry", "smith_baker", "paper"] = "pope_fry"
    """Whose absorption of pure water."""
    pure_scattering: Literal["zhang", "morel", "paper"] = "zhang"
    """Whose scattering of pure sea water."""
    chlorophyll_mg_m3: Chlorophyll = 0.0
    """Chlorophyll, with its absorption and, unless told, its particles."""
    particle_scattering: Literal["gordon_morel", "loisel_morel"] = "gordon_morel"
    """Whose relation gives the particles' scattering from chlorophyll."""
    particle_scattering_550_per_m: Coefficient | None = None
    """Scattering of the particles at 550 nm, in place of that relation."""
    yellow_absorption_440_per_m: Coefficient = 0.0
    """Absorption of yellow substance at 440 nm."""
    yellow_slope_per_nm: Annotated[float, Field(gt=0.0, le=0.1)] = 0.014
    """How fast that falls towards red."""


class SurveyedWater(MolecularPart):
    """What surveyors measure, one figure; the rest is a mixture that goes with chlorophyll.

    `estimate` takes the figure's relation at an end of its published spread, towards clear
    ("low") or turbid ("high") water; `particle_scattering_factor` varies the mixture.
    """

    type: Literal["surveyed"]
    secchi_depth_m: Positive | None = None
    """Depth at which a Secchi disc vanishes."""
    kd_490_per_m: Positive | None = None
    """Diffuse attenuation at 490 nm."""
    turbidity_ntu: Positive | None = None
    """Turbidity."""
    secchi_relation: Literal["tyler", "lee"] = "tyler"
    """Whose relation from Secchi depth to the water."""
    estimate: Literal["low", "central", "high"] = "central"
    """End of the relation's published spread: `low` towards clear, `high` towards turbid water."""
    particle_scattering_factor: Annotated[float, Field(ge=0.05, le=1.0)] = 0.30
    """Scattering of the particles for each unit of chlorophyll to the power 0.62, at 550 nm."""
    measured_sun_zenith_deg: Annotated[float, Field(ge=0.0, le=75.0)] = 30.0
    """Angle of the sun off the zenith when it was measured."""


class Depths(Section):
    """Where a layer lies under mean level; without an end it goes down to the bottom."""

    from_depth_m: NotNegative
    """Top of the layer under the level water."""
    to_depth_m: Positive | None = None
    """Its lower end; unless told, the bottom."""


class PetzoldLayer(Depths, PetzoldWater):
    """A layer of a measured water."""


class StatedLayer(Depths, StatedWater):
    """A layer by its coefficients."""


class ComponentsLayer(Depths, ComponentsWater):
    """A layer by what is in it."""


class SurveyedLayer(Depths, SurveyedWater):
    """A layer by a surveyor's figure."""


FIGURES = ("secchi_depth_m", "kd_490_per_m", "turbidity_ntu")
CONSTITUENTS = (
    "chlorophyll_mg_m3",
    "yellow_absorption_440_per_m",
    "particle_scattering_550_per_m",
)
COEFFICIENTS = ("absorption_per_m", "scattering_per_m")
WAYS_TO_STATE_A_WATER = (
    "Say clear, coastal or harbor, or give secchi_depth_m, kd_490_per_m or turbidity_ntu, "
    "or chlorophyll_mg_m3, or absorption_per_m and scattering_per_m, "
    "or the profile of a cast."
)
TELLING_KEYS = {
    "profiled": ("profile",),
    "surveyed": FIGURES,
    "components": CONSTITUENTS,
    "stated": COEFFICIENTS,
}


def _with_type(given: Any) -> Any:
    """Where the type is not said, the keys tell it."""
    if isinstance(given, Mapping) and "type" not in given:
        for kind, keys in TELLING_KEYS.items():
            if any(key in given for key in keys):
                return {"type": kind, **given}
    return given


AnyLayer = Annotated[
    PetzoldLayer | StatedLayer | ComponentsLayer | SurveyedLayer,
    Field(discriminator="type"),
    BeforeValidator(_with_type),
]


class WaterSection(Section):
    """What every section [water] has: how light runs in it, and layers of other water."""

    type: str
    refractive_index: RefractiveIndex = 1.3415
    """Phase index, by which light bends."""
    group_index: RefractiveIndex = 1.36
    """Group index, by which time is told."""
    layers: list[AnyLayer] = Field(default_factory=list)
    """Layers of other water."""


class PetzoldSection(PetzoldWater, WaterSection):
    """A measured water around the layers."""


class StatedSection(StatedWater, WaterSection):
    """Water by its coefficients around the layers."""


class ComponentsSection(ComponentsWater, WaterSection):
    """Water by what is in it around the layers."""


class SurveyedSection(SurveyedWater, WaterSection):
    """Water by a surveyor's figure around the layers."""


class Profile(Section):
    """A CSV file with columns ``depth_m``, ``absorption_per_m``, ``scattering_per_m``.

    And perhaps ``backscatter_fraction``, by which each depth has its own phase function.
    """

    file: Text
    """The cast's CSV file."""


def _file_alone(given: Any) -> Any:
    """A text alone stands for the file."""
    return {"file": given} if isinstance(given, str) else given


class ProfiledSection(WaterSection):
    """Water measured from depth to depth; the phase function is for files that say none."""

    type: Literal["profiled"]
    profile: Annotated[Profile, BeforeValidator(_file_alone)]
    """The cast: its file's name alone, or a table."""
    phase_function: AnyPhase = AVERAGE_PARTICLE
    """Phase function at all depths, where the file has no `backscatter_fraction`."""


AnyWater = Annotated[
    PetzoldSection | StatedSection | ComponentsSection | SurveyedSection | ProfiledSection,
    Field(discriminator="type"),
    BeforeValidator(_with_type),
]


def topmost(water: WaterSection) -> Section:
    """Return what states the water right under the surface: a layer there, or the section."""
    return next((layer for layer in water.layers if layer.from_depth_m == 0.0), water)

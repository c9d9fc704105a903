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
    scattering_per_m: Coefficient | None = None
    phase_function: AnyPhase | None = None


class StatedWater(Water):
    """Any water, by its coefficients at the laser's wavelength."""

    type: Literal["stated"]
    absorption_per_m: PositiveCoefficient
    scattering_per_m: PositiveCoefficient
    phase_function: AnyPhase = AVERAGE_PARTICLE


class MolecularPart(Water):
    """Waters that begin with pure water; the phase function is that of the particles in it."""

    salinity_psu: Salinity = 35.0
    temperature_degc: Temperature = 20.0
    phase_function: AnyPhase = AVERAGE_PARTICLE


class ComponentsWater(MolecularPart):
    """Pure water, chlorophyll with its particles, yellow substance.

    Without `particle_scattering_550_per_m` the particles scatter as chlorophyll says.
    """

    type: Literal["components"]
    pure_absorption: Literal["pope_fry", "smith_baker", "paper"] = "pope_fry"
    pure_scattering: Literal["zhang", "morel", "paper"] = "zhang"
    chlorophyll_mg_m3: Chlorophyll = 0.0
    particle_scattering: Literal["gordon_morel", "loisel_morel"] = "gordon_morel"
    particle_scattering_550_per_m: Coefficient | None = None
    yellow_absorption_440_per_m: Coefficient = 0.0
    yellow_slope_per_nm: Annotated[float, Field(gt=0.0, le=0.1)] = 0.014


class SurveyedWater(MolecularPart):
    """What surveyors measure, one figure; the rest is a mixture that goes with chlorophyll.

    `estimate` takes the figure's relation at an end of its published spread, towards clear
    ("low") or turbid ("high") water; `particle_scattering_factor` varies the mixture.
    """

    type: Literal["surveyed"]
    secchi_depth_m: Positive | None = None
    kd_490_per_m: Positive | None = None
    turbidity_ntu: Positive | None = None
    secchi_relation: Literal["tyler", "lee"] = "tyler"
    estimate: Literal["low", "central", "high"] = "central"
    particle_scattering_factor: Annotated[float, Field(ge=0.05, le=1.0)] = 0.30
    measured_sun_zenith_deg: Annotated[float, Field(ge=0.0, le=75.0)] = 30.0


class Depths(Section):
    """Where a layer lies under mean level; without an end it goes down to the bottom."""

    from_depth_m: NotNegative
    to_depth_m: Positive | None = None


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
    group_index: RefractiveIndex = 1.36
    layers: list[AnyLayer] = Field(default_factory=list)


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


def _file_alone(given: Any) -> Any:
    """A text alone stands for the file."""
    return {"file": given} if isinstance(given, str) else given


class ProfiledSection(WaterSection):
    """Water measured from depth to depth; the phase function is for files that say none."""

    type: Literal["profiled"]
    profile: Annotated[Profile, BeforeValidator(_file_alone)]
    phase_function: AnyPhase = AVERAGE_PARTICLE


AnyWater = Annotated[
    PetzoldSection | StatedSection | ComponentsSection | SurveyedSection | ProfiledSection,
    Field(discriminator="type"),
    BeforeValidator(_with_type),
]


def topmost(water: WaterSection) -> Section:
    """Return what states the water right under the surface: a layer there, or the section."""
    return next((layer for layer in water.layers if layer.from_depth_m == 0.0), water)

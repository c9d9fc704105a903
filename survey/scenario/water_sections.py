"""The section [water]: the ways to state a water, and the phase functions it may have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from survey.scenario.sections import Positive, Section, Text, Water

Asymmetry = Annotated[float, Field(ge=-0.98, le=0.99999)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Coefficient = Annotated[float, Field(ge=0.0, le=1000.0)]
PositiveCoefficient = Annotated[float, Field(gt=0.0, le=1000.0)]
Chlorophyll = Annotated[float, Field(ge=0.0, le=1000.0)]
PetzoldType = Literal["clear", "coastal", "harbor"]
Salinity = Annotated[float, Field(ge=0.0, le=45.0)]
Temperature = Annotated[float, Field(ge=-2.0, le=40.0)]


class PhaseFunctionSection(Section):
    """What every phase function has."""

    kind: str


class PetzoldPhase(PhaseFunctionSection):
    """Petzold's measured function of a water; by default that of the water's own type."""

    kind: Literal["petzold"]
    type: PetzoldType


class AverageParticlePhase(PhaseFunctionSection):
    """Mobley's average of Petzold's particles."""

    kind: Literal["average_particle"]
    edition: Literal["web book", "mobley 1993"] = "web book"


class FournierForandPhase(PhaseFunctionSection):
    """Particles by index and slope of their sizes, or by their backscatter fraction alone."""

    kind: Literal["fournier_forand"]
    particle_index: Annotated[float, Field(ge=1.001, le=1.35)] | None = None
    size_slope: Annotated[float, Field(ge=3.01, le=4.99)] | None = None
    backscatter_fraction: Annotated[float, Field(gt=0.0, lt=0.5)] | None = None


class HenyeyGreensteinPhase(PhaseFunctionSection):
    """One parameter; for benchmarks."""

    kind: Literal["henyey_greenstein"]
    asymmetry: Asymmetry


class TwoTermPhase(PhaseFunctionSection):
    """Two functions of Henyey and Greenstein; for benchmarks."""

    kind: Literal["two_term"]
    forward_share: Share
    forward_asymmetry: Asymmetry
    backward_asymmetry: Asymmetry


class MolecularPhase(PhaseFunctionSection):
    """Water itself."""

    kind: Literal["molecular"]
    depolarisation: Share = 0.039


class TablePhase(PhaseFunctionSection):
    """A CSV file with the header ``angle_deg,value``."""

    kind: Literal["table"]
    file: Text
    small_angle_slope: Annotated[float, Field(gt=-2.0)] | None = None


def _short_form(given: Any) -> Any:
    """A word alone stands for the kind."""
    return {"kind": given} if isinstance(given, str) else given


PlainKinds = (
    PetzoldPhase
    | AverageParticlePhase
    | FournierForandPhase
    | HenyeyGreensteinPhase
    | TwoTermPhase
    | MolecularPhase
    | TablePhase
)
PlainPhase = Annotated[PlainKinds, Field(discriminator="kind"), BeforeValidator(_short_form)]


class PhaseShare(Section):
    """One of the phase functions of a mixture, with its share of all scattering."""

    scattering_fraction: Annotated[float, Field(gt=0.0, le=1.0)]
    phase_function: PlainPhase


class MixturePhase(PhaseFunctionSection):
    """Components that scatter side by side; their shares add up to 1."""

    kind: Literal["mixture"]
    components: list[PhaseShare] = Field(min_length=1)


AnyPhase = Annotated[
    PlainKinds | MixturePhase, Field(discriminator="kind"), BeforeValidator(_short_form)
]
AVERAGE_PARTICLE = AverageParticlePhase(kind="average_particle")


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


FIGURES = ("secchi_depth_m", "kd_490_per_m", "turbidity_ntu")
CONSTITUENTS = (
    "chlorophyll_mg_m3",
    "yellow_absorption_440_per_m",
    "particle_scattering_550_per_m",
)
COEFFICIENTS = ("absorption_per_m", "scattering_per_m")
WAYS_TO_STATE_A_WATER = (
    "Say clear, coastal or harbor, or give secchi_depth_m, kd_490_per_m or turbidity_ntu, "
    "or chlorophyll_mg_m3, or absorption_per_m and scattering_per_m."
)
TELLING_KEYS = {"surveyed": FIGURES, "components": CONSTITUENTS, "stated": COEFFICIENTS}


def _with_type(given: Any) -> Any:
    """Where the type is not said, the keys tell it."""
    if isinstance(given, Mapping) and "type" not in given:
        for kind, keys in TELLING_KEYS.items():
            if any(key in given for key in keys):
                return {"type": kind, **given}
    return given


AnyWater = Annotated[
    PetzoldWater | StatedWater | ComponentsWater | SurveyedWater,
    Field(discriminator="type"),
    BeforeValidator(_with_type),
]

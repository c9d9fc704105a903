"""The phase functions that a water may have, as tables of a scenario."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from survey.scenario.sections import Section, Text

Asymmetry = Annotated[float, Field(ge=-0.98, le=0.99999)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
PetzoldType = Literal["clear", "coastal", "harbor"]


class PhaseFunctionSection(Section):
    """What every phase function has."""

    kind: str


class PetzoldPhase(PhaseFunctionSection):
    """Petzold's measured function of a water; by default that of the water's own type."""

    kind: Literal["petzold"]
    type: PetzoldType
    """Which of the waters."""


class AverageParticlePhase(PhaseFunctionSection):
    """Mobley's average of Petzold's particles."""

    kind: Literal["average_particle"]
    edition: Literal["web book", "mobley 1993"] = "web book"
    """Which printed table."""


class FournierForandPhase(PhaseFunctionSection):
    """Particles by index and slope of their sizes, or by their backscatter fraction alone."""

    kind: Literal["fournier_forand"]
    particle_index: Annotated[float, Field(ge=1.001, le=1.35)] | None = None
    """Refractive index of the particles relative to water."""
    size_slope: Annotated[float, Field(ge=3.01, le=4.99)] | None = None
    """Slope mu of the particles' size distribution."""
    backscatter_fraction: Annotated[float, Field(gt=0.0, lt=0.5)] | None = None
    """Backscattering over scattering, in place of both."""


class HenyeyGreensteinPhase(PhaseFunctionSection):
    """One parameter; for benchmarks."""

    kind: Literal["henyey_greenstein"]
    asymmetry: Asymmetry
    """Mean cosine g."""


class TwoTermPhase(PhaseFunctionSection):
    """Two functions of Henyey and Greenstein; for benchmarks."""

    kind: Literal["two_term"]
    forward_share: Share
    """Share of the first function."""
    forward_asymmetry: Asymmetry
    """Mean cosine of the first."""
    backward_asymmetry: Asymmetry
    """Mean cosine of the second."""


class MolecularPhase(PhaseFunctionSection):
    """Water itself."""

    kind: Literal["molecular"]
    depolarisation: Share = 0.039
    """Depolarisation ratio."""


class TablePhase(PhaseFunctionSection):
    """A CSV file with the header ``angle_deg,value``."""

    kind: Literal["table"]
    file: Text
    """The CSV file."""
    small_angle_slope: Annotated[float, Field(gt=-2.0)] | None = None
    """Power of the angle by which values go on below the first row."""


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
    """Its share of all scattering."""
    phase_function: PlainPhase
    """The function."""


class MixturePhase(PhaseFunctionSection):
    """Components that scatter side by side; their shares add up to 1."""

    kind: Literal["mixture"]
    components: list[PhaseShare] = Field(min_length=1)
    """The functions with their shares."""


AnyPhase = Annotated[
    PlainKinds | MixturePhase, Field(discriminator="kind"), BeforeValidator(_short_form)
]
AVERAGE_PARTICLE = AverageParticlePhase(kind="average_particle")

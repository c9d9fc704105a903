"""Phase functions of scattering: density, cumulative, sampler table."""

from survey.optics.phase.closed_forms import (
    henyey_greenstein,
    molecular,
    two_term_henyey_greenstein,
)
from survey.optics.phase.fournier_forand import (
    backscatter_reach,
    fournier_forand,
    fournier_forand_of_backscatter,
)
from survey.optics.phase.function import PhaseFunction
from survey.optics.phase.measured import average_particle, petzold, petzold_scattering
from survey.optics.phase.mixture import mixture
from survey.optics.phase.table import read_phase_function, tabled_phase_function

__all__ = [
    "PhaseFunction",
    "average_particle",
    "backscatter_reach",
    "fournier_forand",
    "fournier_forand_of_backscatter",
    "henyey_greenstein",
    "mixture",
    "molecular",
    "petzold",
    "petzold_scattering",
    "read_phase_function",
    "tabled_phase_function",
    "two_term_henyey_greenstein",
]

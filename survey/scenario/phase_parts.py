"""Tables of phase functions turned into phase functions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from survey.scenario import phase_sections as kinds

if TYPE_CHECKING:
    from survey.optics.phase import PhaseFunction


def build_phase_function(given: kinds.PhaseFunctionSection, *, folder: Path) -> PhaseFunction:
    """Return the phase function that a table states.

    Raises
    ------
    ValueError
        When its file cannot be used or its numbers make no phase function.
    """
    from survey.optics import phase

    match given:
        case kinds.PetzoldPhase():
            return phase.petzold(given.type)
        case kinds.AverageParticlePhase():
            return phase.average_particle(given.edition)
        case kinds.FournierForandPhase():
            return _fournier_forand(given)
        case kinds.HenyeyGreensteinPhase():
            return phase.henyey_greenstein(given.asymmetry)
        case kinds.TwoTermPhase():
            return phase.two_term_henyey_greenstein(
                forward_share=given.forward_share,
                forward_asymmetry=given.forward_asymmetry,
                backward_asymmetry=given.backward_asymmetry,
            )
        case kinds.MolecularPhase():
            return phase.molecular(given.depolarisation)
        case kinds.TablePhase():
            return phase.read_phase_function(
                folder / given.file, small_angle_slope=given.small_angle_slope
            )
    assert isinstance(given, kinds.MixturePhase)
    return phase.mixture(
        [
            (build_phase_function(part.phase_function, folder=folder), part.scattering_fraction)
            for part in given.components
        ]
    )


def _fournier_forand(given: kinds.FournierForandPhase) -> PhaseFunction:
    from survey.optics import phase

    if given.backscatter_fraction is not None:
        return phase.fournier_forand_of_backscatter(given.backscatter_fraction)
    assert given.particle_index is not None
    assert given.size_slope is not None
    return phase.fournier_forand(particle_index=given.particle_index, size_slope=given.size_slope)

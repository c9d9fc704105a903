"""Why a phase function cannot be made."""

from __future__ import annotations

from collections.abc import Iterator
from math import fsum
from pathlib import Path

from survey.scenario import phase_sections as kinds
from survey.scenario.faults import Fault, missing_file
from survey.scenario.phase_parts import build_phase_function

SUM_TOLERANCE = 1e-6


def phase_faults(phase: kinds.PhaseFunctionSection, place: str, folder: Path) -> Iterator[Fault]:
    """Yield why a phase function cannot be made; its files are reached from a folder."""
    if isinstance(phase, kinds.MixturePhase):
        yield from _shares_faults(phase, place, folder)
    elif isinstance(phase, kinds.TablePhase):
        yield from _table_faults(phase, f"{place}.file", folder)
    elif isinstance(phase, kinds.FournierForandPhase):
        yield from _fournier_forand_faults(phase, place)


def _shares_faults(mixture: kinds.MixturePhase, place: str, folder: Path) -> Iterator[Fault]:
    total = fsum(part.scattering_fraction for part in mixture.components)
    if abs(total - 1.0) > SUM_TOLERANCE:
        yield Fault(
            f"{place}.components", f"the scattering fractions add up to {total:g}. Make it 1."
        )
    for number, part in enumerate(mixture.components):
        inner = f"{place}.components.{number}.phase_function"
        yield from phase_faults(part.phase_function, inner, folder)


def _table_faults(table: kinds.TablePhase, place: str, folder: Path) -> Iterator[Fault]:
    if missing := list(missing_file(place, table.file, folder)):
        yield from missing
        return
    try:
        build_phase_function(table, folder=folder)
    except ValueError as error:
        for line in str(error).splitlines():
            yield Fault(place, line.replace(str(folder / table.file), table.file) + ".")


def _fournier_forand_faults(phase: kinds.FournierForandPhase, place: str) -> Iterator[Fault]:
    pair = (phase.particle_index, phase.size_slope)
    by_share = phase.backscatter_fraction is not None
    if by_share == any(value is not None for value in pair) or (not by_share and None in pair):
        yield Fault(place, "give particle_index and size_slope, or backscatter_fraction alone.")
    elif by_share:
        try:
            build_phase_function(phase, folder=Path())
        except ValueError as error:
            yield Fault(f"{place}.backscatter_fraction", f"{error}.")

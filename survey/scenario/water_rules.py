"""Rules that bind the keys of a water together, and to the laser."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import fsum
from pathlib import Path

from survey.scenario import water_sections as kinds
from survey.scenario.faults import Fault
from survey.scenario.sections import Laser, Sun, Water

PETZOLD_WAVELENGTHS_NM = (500.0, 560.0)  # measured at 514 to 530 nm
SUM_TOLERANCE = 1e-6


def group_slower_than_phase(water: Water) -> Iterator[Fault]:
    """Light's group is slower than its phase in water: dispersion is normal there."""
    if water.group_index < water.refractive_index:
        yield Fault(
            "water.group_index",
            f"{water.group_index:g} is below refractive_index {water.refractive_index:g}. "
            "A pulse in water is slower than its phase; raise it.",
        )


def measured_water_has_its_colour(water: Water, laser: Laser) -> Iterator[Fault]:
    """Petzold's waters and the paper's coefficients are those of green light."""
    low, high = PETZOLD_WAVELENGTHS_NM
    if not isinstance(water, kinds.PetzoldWater) or low <= laser.wavelength_nm <= high:
        return
    stated = (water.absorption_per_m, water.scattering_per_m, water.phase_function)
    if any(value is None for value in stated):
        yield Fault(
            "laser.wavelength_nm",
            f"{laser.wavelength_nm:g} is outside {low:g} to {high:g}, where water.type "
            f'"{water.type}" was measured. State the water otherwise or change the laser.',
        )


def sun_knows_the_type(water: Water, sun: Sun) -> Iterator[Fault]:
    """Water light by type needs a type."""
    if sun.water_light == "by_water_type" and not isinstance(water, kinds.PetzoldWater):
        yield Fault(
            "sun.water_light",
            'is known by type for clear, coastal and harbor alone. Take "stated".',
        )


def water_can_be_made(water: Water, laser: Laser, folder: Path) -> Iterator[Fault]:
    """One figure, whole phase functions, and a water that has them at the laser's wavelength."""
    faults = list(_figure_faults(water))
    phase = getattr(water, "phase_function", None)
    if phase is not None:
        faults += phase_faults(phase, "water.phase_function", folder)
    yield from faults or _mixture_faults(water, laser, folder)


def _figure_faults(water: Water) -> Iterator[Fault]:
    if isinstance(water, kinds.SurveyedWater) and len(figures(water)) != 1:
        found = " and ".join(figures(water)) or "none"
        yield Fault("water", f"give one of {', '.join(kinds.FIGURES)}; there is {found}.")


def figures(water: kinds.SurveyedWater) -> list[str]:
    """Return the names of the figures that a surveyed water has."""
    return [name for name in kinds.FIGURES if getattr(water, name) is not None]


def _mixture_faults(water: Water, laser: Laser, folder: Path) -> Iterator[Fault]:
    from survey.scenario.water_parts import build_mixture

    if not isinstance(water, kinds.ComponentsWater | kinds.SurveyedWater):
        return
    if isinstance(water, kinds.SurveyedWater):
        place = f"water.{figures(water)[0]}"
    else:
        place = "laser.wavelength_nm"
    try:
        build_mixture(water, wavelength_nm=laser.wavelength_nm, folder=folder)
    except ValueError as error:
        yield Fault(place, f"{error}.")


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
    from survey.scenario.water_parts import build_phase_function

    if not (folder / table.file).is_file():
        yield Fault(place, f"no file '{table.file}' in {folder}.", missing_file=True)
        return
    try:
        build_phase_function(table, folder=folder)
    except ValueError as error:
        for line in str(error).splitlines():
            yield Fault(place, line.replace(str(folder / table.file), table.file) + ".")


def _fournier_forand_faults(phase: kinds.FournierForandPhase, place: str) -> Iterator[Fault]:
    from survey.scenario.water_parts import build_phase_function

    pair = (phase.particle_index, phase.size_slope)
    by_share = phase.backscatter_fraction is not None
    if by_share == any(value is not None for value in pair) or (not by_share and None in pair):
        yield Fault(place, "give particle_index and size_slope, or backscatter_fraction alone.")
    elif by_share:
        try:
            build_phase_function(phase, folder=Path())
        except ValueError as error:
            yield Fault(f"{place}.backscatter_fraction", f"{error}.")


WATER_RULES: tuple[Callable[..., Iterator[Fault]], ...] = (
    group_slower_than_phase,
    measured_water_has_its_colour,
    sun_knows_the_type,
    water_can_be_made,
)

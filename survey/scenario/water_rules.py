"""Rules that bind the keys of a water together, and to the laser."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import inf
from pathlib import Path

from survey.scenario import water_sections as kinds
from survey.scenario.faults import Fault, missing_file
from survey.scenario.phase_rules import phase_faults
from survey.scenario.sections import Laser, Section, Sun

PETZOLD_WAVELENGTHS_NM = (500.0, 560.0)  # measured at 514 to 530 nm


def group_slower_than_phase(water: kinds.WaterSection) -> Iterator[Fault]:
    """Light's group is slower than its phase in water: dispersion is normal there."""
    if water.group_index < water.refractive_index:
        yield Fault(
            "water.group_index",
            f"{water.group_index:g} is below refractive_index {water.refractive_index:g}. "
            "A pulse in water is slower than its phase; raise it.",
        )


def measured_water_has_its_colour(water: kinds.WaterSection, laser: Laser) -> Iterator[Fault]:
    """Petzold's waters and the paper's coefficients are those of green light."""
    low, high = PETZOLD_WAVELENGTHS_NM
    if low <= laser.wavelength_nm <= high:
        return
    for place, stated in _stated_waters(water):
        if not isinstance(stated, kinds.PetzoldWater):
            continue
        own = (stated.absorption_per_m, stated.scattering_per_m, stated.phase_function)
        if any(value is None for value in own):
            yield Fault(
                "laser.wavelength_nm",
                f"{laser.wavelength_nm:g} is outside {low:g} to {high:g}, where {place}.type "
                f'"{stated.type}" was measured. State the water otherwise or change the laser.',
            )


def sun_knows_the_type(water: kinds.WaterSection, sun: Sun) -> Iterator[Fault]:
    """Water light by type needs a type of the water right under the surface."""
    by_type = sun.water_light == "by_water_type"
    if by_type and not isinstance(kinds.topmost(water), kinds.PetzoldWater):
        yield Fault(
            "sun.water_light",
            'is known by type for clear, coastal and harbor alone. Take "stated".',
        )


def layers_lie_apart(water: kinds.WaterSection) -> Iterator[Fault]:
    """A layer ends below its beginning and before the next one begins."""
    above: tuple[float, float, int] | None = None
    for begin, end, number in sorted(_reaches(water)):
        place = f"water.layers.{number}"
        if end <= begin:
            yield Fault(
                f"{place}.to_depth_m", f"{end:g} is not below from_depth_m {begin:g}. Lower it."
            )
        if above is not None and begin < above[1]:
            last = "the bottom" if above[1] == inf else f"{above[1]:g} m"
            yield Fault(
                f"{place}.from_depth_m",
                f"{begin:g} lies in layer {above[2]} from {above[0]:g} m to {last}. Layers must "
                "not overlap.",
            )
        if above is None or end > above[1]:
            above = begin, end, number


def _reaches(water: kinds.WaterSection) -> Iterator[tuple[float, float, int]]:
    """Yield beginning, end [m] and number of every layer."""
    for number, layer in enumerate(water.layers):
        yield layer.from_depth_m, inf if layer.to_depth_m is None else layer.to_depth_m, number


def water_can_be_made(water: kinds.WaterSection, laser: Laser, folder: Path) -> Iterator[Fault]:
    """One figure, whole phase functions, and waters that have them at the laser's wavelength."""
    for place, stated in _stated_waters(water):
        faults = list(_figure_faults(stated, place))
        phase = getattr(stated, "phase_function", None)
        if phase is not None:
            faults += phase_faults(phase, f"{place}.phase_function", folder)
        yield from faults or _mixture_faults(stated, place, laser, folder)


def profile_can_be_read(water: kinds.WaterSection, folder: Path) -> Iterator[Fault]:
    """The file of a cast is there and sound."""
    if not isinstance(water, kinds.ProfiledSection):
        return
    from survey.scenario.water_column_parts import cast_of
    from terrain.foreign.faults import ForeignFileError

    file = water.profile.file
    if missing := list(missing_file("water.profile", file, folder)):
        yield from missing
        return
    try:
        cast_of(water, folder=folder)
    except ForeignFileError as error:
        yield from (Fault("water.profile", f"{file}: {text}.") for text in error.faults)


def _stated_waters(water: kinds.WaterSection) -> Iterator[tuple[str, Section]]:
    """Yield the section and its layers, each with its place."""
    yield "water", water
    for number, layer in enumerate(water.layers):
        yield f"water.layers.{number}", layer


def _figure_faults(water: Section, place: str) -> Iterator[Fault]:
    if isinstance(water, kinds.SurveyedWater) and len(figures(water)) != 1:
        found = " and ".join(figures(water)) or "none"
        yield Fault(place, f"give one of {', '.join(kinds.FIGURES)}; there is {found}.")


def figures(water: kinds.SurveyedWater) -> list[str]:
    """Return the names of the figures that a surveyed water has."""
    return [name for name in kinds.FIGURES if getattr(water, name) is not None]


def _mixture_faults(water: Section, place: str, laser: Laser, folder: Path) -> Iterator[Fault]:
    from survey.scenario.water_parts import build_mixture

    if isinstance(water, kinds.SurveyedWater):
        key = f"{place}.{figures(water)[0]}"
    elif isinstance(water, kinds.ComponentsWater):
        key = "laser.wavelength_nm"
    else:
        return
    try:
        build_mixture(water, wavelength_nm=laser.wavelength_nm, folder=folder)
    except ValueError as error:
        yield Fault(key, f"{error}.")


WATER_RULES: tuple[Callable[..., Iterator[Fault]], ...] = (
    group_slower_than_phase,
    measured_water_has_its_colour,
    sun_knows_the_type,
    layers_lie_apart,
    water_can_be_made,
    profile_can_be_read,
)

"""What a water comes to in coefficients, and how far that is uncertain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from survey.scenario import water_sections as kinds
from survey.scenario.scenario import Scenario
from survey.scenario.sections import Section

if TYPE_CHECKING:
    from survey.optics.water import Water

Coefficients = tuple[float, float, float]

MOST_LINES = 8


def water_notes(scenario: Scenario) -> Iterator[str]:
    """Yield lines on waters whose coefficients are not in the scenario itself; else nothing.

    K_d is that of Lee et al. (2005) under a sun at the zenith, which a wide lidar beam sees.
    """
    section = scenario.water
    yield from _notes(scenario, section, f"water at {scenario.laser.wavelength_nm:g} nm")
    for layer in section.layers:
        yield from _notes(scenario, layer, f"layer {_reach(layer.from_depth_m, layer.to_depth_m)}")
    if section.layers or isinstance(section, kinds.ProfiledSection):
        yield from _column_notes(scenario)


def _notes(scenario: Scenario, water: Section, name: str) -> Iterator[str]:
    if not isinstance(water, kinds.ComponentsWater | kinds.SurveyedWater):
        return
    yield f"{name}: {_span([_of_mixture(scenario, water)])} 1/m"
    if isinstance(water, kinds.SurveyedWater):
        from survey.optics.water.constituents import GORDON_MOREL_SPREAD

        words = ("low", "central", "high")
        estimates = [_of_mixture(scenario, water, estimate=word) for word in words]
        yield f"  low to high estimate: {_span(estimates)}"
        mixtures = [_of_mixture(scenario, water)]
        for factor in GORDON_MOREL_SPREAD:
            with suppress(ValueError):  # the figure may lie outside these mixtures
                mixtures.append(_of_mixture(scenario, water, particle_scattering_factor=factor))
        low, high = GORDON_MOREL_SPREAD
        yield f"  particle_scattering_factor {low:g} to {high:g}: {_span(mixtures)}"


def _column_notes(scenario: Scenario) -> Iterator[str]:
    """Yield the coefficients of every layer of the column; of many only their span."""
    from survey.scenario.components import water

    layers = water(scenario).layers
    if len(layers) > MOST_LINES:
        last = f"{layers[-1].top:g} m, {len(layers)} layers"
        yield f"profile down to {last}: {_span([_of_water(layer.water) for layer in layers])} 1/m"
        return
    ends = [*(layer.top for layer in layers[1:]), None]
    for layer, end in zip(layers, ends, strict=True):
        yield f"water {_reach(layer.top, end)}: {_span([_of_water(layer.water)])} 1/m"


def _reach(top: float, bottom: float | None) -> str:
    return f"from {top:g} m down" if bottom is None else f"from {top:g} to {bottom:g} m"


def _of_mixture(scenario: Scenario, water: Section, **changes: object) -> Coefficients:
    """Return the coefficients of a mixed water with some keys changed [1/m]."""
    from survey.scenario.water_parts import build_mixture

    mixture = build_mixture(
        water.model_copy(update=changes),
        wavelength_nm=scenario.laser.wavelength_nm,
        folder=scenario.folder,
    )
    section = scenario.water
    return _of_water(
        mixture.water(refractive_index=section.refractive_index, group_index=section.group_index)
    )


def _of_water(water: Water) -> Coefficients:
    """Return absorption, scattering and K_d [1/m]."""
    from survey.optics.water.apparent import diffuse_attenuation

    return water.absorption, water.scattering, diffuse_attenuation(water)


def _span(found: Sequence[Coefficients]) -> str:
    names = ("absorption", "scattering", "K_d")
    return ", ".join(
        f"{name} {_range(values)}"
        for name, values in zip(names, zip(*found, strict=True), strict=True)
    )


def _range(values: Sequence[float]) -> str:
    low, high = f"{min(values):.3g}", f"{max(values):.3g}"
    return low if low == high else f"{low} to {high}"

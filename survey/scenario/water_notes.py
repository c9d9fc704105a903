"""What a water comes to in coefficients, and how far that is uncertain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress

from survey.scenario import water_sections as kinds
from survey.scenario.scenario import Scenario

Coefficients = tuple[float, float, float]


def water_notes(scenario: Scenario) -> Iterator[str]:
    """Yield lines on a water whose coefficients are not in the scenario itself; else nothing.

    K_d is that of Lee et al. (2005) under a sun at the zenith, which a wide lidar beam sees.
    """
    water = scenario.water
    if not isinstance(water, kinds.ComponentsWater | kinds.SurveyedWater):
        return
    yield f"water at {scenario.laser.wavelength_nm:g} nm: {_span([_coefficients(scenario)])} 1/m"
    if isinstance(water, kinds.SurveyedWater):
        from survey.optics.water.constituents import GORDON_MOREL_SPREAD

        estimates = [_coefficients(scenario, estimate=word) for word in ("low", "central", "high")]
        yield f"  low to high estimate: {_span(estimates)}"
        mixtures = [_coefficients(scenario)]
        for factor in GORDON_MOREL_SPREAD:
            with suppress(ValueError):  # the figure may lie outside these mixtures
                mixtures.append(_coefficients(scenario, particle_scattering_factor=factor))
        low, high = GORDON_MOREL_SPREAD
        yield f"  particle_scattering_factor {low:g} to {high:g}: {_span(mixtures)}"


def _coefficients(scenario: Scenario, **changes: object) -> Coefficients:
    """Return absorption, scattering and K_d of the water with some keys changed [1/m]."""
    from survey.optics.water.apparent import lee_diffuse_attenuation
    from survey.scenario.water_parts import build_mixture

    mixture = build_mixture(
        scenario.water.model_copy(update=changes),
        wavelength_nm=scenario.laser.wavelength_nm,
        folder=scenario.folder,
    )
    kd = lee_diffuse_attenuation(
        absorption=mixture.absorption, backscattering=mixture.backscattering, sun_zenith=0.0
    )
    return mixture.absorption, mixture.scattering, kd


def _span(found: Sequence[Coefficients]) -> str:
    names = ("absorption", "scattering", "K_d")
    return ", ".join(
        f"{name} {_range(values)}"
        for name, values in zip(names, zip(*found, strict=True), strict=True)
    )


def _range(values: Sequence[float]) -> str:
    low, high = f"{min(values):.3g}", f"{max(values):.3g}"
    return low if low == high else f"{low} to {high}"

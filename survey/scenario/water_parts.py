"""What states a water turned into that water, in SI units and radians.

`survey.optics` is imported when a water is built, so that checking a scenario stays quick.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

from survey.scenario import water_sections as kinds
from survey.scenario.phase_parts import build_phase_function
from survey.scenario.sections import Section

if TYPE_CHECKING:
    from survey.optics.phase import PhaseFunction
    from survey.optics.water import Water
    from survey.optics.water.mixing import Component, Mixture, OneParameterWaters

NANO = 1e-9
MG_M3 = 1e-6
ZERO_CELSIUS = 273.15


def build_water(
    given: Section,
    *,
    refractive_index: float,
    group_index: float,
    wavelength_nm: float,
    folder: Path,
) -> Water:
    """Return the uniform water that a section or a layer states.

    Parameters
    ----------
    given : Section
        One of the waters of `survey.scenario.water_sections`.
    refractive_index, group_index : float
        Phase and group index [1].
    wavelength_nm : float
        Of the laser [nm].
    folder : Path
        Folder from which a table is reached.

    Raises
    ------
    ValueError
        When a table cannot be used or no water is like that.
    """
    indices = {"refractive_index": refractive_index, "group_index": group_index}
    if isinstance(given, kinds.PetzoldWater):
        from survey.optics.water import petzold_water

        phase = given.phase_function
        return petzold_water(
            given.type,
            absorption=given.absorption_per_m,
            scattering=given.scattering_per_m,
            phase_function=None if phase is None else build_phase_function(phase, folder=folder),
            **indices,
        )
    if isinstance(given, kinds.StatedWater):
        from survey.optics.water import Water

        return Water(
            absorption=given.absorption_per_m,
            scattering=given.scattering_per_m,
            phase_function=build_phase_function(given.phase_function, folder=folder),
            **indices,
        )
    return build_mixture(given, wavelength_nm=wavelength_nm, folder=folder).water(**indices)


def build_mixture(given: Section, *, wavelength_nm: float, folder: Path) -> Mixture:
    """Return the components of a water that is stated by them or by a surveyor's figure.

    Raises
    ------
    ValueError
        As `build_water`.
    """
    from survey.optics.water.mixing import Mixture

    assert isinstance(given, kinds.ComponentsWater | kinds.SurveyedWater)
    wavelength = wavelength_nm * NANO
    particles = build_phase_function(given.phase_function, folder=folder)
    if isinstance(given, kinds.ComponentsWater):
        return Mixture(components=_components(given, wavelength, particles))
    waters = _one_parameter_waters(given, particles)
    chlorophyll = _chlorophyll(given, waters, wavelength)
    return waters.mixture(wavelength=wavelength, chlorophyll=chlorophyll)


def _components(
    given: kinds.ComponentsWater, wavelength: float, particles: PhaseFunction
) -> Sequence[Component]:
    from survey.optics.water import constituents
    from survey.optics.water.mixing import Component

    return [
        _pure_water(given, wavelength),
        Component(
            name="particles",
            absorption=constituents.bricaud_absorption(
                wavelength=wavelength, chlorophyll=given.chlorophyll_mg_m3 * MG_M3
            ),
            scattering=_particle_scattering(given, wavelength),
            phase_function=particles,
        ),
        Component(
            name="yellow substance",
            absorption=constituents.yellow_absorption(
                wavelength=wavelength,
                at_440=given.yellow_absorption_440_per_m,
                slope=given.yellow_slope_per_nm / NANO,
            ),
        ),
    ]


def _pure_water(given: kinds.ComponentsWater, wavelength: float) -> Component:
    from survey.optics.phase import molecular
    from survey.optics.phase.closed_forms import MOREL_DEPOLARISATION, ZHANG_DEPOLARISATION
    from survey.optics.water import pure
    from survey.optics.water.mixing import Component

    if "paper" in (given.pure_absorption, given.pure_scattering):
        pure.require_paper_wavelength(wavelength)
    absorption = {
        "pope_fry": pure.pope_fry_absorption(wavelength=wavelength),
        "smith_baker": pure.smith_baker_absorption(wavelength=wavelength),
        "paper": pure.PAPER_ABSORPTION,
    }
    salinity, temperature = given.salinity_psu, given.temperature_degc + ZERO_CELSIUS
    scattering = {
        "zhang": pure.zhang_scattering(
            wavelength=wavelength, salinity=salinity, temperature=temperature
        ),
        "morel": pure.morel_scattering(wavelength=wavelength, salinity=salinity),
        "paper": pure.PAPER_SCATTERING,
    }
    by_zhang = given.pure_scattering == "zhang"
    return Component(
        name="water",
        absorption=absorption[given.pure_absorption],
        scattering=scattering[given.pure_scattering],
        phase_function=molecular(ZHANG_DEPOLARISATION if by_zhang else MOREL_DEPOLARISATION),
    )


def _particle_scattering(given: kinds.ComponentsWater, wavelength: float) -> float:
    from survey.optics.water import constituents

    if given.particle_scattering_550_per_m is not None:
        return constituents.particle_scattering(
            wavelength=wavelength, at_550=given.particle_scattering_550_per_m
        )
    by_chlorophyll = {
        "gordon_morel": constituents.gordon_morel_scattering,
        "loisel_morel": constituents.loisel_morel_scattering,
    }[given.particle_scattering]
    return by_chlorophyll(wavelength=wavelength, chlorophyll=given.chlorophyll_mg_m3 * MG_M3)


def _one_parameter_waters(
    given: kinds.SurveyedWater, particles: PhaseFunction
) -> OneParameterWaters:
    from survey.optics.water.mixing import OneParameterWaters

    return OneParameterWaters(
        salinity=given.salinity_psu,
        temperature=given.temperature_degc + ZERO_CELSIUS,
        particles=particles,
        scattering_factor=given.particle_scattering_factor,
    )


def _chlorophyll(
    given: kinds.SurveyedWater, waters: OneParameterWaters, wavelength: float
) -> float:
    from survey.optics.water import surveyor

    sun_zenith = radians(given.measured_sun_zenith_deg)
    if given.secchi_depth_m is not None:
        return surveyor.chlorophyll_of_secchi_depth(
            given.secchi_depth_m,
            waters=waters,
            sun_zenith=sun_zenith,
            relation=given.secchi_relation,
            estimate=given.estimate,
        )
    if given.kd_490_per_m is not None:
        return surveyor.chlorophyll_of_kd_490(
            given.kd_490_per_m,
            wavelength=wavelength,
            waters=waters,
            sun_zenith=sun_zenith,
            estimate=given.estimate,
        )
    assert given.turbidity_ntu is not None
    return surveyor.chlorophyll_of_turbidity(
        given.turbidity_ntu, waters=waters, estimate=given.estimate
    )

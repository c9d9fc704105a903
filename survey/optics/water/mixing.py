"""Water as the sum of its components, and the one-parameter mixtures of the open sea."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from survey.optics.phase import PhaseFunction, mixture, molecular
from survey.optics.water.constituents import (
    GORDON_MOREL_FACTOR,
    bricaud_absorption,
    covarying_yellow_absorption,
    gordon_morel_scattering,
)
from survey.optics.water.medium import Water
from survey.optics.water.pure import pope_fry_absorption, zhang_scattering


@dataclass(frozen=True, kw_only=True)
class Component:
    """One component of a water.

    Parameters
    ----------
    name : str
    absorption, scattering : float
        What it adds to a and b [1/m].
    phase_function : PhaseFunction, optional
        None where it does not scatter.
    """

    name: str
    absorption: float
    scattering: float = 0.0
    phase_function: PhaseFunction | None = None


@dataclass(frozen=True, kw_only=True)
class Mixture:
    """The sum of components, the component model of [Lisenko2017].

    sigma = (scattering + absorption of pure water) + scattering of suspended particles
    + C_chl alpha_chl + C_y alpha_y.

    Examples
    --------
    >>> from survey.optics.phase import average_particle
    >>> water = Mixture(components=[
    ...     Component(name="water", absorption=0.0444, scattering=0.002,
    ...               phase_function=molecular()),
    ...     Component(name="particles", absorption=0.016, scattering=0.31,
    ...               phase_function=average_particle())])
    >>> round(water.absorption, 4), round(water.scattering, 4), round(water.backscattering, 4)
    (0.0604, 0.312, 0.0067)
    """

    components: Sequence[Component]

    @property
    def absorption(self) -> float:
        """Absorption a [1/m]."""
        return sum(part.absorption for part in self.components)

    @property
    def scattering(self) -> float:
        """Scattering b [1/m]."""
        return sum(part.scattering for part in self.components)

    @property
    def attenuation(self) -> float:
        """Beam attenuation c = a + b [1/m]."""
        return self.absorption + self.scattering

    @property
    def backscattering(self) -> float:
        """Scattering by more than 90 degrees b_b [1/m]."""
        return sum(
            part.scattering * part.phase_function.backscatter_fraction
            for part in self.components
            if part.phase_function is not None
        )

    def water(self, *, refractive_index: float, group_index: float) -> Water:
        """Return the water that they make together.

        Raises
        ------
        ValueError
            When none of them scatters.
        """
        return Water(
            absorption=self.absorption,
            scattering=self.scattering,
            phase_function=mixture(
                [
                    (part.phase_function, part.scattering)
                    for part in self.components
                    if part.phase_function is not None
                ]
            ),
            refractive_index=refractive_index,
            group_index=group_index,
        )


@dataclass(frozen=True, kw_only=True)
class OneParameterWaters:
    """Waters whose particles and yellow substance both go with chlorophyll ("Case 1").

    Pope and Fry's absorption, Zhang's scattering, Bricaud's particles, Gordon and Morel's
    scattering, yellow substance in its usual share. Outside the open sea chlorophyll is only the
    name of the parameter, and the factor of scattering says how much sediment goes with it.

    Parameters
    ----------
    salinity : float
        Practical salinity [1].
    temperature : float
        [K].
    particles : PhaseFunction
        Phase function of the particles.
    scattering_factor : float
        Gordon and Morel's factor [1/m at 1 mg/m3].
    """

    salinity: float
    temperature: float
    particles: PhaseFunction
    scattering_factor: float = GORDON_MOREL_FACTOR

    def mixture(self, *, wavelength: float, chlorophyll: float) -> Mixture:
        """Return one of them, by its chlorophyll [kg/m3], at a wavelength [m].

        Raises
        ------
        ValueError
            When the wavelength lies outside 400 to 700 nm.
        """
        place = {"wavelength": wavelength, "chlorophyll": chlorophyll}
        return Mixture(
            components=[
                Component(
                    name="water",
                    absorption=pope_fry_absorption(wavelength=wavelength),
                    scattering=zhang_scattering(
                        wavelength=wavelength,
                        salinity=self.salinity,
                        temperature=self.temperature,
                    ),
                    phase_function=_molecules(),
                ),
                Component(
                    name="particles",
                    absorption=bricaud_absorption(**place),
                    scattering=gordon_morel_scattering(factor=self.scattering_factor, **place),
                    phase_function=self.particles,
                ),
                Component(name="yellow substance", absorption=covarying_yellow_absorption(**place)),
            ]
        )


@cache
def _molecules() -> PhaseFunction:
    return molecular()

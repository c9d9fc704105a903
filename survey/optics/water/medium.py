"""Uniform water as the transport takes it, and Petzold's three waters."""

from __future__ import annotations

from dataclasses import dataclass

from survey.optics.phase import PhaseFunction, petzold

# [Lisenko2017], captions of figures 1-3: absorption and scattering [1/m].
PAPER_COEFFICIENTS = {
    "clear": (0.114, 0.037),
    "coastal": (0.179, 0.219),
    "harbor": (0.366, 1.824),
}


@dataclass(frozen=True, kw_only=True)
class Water:
    """Uniform water.

    Parameters
    ----------
    absorption, scattering : float
        Coefficients a and b [1/m].
    phase_function : PhaseFunction
        Volume scattering function over b [1/sr].
    refractive_index : float
        Phase index, which bends rays [1].
    group_index : float
        Group index, which times them [1].
    """

    absorption: float
    scattering: float
    phase_function: PhaseFunction
    refractive_index: float
    group_index: float

    def __post_init__(self) -> None:
        faults = [
            f"{name} = {value:g}: must {rule}"
            for name, value, good, rule in (
                ("absorption", self.absorption, self.absorption >= 0.0, "not be negative"),
                ("scattering", self.scattering, self.scattering >= 0.0, "not be negative"),
                (
                    "refractive_index",
                    self.refractive_index,
                    self.refractive_index >= 1.0,
                    "be >= 1",
                ),
                ("group_index", self.group_index, self.group_index >= 1.0, "be >= 1"),
            )
            if not good
        ]
        if faults:
            raise ValueError("\n".join(f"water: {fault}" for fault in faults))

    @property
    def attenuation(self) -> float:
        """Beam attenuation c = a + b [1/m]."""
        return self.absorption + self.scattering

    @property
    def backscattering(self) -> float:
        """Scattering by more than 90 degrees b_b [1/m]."""
        return self.scattering * self.phase_function.backscatter_fraction


def petzold_water(
    name: str,
    *,
    refractive_index: float,
    group_index: float,
    absorption: float | None = None,
    scattering: float | None = None,
    phase_function: PhaseFunction | None = None,
) -> Water:
    """Return one of Petzold's three waters, with the coefficients of [Lisenko2017] by default.

    Parameters
    ----------
    name : {"clear", "coastal", "harbor"}
        P02, P05 or P07 of the paper.
    refractive_index, group_index : float
        Phase and group index [1].
    absorption, scattering : float, optional
        Other coefficients [1/m].
    phase_function : PhaseFunction, optional
        Another one than Petzold's.

    Examples
    --------
    >>> round(petzold_water("coastal", refractive_index=1.33, group_index=1.33).attenuation, 3)
    0.398
    """
    paper_absorption, paper_scattering = PAPER_COEFFICIENTS[name]
    return Water(
        absorption=paper_absorption if absorption is None else absorption,
        scattering=paper_scattering if scattering is None else scattering,
        phase_function=petzold(name) if phase_function is None else phase_function,
        refractive_index=refractive_index,
        group_index=group_index,
    )

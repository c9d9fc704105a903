"""Waters of several components: their phase functions, weighted by their scattering."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from survey.optics.phase.function import SMALLEST_ANGLE, FloatArray, PhaseFunction


def mixture(components: Sequence[tuple[PhaseFunction, float]]) -> PhaseFunction:
    """Return the phase function of components that scatter side by side: sum b_i P_i / sum b_i.

    Parameters
    ----------
    components : sequence of (PhaseFunction, float)
        Each with its scattering coefficient, not negative, in one unit [1/m].

    Raises
    ------
    ValueError
        When a coefficient is negative or not finite, or none is above 0.

    Examples
    --------
    >>> from survey.optics.phase import average_particle, molecular
    >>> sea = mixture([(average_particle(), 0.2), (molecular(), 0.002)])
    >>> round(sea.backscatter_fraction, 4)
    0.0231
    """
    faults = [
        f"mixture: {phase.name}: scattering {scattering:g}: must be finite and not negative"
        for phase, scattering in components
        if not (scattering >= 0.0 and np.isfinite(scattering))
    ]
    if not faults and not any(scattering > 0.0 for _, scattering in components):
        faults = ["mixture: no component scatters. Give one a coefficient above 0"]
    if faults:
        raise ValueError("\n".join(faults))

    def shape(angle: FloatArray) -> FloatArray:
        total = np.zeros_like(angle)
        for phase, scattering in components:
            total += scattering * phase.density(angle)
        return total

    return PhaseFunction.from_function(
        name=" + ".join(f"{scattering:g} {phase.name}" for phase, scattering in components),
        function=shape,
        small_angle_slope=_core_slope(components),
    )


def _core_slope(components: Sequence[tuple[PhaseFunction, float]]) -> float:
    """Return the exponent whose power law holds as much light as all cores together."""
    edge = SMALLEST_ANGLE
    light = sum(b * phase.fraction_within(edge) for phase, b in components)
    density = sum(b * float(phase.density(edge)) for phase, b in components)
    return float(2.0 * np.pi * density * edge**2 / light - 2.0)

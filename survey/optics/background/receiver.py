"""What the receiver takes in of the background, equation (1) of [Lisenko2017]."""

from __future__ import annotations

from math import pi


def background_power(
    *, radiance: float, filter_width: float, aperture_area: float, solid_angle: float
) -> float:
    """Power of the background in one pixel, equation (1) of [Lisenko2017] [W].

    Parameters
    ----------
    radiance : float
        L_b [W/(m3 sr)].
    filter_width : float
        Width of the filter [m].
    aperture_area, solid_angle : float
        Of the receiver [m2] and of the pixel [sr]; departure: a square pixel has its own solid
        angle, the paper's circle of the same width, `round_field`, is 1.27 times smaller.

    Raises
    ------
    ValueError
        A line for each quantity that is negative or not a number.

    Examples
    --------
    >>> background_power(radiance=5e7, filter_width=1e-9, aperture_area=2.0, solid_angle=1e-4)
    1e-05
    """
    factors = {
        "radiance": radiance,
        "filter_width": filter_width,
        "aperture_area": aperture_area,
        "solid_angle": solid_angle,
    }
    faults = [
        f"background: {name} = {value:g}: must not be negative"
        for name, value in factors.items()
        if not value >= 0.0
    ]
    if faults:
        raise ValueError("\n".join(faults))
    return radiance * filter_width * aperture_area * solid_angle


def round_field(half_angle: float) -> float:
    """Solid angle Omega_r = pi alpha_r^2 of a small round field of view, with (1) [sr].

    Examples
    --------
    >>> round(round_field(0.004) * 1e5, 2)  # the paper's pixel; a square one has 6.4
    5.03
    """
    return pi * half_angle**2

"""How much of the sea is white."""

from __future__ import annotations

# Koepke (1984): effective reflectance of a whitecap, its patch growing and thinning with age.
FOAM_REFLECTANCE = 0.22


def whitecap_coverage(wind_speed: float) -> float:
    """Return the share of the sea that whitecaps cover, Monahan and O'Muircheartaigh (1980) [1].

    W = 2.95e-6 U10^3.52.

    Parameters
    ----------
    wind_speed : float
        U10 [m/s].

    Examples
    --------
    >>> round(whitecap_coverage(10.0), 5)
    0.00977
    """
    return float(min(2.95e-6 * wind_speed**3.52, 1.0))

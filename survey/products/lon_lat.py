"""Places on the map as GeoJSON has them: degrees of WGS 84."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from survey.flight.geodesy import from_map

DEGREE_DECIMALS = 8
"""1e-8 degrees are about a millimetre."""


def lon_lat(places: NDArray[np.float64], *, epsg: int) -> NDArray[np.float64]:
    """Return longitude and latitude (n, 2) [degrees] of places (n, 2 or 3) [m, map], rounded.

    Examples
    --------
    >>> lon_lat(np.array([[500000.0, 0.0]]), epsg=25832).tolist()
    [[9.0, 0.0]]
    """
    degrees = np.degrees(from_map(places, epsg=epsg))
    return np.asarray(degrees.T.round(DEGREE_DECIMALS))

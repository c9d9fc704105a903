"""Places on the map as GeoJSON has them: degrees of WGS 84."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from pyproj import Transformer

DEGREE_DECIMALS = 8
"""1e-8 degrees are about a millimetre."""


def lon_lat(places: NDArray[np.float64], *, epsg: int) -> NDArray[np.float64]:
    """Return longitude and latitude (n, 2) [degrees] of places (n, 2 or 3) [m, map], rounded.

    Examples
    --------
    >>> lon_lat(np.array([[500000.0, 0.0]]), epsg=25832).tolist()
    [[9.0, 0.0]]
    """
    degrees = _to_wgs84(epsg).transform(places[:, 0], places[:, 1])
    return np.asarray(np.column_stack(degrees).round(DEGREE_DECIMALS))


@lru_cache(maxsize=8)
def _to_wgs84(epsg: int) -> Transformer:
    """Return the transformation: making one takes longer than writing a feature."""
    from pyproj import Transformer

    return Transformer.from_crs(epsg, 4326, always_xy=True)

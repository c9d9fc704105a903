"""The scene's local frame and its place on the map."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS
from pyproj.crs import CompoundCRS

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class MapFrame:
    """Local coordinates are map coordinates less an origin, so that metres keep their digits.

    Parameters
    ----------
    easting, northing : float
        Origin on the map [m]; the vertical axis has no offset.
    epsg, vertical_epsg : int
        Projected CRS in metres and vertical datum.

    Examples
    --------
    >>> frame = MapFrame(easting=500000.0, northing=6.0e6, epsg=25832, vertical_epsg=5714)
    >>> frame.to_map(np.array([[1.0, 2.0, -3.0]]))
    array([[ 5.000010e+05,  6.000002e+06, -3.000000e+00]])
    """

    easting: float
    northing: float
    epsg: int
    vertical_epsg: int

    @property
    def origin(self) -> FloatArray:
        """Offset (3,) of the local frame [m]."""
        return np.array([self.easting, self.northing, 0.0])

    def to_map(self, local: FloatArray) -> FloatArray:
        """Return map coordinates (..., 3) [m]."""
        return local + self.origin

    def to_local(self, on_map: FloatArray) -> FloatArray:
        """Return local coordinates (..., 3) [m]."""
        return on_map - self.origin

    @cached_property
    def crs(self) -> CRS:
        """Compound CRS: projected and vertical."""
        horizontal, vertical = CRS.from_epsg(self.epsg), CRS.from_epsg(self.vertical_epsg)
        return CompoundCRS(f"{horizontal.name} + {vertical.name}", [horizontal, vertical])

"""Between longitude and latitude, and the map: places and headings.

Longitude and latitude are those of WGS 84 (EPSG:4326). Heights are passed on as they are.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from pyproj import Transformer

FloatArray = NDArray[np.float64]

WGS_84 = 4326
STEP = np.radians(1e-5)  # about a metre of latitude


def to_map(*, longitude: FloatArray, latitude: FloatArray, epsg: int) -> FloatArray:
    """Return easting and northing (n, 2) [m] of longitudes and latitudes [rad].

    Places outside the map come back as infinity.

    Examples
    --------
    >>> to_map(longitude=np.radians([9.0]), latitude=np.radians([0.0]), epsg=25832).round(3)
    array([[500000.,      0.]])
    """
    east, north = _transformer(WGS_84, epsg).transform(longitude, latitude, radians=True)
    return np.column_stack([east, north])


def from_map(places: FloatArray, *, epsg: int) -> tuple[FloatArray, FloatArray]:
    """Return longitude and latitude [rad] of eastings and northings (n, 2) [m]."""
    degrees = _transformer(epsg, WGS_84).transform(places[:, 0], places[:, 1])
    return np.radians(degrees[0]), np.radians(degrees[1])


def grid_north(*, longitude: FloatArray, latitude: FloatArray, epsg: int) -> FloatArray:
    """Return how far grid north lies to the right of true north [rad].

    From the direction on the map of a step towards the pole. A heading from true north less this
    angle is the heading from grid north.

    Examples
    --------
    Half a zone east of the middle meridian, at 54 degrees north:

    >>> angle = grid_north(longitude=np.radians([12.0]), latitude=np.radians([54.0]), epsg=25832)
    >>> np.degrees(angle).round(3), np.degrees(np.sin(np.radians(54.0)) * np.radians(3.0)).round(3)
    (array([2.428]), np.float64(2.427))
    """
    half = 0.5 * STEP
    south = to_map(longitude=longitude, latitude=latitude - half, epsg=epsg)
    north = to_map(longitude=longitude, latitude=latitude + half, epsg=epsg)
    east, up = (north - south).T
    return np.asarray(-np.arctan2(east, up))


@lru_cache(maxsize=8)
def _transformer(source: int, target: int) -> Transformer:
    return Transformer.from_crs(source, target, always_xy=True)

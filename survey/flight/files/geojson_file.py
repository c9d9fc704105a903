"""Areas as GeoJSON (RFC 7946): one polygon without holes."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pyproj import Transformer
from pyproj.exceptions import CRSError

from survey.flight.files.faults import FlightFileError, content_of
from terrain.extent import FARTHEST

FloatArray = NDArray[np.float64]

LARGEST_AREA_BYTES = 10_000_000
WGS_84 = 4326
LONGITUDE_LATITUDE = {WGS_84, 84}  # 84: OGC's CRS84


def read_area(path: Path, *, epsg: int) -> FloatArray:
    """Return the corners (n, 2) of the polygon in a GeoJSON file on a map [m].

    Coordinates are longitude and latitude (WGS 84), unless the file has the ``crs`` member of
    GeoJSON's edition of 2008, which names an EPSG code. The last corner is not a repetition of the
    first, as it is in the file.

    Raises
    ------
    FlightFileError
        When it is no GeoJSON, or holds none or several polygons or one with holes.
    """
    try:
        content = content_of(path, largest=LARGEST_AREA_BYTES)
        value = json.loads(content, object_pairs_hook=_without_doubles)
    except (ValueError, RecursionError) as error:
        if isinstance(error, FlightFileError):
            raise
        raise FlightFileError(path, [f"no GeoJSON: {error}. Export it again"]) from error
    polygons = [part for shape in _geometries(value) for part in _polygons(shape)]
    if len(polygons) != 1:
        raise FlightFileError(path, [f"{len(polygons)} polygons. Keep one"])
    rings = polygons[0]
    if not isinstance(rings, list) or not rings:
        raise FlightFileError(path, ["the polygon has no outline. Give its corners"])
    if len(rings) > 1:
        holes = len(rings) - 1
        raise FlightFileError(path, [f"the polygon has {holes} holes. Keep its outline alone"])
    ring = _on_map(_places(path, rings[0]), _code(path, value), epsg, path)
    if len(ring) < 2 or (ring[0] != ring[-1]).any():
        raise FlightFileError(path, ["the outline is open. End it with its first corner"])
    return ring[:-1]


def _without_doubles(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return the members of an object; ValueError where one stands there twice."""
    members = dict(pairs)
    if len(members) < len(pairs):
        raise ValueError(f"a member twice in one object, of {', '.join(members)}")
    return members


def _geometries(value: Any) -> list[Mapping[str, Any]]:
    """Return all geometries in a GeoJSON value."""
    if not isinstance(value, Mapping):
        return []
    for key in ("features", "geometries"):
        if isinstance(value.get(key), list):
            return [shape for inner in value[key] for shape in _geometries(inner)]
    if value.get("type") == "Feature":
        return _geometries(value.get("geometry"))
    return [value]


def _polygons(shape: Mapping[str, Any]) -> list[Any]:
    """Return the lists of rings in a geometry."""
    coordinates = shape.get("coordinates")
    if shape.get("type") == "Polygon":
        return [coordinates]
    if shape.get("type") == "MultiPolygon" and isinstance(coordinates, list):
        return coordinates
    return []


def _places(path: Path, ring: Any) -> FloatArray:
    """Return the coordinates (n, 2) of a ring."""
    if not isinstance(ring, list) or not all(map(_is_place, ring)):
        raise FlightFileError(path, ["a corner is not a pair of numbers. Give [east, north]"])
    return np.array([place[:2] for place in ring], dtype=np.float64).reshape(-1, 2)


def _is_place(place: Any) -> bool:
    """Tell whether a value is two numbers or three that may lie on a map."""
    return (
        isinstance(place, list)
        and len(place) in (2, 3)
        and all(type(number) in (int, float) and abs(number) <= FARTHEST for number in place)
    )


def _code(path: Path, value: Any) -> int:
    """Return the EPSG code of a file's coordinates."""
    crs = value.get("crs") if isinstance(value, Mapping) else None
    if crs is None:
        return WGS_84
    match = re.search(r"(?:EPSG|OGC):(?:[\d.]*:)?(?:CRS)?(\d+)\"", json.dumps(crs))
    if match is None:
        raise FlightFileError(path, ["crs: names no EPSG code. Leave it out and give WGS 84"])
    return int(match[1])


def _on_map(corners: FloatArray, code: int, epsg: int, path: Path) -> FloatArray:
    if code == epsg:
        return corners
    source = WGS_84 if code in LONGITUDE_LATITUDE else code
    if source == WGS_84 and (np.abs(corners) > [180.0, 90.0]).any():
        raise FlightFileError(
            path, ["corners are no longitudes and latitudes in degrees. Name their map in crs"]
        )
    try:
        transformer = Transformer.from_crs(source, epsg, always_xy=True)
    except CRSError as error:
        raise FlightFileError(path, [f"crs: there is no map EPSG:{source}"]) from error
    placed = np.column_stack(transformer.transform(corners[:, 0], corners[:, 1]))
    if not np.isfinite(placed).all():
        raise FlightFileError(path, [f"corners lie outside the map EPSG:{epsg}"])
    return placed

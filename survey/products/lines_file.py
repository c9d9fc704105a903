"""Where the survey flew: every line and every flash as GeoJSON."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from survey.flight.pose import Frame
from survey.products.feature_file import write_features
from survey.products.lon_lat import lon_lat
from terrain.map_frame import MapFrame

HEIGHT_DECIMALS = 3


def write_lines_geojson(path: Path, frames: Sequence[Frame], map_frame: MapFrame) -> None:
    """Write a LineString for each survey line, through the measured places of its flashes.

    Longitude and latitude are WGS 84 (RFC 7946). A line of one flash is a Point. Properties:
    ``line`` from 0, as the point source less one in the clouds; ``first_frame``, ``last_frame``,
    ``flashes``; ``start_s`` and ``end_s`` since the start of the mission; ``mean_up_m``, above the
    vertical datum, since RFC 7946 knows heights above the ellipsoid alone.

    Parameters
    ----------
    path : Path
        File to write.
    frames : sequence of Frame
        In the order of flight, in the local frame.
    map_frame : MapFrame
        Where that frame lies on the map.
    """
    by_line: dict[int, list[Frame]] = {}
    for frame in frames:
        by_line.setdefault(frame.line, []).append(frame)
    write_features(path, (_feature(line, flown, map_frame) for line, flown in by_line.items()))


def _feature(line: int, frames: Sequence[Frame], map_frame: MapFrame) -> dict[str, Any]:
    places = map_frame.to_map(np.array([frame.measured.position for frame in frames]))
    coordinates = lon_lat(places, epsg=map_frame.epsg).tolist()
    single = len(frames) == 1
    return {
        "type": "Feature",
        "properties": {
            "line": line,
            "first_frame": frames[0].index,
            "last_frame": frames[-1].index,
            "flashes": len(frames),
            "start_s": frames[0].time,
            "end_s": frames[-1].time,
            "mean_up_m": round(float(places[:, 2].mean()), HEIGHT_DECIMALS),
        },
        "geometry": {
            "type": "Point" if single else "LineString",
            "coordinates": coordinates[0] if single else coordinates,
        },
    }

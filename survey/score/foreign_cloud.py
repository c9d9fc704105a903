"""A cloud of others, read and laid beside a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS
from pyproj.exceptions import CRSError

from survey.cloud.points import BOTTOM_CLASSES, PointClass
from survey.score.faults import ScoreError
from terrain.extent import FARTHEST, HIGHEST
from terrain.file_faults import require_crs
from terrain.foreign.limits import limits_for_whole
from terrain.foreign.reading import read_foreign
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]
READERS = {".las": "read_las", ".laz": "read_las", ".ply": "read_ply", ".csv": "read_csv"}
READERS |= {".txt": "read_csv", ".xyz": "read_csv"}
BOTTOM = tuple(map(int, BOTTOM_CLASSES))


@dataclass(frozen=True, kw_only=True)
class ForeignCloud:
    """A cloud on the run's map.

    Parameters
    ----------
    position : array (n, 3)
        In the run's local frame [m].
    classification : array (n,)
        LAS classes; 40 for all points where the file has none.
    bottom : array (n,) of bool
        Points that claim to be bottom.
    notes : sequence of str
        What was taken for granted.
    """

    position: FloatArray
    classification: NDArray[np.uint8]
    bottom: NDArray[np.bool_]
    notes: Sequence[str]


def read_cloud(path: Path, map_frame: MapFrame, *, bottom: Sequence[int] = BOTTOM) -> ForeignCloud:
    """Read a cloud and lay it on a run's map.

    Parameters
    ----------
    path : Path
        LAS, LAZ, PLY, or a table with a header (CSV, TXT, XYZ).
    map_frame : MapFrame
        Of the run.
    bottom : sequence of int
        Classes that claim to be bottom.

    Raises
    ------
    FileNotFoundError
        When there is no such file.
    ScoreError, ForeignFileError
        With every fault: another format or coordinate system, no points, points that are nowhere,
        none of the bottom.
    """
    if path.suffix.lower() not in READERS:
        raise ScoreError([f"{path}: not a cloud. give a file of {', '.join(READERS)}"])
    reader = f"terrain.foreign.cloud_reader:{READERS[path.suffix.lower()]}"
    found = read_foreign(reader, path, limits=limits_for_whole(path))
    points, classes = found["points"], found["classification"]
    faults, notes = _crs(str(found["crs"]), map_frame, path)
    if len(points) == 0:
        faults.append(f"{path}: points: the cloud is empty")
    else:
        faults += _places(points, path)
    if len(classes) == 0:
        classes = np.full(len(points), PointClass.BATHYMETRIC, dtype=np.uint8)
        notes.append("the file has no classes: every point is taken for bottom")
        bottom = BOTTOM
    claimed = np.isin(classes, list(bottom))
    if len(points) and not claimed.any():
        there = ", ".join(str(number) for number in np.unique(classes).tolist())
        asked = " or ".join(str(number) for number in bottom)
        faults.append(
            f"{path}: classes: no point of class {asked}; it has {there}. classify the bottom, or "
            "name its class with --bottom-class"
        )
    if faults:
        raise ScoreError(faults)
    return ForeignCloud(
        position=map_frame.to_local(points), classification=classes, bottom=claimed, notes=notes
    )


def _places(points: FloatArray, path: Path) -> list[str]:
    """Return the fault of points that are nowhere on a map."""
    there = np.abs(points) <= (FARTHEST, FARTHEST, HIGHEST)
    wrong = np.flatnonzero(~there.all(axis=1))
    if wrong.size == 0:
        return []
    place = ", ".join(f"{value:g}" for value in points[wrong[0]])
    what = "beyond the ground of any map" if np.isfinite(points[wrong[0]]).all() else "not finite"
    return [
        f"{path}: point {wrong[0]}: {what} ({place}), like {len(wrong) - 1} more. leave them out"
    ]


def _crs(text: str, map_frame: MapFrame, path: Path) -> tuple[list[str], list[str]]:
    """Return faults and notes of the coordinate system that a file names."""
    expected = f"EPSG:{map_frame.epsg}+{map_frame.vertical_epsg}"
    if not text:
        return [], [f"the file names no coordinate system: {expected} of the run is taken"]
    try:
        crs = CRS.from_user_input(text)
    except CRSError:
        return [f"{path}: crs: cannot be understood. write {expected}"], []
    faults = []
    try:
        require_crs(crs, epsg=map_frame.epsg, path=path)
    except ValueError as fault:
        faults.append(str(fault).replace("the scenario says", "the run is on"))
    vertical = crs.sub_crs_list[1] if crs.is_compound else None
    wanted = CRS.from_epsg(map_frame.vertical_epsg)
    if vertical is not None and vertical.to_epsg(min_confidence=20) != map_frame.vertical_epsg:
        if vertical.name != wanted.name:
            faults.append(
                f"{path}: vertical datum: {vertical.name}, but the run is on "
                f"EPSG:{map_frame.vertical_epsg} ({wanted.name}). transform the heights"
            )
    elif vertical is None:
        return faults, [
            f"the file names no vertical datum: that of the run ({wanted.name}) is taken"
        ]
    return faults, []

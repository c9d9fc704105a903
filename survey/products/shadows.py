"""Gaps of the coverage that were within a flash's view, and hidden."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from survey.cloud.sight import entry_points, is_hidden
from survey.flight.pose import Frame
from survey.flight.trajectory import footprint
from survey.products.coverage import GAP, SHADOW, CoverageMap
from survey.sensor.camera import Camera
from terrain.seabed import Seabed

if TYPE_CHECKING:
    from matplotlib.path import Path as Outline

FloatArray = NDArray[np.float64]


def with_shadows(
    coverage: CoverageMap,
    *,
    frames: Sequence[Frame],
    camera: Camera,
    seabed: Seabed,
    level: float,
    refractive_index: float,
) -> CoverageMap:
    """Return the map with gaps called shadows where the ground hides them from every flash.

    A gap is a shadow if its centre lies in the view of one flash or more, by its true pose and a
    level sea, and the seabed bars the way of the light to all of these. Other gaps within a view
    are places that pixels, far apart on a steep bed, look past.

    Parameters
    ----------
    coverage : CoverageMap
    frames : sequence of Frame
        Those that were flown.
    camera : Camera
    seabed : Seabed
        The true one.
    level : float
        Of the water [m].
    refractive_index : float
        Of the water [1].
    """
    gaps, origin = coverage.state == GAP, seabed.map_frame.origin[:2]
    in_view, seen = np.zeros((2, *gaps.shape), np.bool_)
    room = max(level - seabed.grid.z_low, seabed.grid.z_high - level)
    water = {"level": level, "refractive_index": refractive_index}
    for frame in frames:
        corners, sensor = footprint(camera, frame.pose, level), frame.pose.position
        window = coverage.cells.window_over(corners + origin, margin=room)
        row, column = np.nonzero(gaps[window] & ~seen[window])
        if row.size == 0:
            continue
        centres = coverage.cells.part(window).centres_at(row, column) - origin
        places = np.column_stack([centres, seabed.elevation_at(*centres.T)])
        outline = _outline(corners)
        near = np.isfinite(places[:, 2]) & _may_be_in(outline, places, level - places[:, 2])
        entry = entry_points(places[near], sensor=sensor, **water)
        viewed = np.flatnonzero(near)[outline.contains_points(entry[:, :2])]
        hidden = is_hidden(places[viewed], sensor=sensor, seabed=seabed, **water)
        in_view[window][row[viewed], column[viewed]] = True
        seen[window][row[viewed[~hidden]], column[viewed[~hidden]]] = True
    state = np.where(in_view & ~seen, SHADOW, coverage.state)
    return replace(coverage, state=state.astype(coverage.state.dtype))


def _outline(corners: FloatArray) -> Outline:
    from matplotlib.path import Path as Outline

    return Outline(corners)


def _may_be_in(outline: Outline, places: FloatArray, depth: FloatArray) -> NDArray[np.bool_]:
    """Tell places so near to an outline that light through it may reach them: a depth aside."""
    corners = np.asarray(outline.vertices)
    room = np.abs(depth)[:, None]
    above = places[:, :2] >= corners.min(axis=0) - room
    below = places[:, :2] <= corners.max(axis=0) + room
    return np.asarray((above & below).all(axis=1))

"""Whether footprints lie on the seabed, and where they do not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]

MOST_POINTS = 4_000_000


class CoverageError(ValueError):
    """Footprints reach beyond the seabed."""


@dataclass(frozen=True, kw_only=True)
class Gap:
    """What of the footprints has no seabed under it.

    ``low`` and ``high`` (2,) are its bounding box in the local frame [m], ``area`` its size [m2]
    and ``share`` its part of all the footprints [1].
    """

    low: FloatArray
    high: FloatArray
    area: float
    share: float

    def message(self, map_frame: MapFrame, label: str) -> str:
        """Return the line a user reads, in map coordinates."""
        (east, north), (east_1, north_1) = self.low, self.high
        return (
            f"{label}: {self.area:,.0f} m2 ({100.0 * self.share:.2g} %) of the footprints lie "
            f"outside the seabed, between easting {east + map_frame.easting:.1f} and "
            f"{east_1 + map_frame.easting:.1f}, northing {north + map_frame.northing:.1f} and "
            f"{north_1 + map_frame.northing:.1f} (EPSG:{map_frame.epsg}). "
            "move or shorten the lines, or give a larger seabed"
        )


def inside_any(outlines: Sequence[FloatArray], x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
    """Return which points of a lattice, columns x and rows y, lie in any polygon.

    Even-odd rule; polygons (corners, 2) need not be closed or convex.
    """
    inside = np.zeros((len(y), len(x)), dtype=bool)
    for outline in outlines:
        low, high = outline.min(axis=0), outline.max(axis=0)
        cols = slice(*np.searchsorted(x, [low[0], high[0]]))
        rows = slice(*np.searchsorted(y, [low[1], high[1]]))
        inside[rows, cols] |= _inside_one(outline, x[cols], y[rows])
    return inside


def _inside_one(outline: FloatArray, x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
    inside = np.zeros((len(y), len(x)), dtype=bool)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        crossed = (a[1] > y) != (b[1] > y)
        if a[1] != b[1]:
            meets = a[0] + (y - a[1]) * ((b[0] - a[0]) / (b[1] - a[1]))
            inside ^= crossed[:, None] & (x[None, :] < meets[:, None])
    return inside


def uncovered(
    elevation_at: Callable[[FloatArray, FloatArray], FloatArray],
    outlines: Sequence[FloatArray],
    *,
    spacing: float,
) -> Gap | None:
    """Return what of the polygons has no elevation, or None.

    Looked up on a lattice of ``spacing`` [m], wider where that would take more than four million
    points, and along the outlines.
    """
    if not outlines:
        return None
    low = np.min([o.min(axis=0) for o in outlines], axis=0)
    high = np.max([o.max(axis=0) for o in outlines], axis=0)
    step = max(spacing, float(np.sqrt(np.prod(high - low) / MOST_POINTS)))
    x, y = (np.arange(low[i] + 0.5 * step, high[i], step) for i in range(2))
    inside = inside_any(outlines, x, y)
    rows, cols = np.nonzero(inside)
    rim = np.concatenate([_along(outline, step) for outline in outlines])
    points = np.concatenate([np.column_stack([x[cols], y[rows]]), rim])
    bare = np.isnan(elevation_at(points[:, 0], points[:, 1]))
    if not bare.any():
        return None
    within = int(bare[: len(rows)].sum())
    return Gap(
        low=points[bare].min(axis=0),
        high=points[bare].max(axis=0),
        area=within * step**2,
        share=within / max(len(rows), 1),
    )


def _along(outline: FloatArray, step: float) -> FloatArray:
    """Return points on the rim of a polygon, its corners among them."""
    pieces = []
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        count = int(np.ceil(np.linalg.norm(b - a) / step)) + 1
        pieces.append(a + np.linspace(0.0, 1.0, count, endpoint=False)[:, None] * (b - a))
    return np.concatenate(pieces)

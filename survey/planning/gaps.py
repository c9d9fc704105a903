"""Gaps ("holidays"): ground that a flight should see and no frame sees."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from survey.products.cells import CellGrid
from survey.products.coverage import MIN_HOLE_AREA

FloatArray = NDArray[np.float64]

MOST_CELLS = 4_000_000
FINEST_CELL = 0.1
GREATEST_COUNT = 65_535


@dataclass(frozen=True, kw_only=True)
class Gap:
    """One gap.

    Parameters
    ----------
    area : float
        [m2].
    rings : list of array (n, 2)
        Its outline, then those of what is seen inside it; closed, in the local frame [m].
    """

    area: float
    rings: list[FloatArray]


@dataclass(frozen=True, kw_only=True)
class Swath:
    """How often each place is seen, on cells along and across the flight.

    Parameters
    ----------
    cells : CellGrid
        Along the flight (columns) and to its left (rows, the leftmost first) [m].
    turn : array (2, 2)
        Takes easting and northing to the cells' axes.
    seen : array (rows, columns)
        Frames that see a cell.
    planned : array (rows, columns)
        Cells that the flight should see.
    gaps : list of Gap
        Larger than `MIN_HOLE_AREA`, the largest first.
    """

    cells: CellGrid
    turn: FloatArray
    seen: NDArray[np.uint16]
    planned: NDArray[np.bool_]
    gaps: list[Gap]

    @property
    def seen_area(self) -> float:
        """Area that any frame sees [m2]."""
        return float((self.seen > 0).sum()) * self.cells.cell_size**2

    @property
    def gap_area(self) -> float:
        """Area of the gaps [m2]."""
        return sum(gap.area for gap in self.gaps)


def swath(
    polygons: Sequence[FloatArray], planned: Sequence[FloatArray], *, direction: FloatArray
) -> Swath:
    """Return what a flight sees of what it should see.

    Parameters
    ----------
    polygons : sequence of array (n, 2)
        What each frame sees [m].
    planned : sequence of array (n, 2)
        What the flight should see, in parts that may lie over each other [m].
    direction : array (2,)
        Unit vector along which the cells lie.

    Examples
    --------
    >>> def box(x):
    ...     return np.array([[x, 0.0], [x + 20.0, 0.0], [x + 20.0, 10.0], [x, 10.0]])
    >>> found = swath([box(0.0), box(30.0)], [box(0.0), box(15.0), box(30.0)],
    ...               direction=np.array([1.0, 0.0]))
    >>> round(found.seen_area, 3), [round(gap.area, 3) for gap in found.gaps]
    (400.0, [100.0])
    """
    turn = np.array([direction, [-direction[1], direction[0]]])
    turned = [ring @ turn.T for ring in polygons]
    wanted = [ring @ turn.T for ring in planned]
    corners = np.concatenate([*turned, *wanted])
    extent = np.ptp(corners, axis=0)
    cell = max(sqrt(float(np.prod(extent)) / MOST_CELLS), FINEST_CELL)
    cells = CellGrid.covering(corners, cell_size=cell)
    seen, inside = _counted(turned, cells), _counted(wanted, cells) > 0
    return Swath(
        cells=cells,
        turn=turn,
        seen=seen,
        planned=inside,
        gaps=_gaps(inside & (seen == 0), cells, turn),
    )


def _counted(rings: Sequence[FloatArray], cells: CellGrid) -> NDArray[np.uint16]:
    """Return in how many rings each cell's centre lies."""
    from rasterio.enums import MergeAlg
    from rasterio.features import rasterize

    if not rings:
        return np.zeros(cells.shape, np.uint16)
    shapes = (
        {"type": "Polygon", "coordinates": [[*ring.tolist(), ring[0].tolist()]]} for ring in rings
    )
    counts = rasterize(
        ((shape, 1) for shape in shapes),
        out_shape=cells.shape,
        transform=cells.transform,
        merge_alg=MergeAlg.add,
        dtype="int32",
    )
    return np.asarray(np.minimum(counts, GREATEST_COUNT), np.uint16)


def _gaps(missing: NDArray[np.bool_], cells: CellGrid, turn: FloatArray) -> list[Gap]:
    from rasterio.features import shapes

    found = []
    for shape, _ in shapes(
        missing.astype(np.uint8), mask=missing, connectivity=4, transform=cells.transform
    ):
        rings = [np.array(ring) for ring in shape["coordinates"]]
        outer, *inner = (abs(_signed_area(ring)) for ring in rings)
        if outer - sum(inner) > MIN_HOLE_AREA:
            found.append(Gap(area=outer - sum(inner), rings=[ring @ turn for ring in rings]))
    return sorted(found, key=lambda gap: -gap.area)


def _signed_area(ring: FloatArray) -> float:
    x, y = (ring - ring[0]).T
    return float(0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))

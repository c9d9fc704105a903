"""How far the lines of a survey differ in elevation where they overlap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass

FloatArray = NDArray[np.float64]

SOLID = (PointClass.GROUND, PointClass.BATHYMETRIC, PointClass.SUBMERGED_OBJECT)


@dataclass(frozen=True, kw_only=True)
class LineCells:
    """Mean elevations of each line by cells, a row for each line and cell that holds a point.

    Parameters
    ----------
    cell_size : float
        Side of a cell [m].
    cell : array (n, 2)
        Cells eastward and northward from zero.
    line : array (n,)
        Lines.
    elevation : array (n,)
        Mean elevations [m].
    """

    cell_size: float
    cell: NDArray[np.int64]
    line: NDArray[np.int64]
    elevation: FloatArray


def line_cells(places: FloatArray, line: NDArray[np.uint16], *, cell_size: float) -> LineCells:
    """Return the cells of points (n, 3) [m] of lines (n,)."""
    cells = np.floor(places[:, :2].T / cell_size).astype(np.int64)
    addresses = np.vstack([line.astype(np.int64), cells])
    lowest = addresses.min(axis=1, initial=0)
    extent = addresses.max(axis=1, initial=0) - lowest + 1
    one_number = np.ravel_multi_index(addresses - lowest[:, None], extent)
    keys, group = np.unique(one_number, return_inverse=True)
    total = np.bincount(group, places[:, 2], len(keys))
    found = np.column_stack(np.unravel_index(keys, extent)) + lowest
    return LineCells(
        cell_size=cell_size,
        line=found[:, 0],
        cell=found[:, 1:],
        elevation=total / np.bincount(group, minlength=len(keys)),
    )


@dataclass(frozen=True, kw_only=True)
class Overlap:
    """Two lines where both have points.

    Parameters
    ----------
    lines : (int, int)
        The earlier and the later line.
    area : float
        Of the cells that hold points of both [m2].
    differences : array (cells,)
        Mean elevation of the later less that of the earlier line, by cells [m].
    """

    lines: tuple[int, int]
    area: float
    differences: FloatArray


class OverlapTally:
    """Gathers overlaps from parts of the map that have no cell in common.

    Examples
    --------
    >>> tally = OverlapTally()
    >>> tally.add(LineCells(cell_size=2.0, cell=np.array([[0, 0], [0, 0], [1, 0]]),
    ...     line=np.array([3, 5, 5]), elevation=np.array([-4.0, -3.0, -3.0])))
    >>> [(each.lines, each.area, each.differences.tolist()) for each in tally.overlaps()]
    [((3, 5), 4.0, [1.0])]
    """

    def __init__(self) -> None:
        self._cell_area = 0.0
        self._differences: dict[tuple[int, int], list[FloatArray]] = {}

    def add(self, part: LineCells) -> None:
        """Add the cells of a part of the map."""
        self._cell_area = part.cell_size**2
        order = np.lexsort((part.line, part.cell[:, 1], part.cell[:, 0]))
        cell, line, elevation = part.cell[order], part.line[order], part.elevation[order]
        for step in range(1, len(order)):
            first = np.flatnonzero((cell[step:] == cell[:-step]).all(axis=1))
            if first.size == 0:
                return
            pairs = np.column_stack([line[first], line[first + step]])
            differences = elevation[first + step] - elevation[first]
            for pair in np.unique(pairs, axis=0):
                here = differences[(pairs == pair).all(axis=1)]
                self._differences.setdefault((int(pair[0]), int(pair[1])), []).append(here)

    def overlaps(self) -> list[Overlap]:
        """Return the overlaps of every two lines that have a cell in common, by lines."""
        found = {lines: np.concatenate(parts) for lines, parts in self._differences.items()}
        return [
            Overlap(lines=lines, area=len(found[lines]) * self._cell_area, differences=found[lines])
            for lines in sorted(found)
        ]

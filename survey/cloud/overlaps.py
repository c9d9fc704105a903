"""How far the lines of a survey differ in elevation where they overlap."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud

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
        Cells eastward and northward from the origin of the local frame.
    line : array (n,)
        Lines.
    total : array (n,)
        Sum of the elevations [m].
    count : array (n,)
        Points.
    """

    cell_size: float
    cell: NDArray[np.int64]
    line: NDArray[np.int64]
    total: FloatArray
    count: NDArray[np.int64]

    @property
    def elevation(self) -> FloatArray:
        """Mean elevations (n,) [m]."""
        return np.asarray(self.total / self.count)


def line_cells(clouds: Iterable[PointCloud], *, cell_size: float) -> LineCells:
    """Return the lines' cells of clouds that are read one after the other: bottom, objects, land.

    Memory grows with the cells of the map, not with the points of a cloud.
    """
    rows = [_rows(cloud, cell_size) for cloud in clouds]
    whole = np.concatenate([np.zeros((0, 5)), *rows])
    keys, group = np.unique(whole[:, :3].astype(np.int64), axis=0, return_inverse=True)
    return LineCells(
        cell_size=cell_size,
        line=keys[:, 0],
        cell=keys[:, 1:],
        total=np.bincount(group, whole[:, 3], len(keys)).astype(np.float64),
        count=np.bincount(group, whole[:, 4], len(keys)).astype(np.int64),
    )


def _rows(cloud: PointCloud, cell_size: float) -> FloatArray:
    """Return line, cell eastward and northward, sum and number of each cell of a cloud (m, 5)."""
    solid = np.isin(cloud.classification, SOLID)
    place = cloud.position[solid]
    cells = np.floor(place[:, :2] / cell_size)
    keys, group = np.unique(
        np.column_stack([cloud.line[solid], cells]), axis=0, return_inverse=True
    )
    total, count = np.bincount(group, place[:, 2], len(keys)), np.bincount(group, None, len(keys))
    return np.column_stack([keys, total, count])


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


def overlaps(found: LineCells) -> list[Overlap]:
    """Return the overlaps of every two lines that have a cell in common, in the order of lines.

    Examples
    --------
    >>> two = LineCells(cell_size=2.0, cell=np.array([[0, 0], [0, 0], [1, 0]]),
    ...     line=np.array([3, 5, 5]), total=np.array([-8.0, -3.0, -3.0]), count=np.array([2, 1, 1]))
    >>> [(each.lines, each.area, each.differences.tolist()) for each in overlaps(two)]
    [((3, 5), 4.0, [1.0])]
    """
    order = np.lexsort((found.line, found.cell[:, 1], found.cell[:, 0]))
    cell, line, elevation = found.cell[order], found.line[order], found.elevation[order]
    parts = []
    for step in range(1, len(order)):
        same = (cell[step:] == cell[:-step]).all(axis=1)
        if not same.any():
            break
        first = np.flatnonzero(same)
        parts.append(
            np.column_stack(
                [line[first], line[first + step], elevation[first + step] - elevation[first]]
            )
        )
    pairs = np.concatenate([np.zeros((0, 3)), *parts])
    names, group = np.unique(pairs[:, :2].astype(np.int64), axis=0, return_inverse=True)
    return [
        Overlap(
            lines=(int(names[i, 0]), int(names[i, 1])),
            area=float((group == i).sum() * found.cell_size**2),
            differences=pairs[group == i, 2],
        )
        for i in range(len(names))
    ]

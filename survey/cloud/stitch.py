"""All frames in one cloud, overlaps thinned by a stated rule."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud


def stitched(clouds: Sequence[PointCloud], *, cell_size: float) -> PointCloud:
    """Return the points of all frames, the best one in every cell of the map.

    Cells are squares aligned with the map. Where several points fall into one, a found echo wins
    over "no bottom found" (45), then the higher signal-to-noise ratio, then the earlier pixel.
    The result is in the order of frame, row and column.

    Parameters
    ----------
    clouds : sequence of PointCloud
        In any order.
    cell_size : float
        Side of a cell [m]; 0 keeps every point.
    """
    cloud = PointCloud.concatenate(clouds)
    return cloud.select(kept_points(cloud, cell_size=cell_size))


def kept_points(cloud: PointCloud, *, cell_size: float) -> NDArray[np.intp]:
    """Return which points of a cloud `stitched` keeps, in the order of frame, row and column."""
    order = np.lexsort((cloud.column, cloud.row, cloud.frame))
    if cell_size == 0.0 or len(cloud) == 0:
        return order
    east, north = np.floor(cloud.position[order, :2] / cell_size).astype(np.int64).T
    cell = (east - east.min()) * (np.ptp(north) + 1) + north - north.min()
    missing = cloud.classification[order] == PointClass.NO_BOTTOM_FOUND
    best_first = np.lexsort((-cloud.snr[order], missing, cell))
    first = np.ones(len(order), np.bool_)
    first[1:] = np.diff(cell[best_first]) != 0
    return order[np.sort(best_first[first])]

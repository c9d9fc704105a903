"""All frames in one cloud, overlaps thinned by a stated rule."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from survey.cloud.points import NOISE_CLASSES, PointClass, PointCloud


def stitched(clouds: Sequence[PointCloud], *, cell_size: float) -> PointCloud:
    """Return the points of all frames, the best one in every cell of the map.

    Cells are squares aligned with the map. Where several points fall into one, a found echo wins
    over "no bottom found" (45) and that over noise (7, 18), then the higher signal-to-noise ratio,
    then the earlier pixel. The result is in the order of frame, row and column.

    Parameters
    ----------
    clouds : sequence of PointCloud
        In any order.
    cell_size : float
        Side of a cell [m]; 0 keeps every point.
    """
    cloud = PointCloud.concatenate(clouds)
    cloud = cloud.select(np.lexsort((cloud.column, cloud.row, cloud.frame)))
    if cell_size == 0.0 or len(cloud) == 0:
        return cloud
    east, north = np.floor(cloud.position[:, :2] / cell_size).astype(np.int64).T
    missing = (cloud.classification == PointClass.NO_BOTTOM_FOUND).astype(np.uint8)
    missing[np.isin(cloud.classification, NOISE_CLASSES)] = 2
    order = np.lexsort((np.arange(len(cloud)), -cloud.snr, missing, north, east))
    first = np.ones(len(order), np.bool_)
    first[1:] = (np.diff(east[order]) != 0) | (np.diff(north[order]) != 0)
    return cloud.select(np.sort(order[first]))

"""The true seabed under a survey, coarse enough for a page."""

from __future__ import annotations

from typing import Any

import numpy as np

from survey.cloud.points import PointCloud
from terrain.seabed import Seabed
from viewer.scene import cell_for
from viewer.web.columns import packed, rounded, start_of
from viewer.web.points import VERTICAL_STEP


def true_seabed(seabed: Seabed, bottom: PointCloud) -> dict[str, Any]:
    """Return true elevations on a grid over the extent of a cloud, as the page's JSON.

    Parameters
    ----------
    seabed : Seabed
        What was flown over.
    bottom : PointCloud
        Points of the bottom, local [m].

    Returns
    -------
    dict
        ``x``, ``y`` of the first node and ``cell`` [m], ``columns``, ``rows``, and the elevations
        row by row as `packed`.
    """
    low, high = bottom.position[:, :2].min(axis=0), bottom.position[:, :2].max(axis=0)
    cell = cell_for(high - low)
    x, y = (np.arange(low[i], high[i] + cell, cell) for i in range(2))
    elevation = seabed.elevation_at(*np.meshgrid(x, y)).ravel()
    return {
        "x": float(low[0]),
        "y": float(low[1]),
        "cell": cell,
        "columns": len(x),
        "rows": len(y),
        "step": VERTICAL_STEP,
        "start": start_of(elevation, VERTICAL_STEP),
        "elevation": packed({"z": rounded(elevation, VERTICAL_STEP)}),
    }

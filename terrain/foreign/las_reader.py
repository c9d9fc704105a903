"""Points of a LAS or LAZ file, read in the child."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from terrain.foreign.faults import readable
from terrain.foreign.las_header import require_plausible_header

POINTS_AT_ONCE = 1_000_000


def read_points(
    path: str, *, classes: Sequence[int], box: Sequence[Sequence[float]] | None
) -> dict[str, Any]:
    """Return the points of some classes.

    Parameters
    ----------
    path : str
    classes : sequence of int
        LAS classes.
    box : ((west, south), (east, north)), optional
        Points outside are left out [m].

    Returns
    -------
    dict
        ``points`` (n, 3) as the file has them, and ``crs``, its WKT, empty where there is none.

    Raises
    ------
    ReaderError
        When it is no readable file.
    """
    import laspy

    require_plausible_header(Path(path))
    kept = [np.empty((0, 3))]
    with readable("LAS or LAZ file"), laspy.open(path) as source:
        crs = source.header.parse_crs()
        for chunk in source.chunk_iterator(POINTS_AT_ONCE):
            kept.append(_wanted(chunk, classes, box))
        return {"points": np.concatenate(kept), "crs": crs.to_wkt() if crs else ""}


def _wanted(
    chunk: Any, classes: Sequence[int], box: Sequence[Sequence[float]] | None
) -> NDArray[np.float64]:
    xyz = np.column_stack([chunk.x, chunk.y, chunk.z])
    wanted = np.isin(np.asarray(chunk.classification), classes)
    if box is not None:
        wanted &= ((xyz[:, :2] >= box[0]) & (xyz[:, :2] <= box[1])).all(axis=1)
    return np.asarray(xyz[wanted])

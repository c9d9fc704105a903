"""The clouds of a run for the page: in the order of flight, rounded, at most so many."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from viewer.clouds import clouds_of
from viewer.run_folder import FlownSurvey
from viewer.web.attributes import measures_of
from viewer.web.columns import packed, rounded, start_of

HORIZONTAL_STEP, VERTICAL_STEP = 0.02, 0.005
"""To which places are rounded [m]."""

SURFACE_SHARE = 10
"""The sea has at most one point where the bottom may have so many."""


@dataclass(frozen=True, kw_only=True)
class Chosen:
    """Points of one kind.

    Parameters
    ----------
    cloud : PointCloud
        Sorted by frame, row and column.
    of : int
        Among how many they were chosen.
    """

    cloud: PointCloud
    of: int


def chosen_points(flown: FlownSurvey, *, at_most: int) -> dict[str, Chosen]:
    """Return the points to be shown: of the bottom, of pixels without one, and of the sea.

    Parameters
    ----------
    flown : FlownSurvey
    at_most : int
        So many of the bottom, a tenth of the others; drawn by lot where there are more.

    Raises
    ------
    UserError
        If there is no point of bottom or ground.
    """
    few = max(at_most // SURFACE_SHARE, 1)
    return {
        name: by_lot(cloud, at_most=at_most if name == "bottom" else few)
        for name, cloud in clouds_of(flown).items()
    }


def by_lot(cloud: PointCloud, *, at_most: int) -> Chosen:
    """Return at most so many points, in the order of flight. The same cloud gives the same."""
    lot = np.random.default_rng(0).permutation(len(cloud))[:at_most]
    order = np.lexsort((cloud.column[lot], cloud.row[lot], cloud.frame[lot]))
    return Chosen(cloud=cloud.select(lot[order]), of=len(cloud))


def packed_cloud(cloud: PointCloud, *, columns_of_camera: int) -> dict[str, Any]:
    """Return places and addresses of points as `packed`, with the steps to undo the rounding."""
    axes = zip("xyz", _steps(), strict=True)
    places = {axis: (cloud.position[:, i], step) for i, (axis, step) in enumerate(axes)}
    table = packed(
        {axis: rounded(values, step) for axis, (values, step) in places.items()}
        | {"frame": cloud.frame, "pixel": _pixel(cloud, columns_of_camera)}
    )
    steps = {
        axis: {"step": step, "start": start_of(values, step)}
        for axis, (values, step) in places.items()
    }
    return table | {"places": steps, "pixelColumns": columns_of_camera}


def packed_bottom(cloud: PointCloud, *, columns_of_camera: int) -> dict[str, Any]:
    """Return the bottom as `packed_cloud`, and all that it can be coloured by."""
    measures, _ = measures_of(cloud)
    codes = {
        "class": cloud.classification,
        "cause": cloud.cause,
        "substrate": cloud.substrate,
    }
    return packed_cloud(cloud, columns_of_camera=columns_of_camera) | {
        "attributes": packed(measures | codes)
    }


def _steps() -> tuple[float, float, float]:
    return HORIZONTAL_STEP, HORIZONTAL_STEP, VERTICAL_STEP


def _pixel(cloud: PointCloud, columns: int) -> NDArray[np.int64]:
    return cloud.row.astype(np.int64) * columns + cloud.column

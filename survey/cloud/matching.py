"""Neighbours between two strips and the planes around them, by open3d.

open3d sums in parallel in an order that changes; what is taken from it here, normals and nearest
neighbours, is each computed for itself, and is sorted.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]

NEIGHBOURS = 60


def normals_of(places: FloatArray, *, radius: float) -> FloatArray:
    """Return unit normals (n, 3), upwards, of planes through the neighbours within a radius [m].

    A place with fewer than three of them has a vertical one.
    """
    import open3d

    cloud = _open3d_cloud(places)
    cloud.estimate_normals(
        open3d.geometry.KDTreeSearchParamHybrid(radius=radius, max_nn=NEIGHBOURS)
    )
    normals = np.asarray(cloud.normals)
    return normals * np.where(normals[:, 2:] < 0.0, -1.0, 1.0)


def nearest(
    first: FloatArray, second: FloatArray, *, reach: float
) -> tuple[IndexArray, IndexArray]:
    """Return pairs (k,), (k,): points of the first cloud and the nearest of the second.

    As far as there is one within reach [m]; in the order of the first cloud.
    """
    from open3d.pipelines.registration import evaluate_registration

    found = evaluate_registration(_open3d_cloud(first), _open3d_cloud(second), reach)
    pairs = np.asarray(found.correspondence_set, dtype=np.intp).reshape(-1, 2)
    pairs = pairs[np.argsort(pairs[:, 0], kind="stable")]
    return pairs[:, 0], pairs[:, 1]


def _open3d_cloud(places: FloatArray) -> Any:
    import open3d

    return open3d.geometry.PointCloud(open3d.utility.Vector3dVector(places))

"""What was found on every kind of bottom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from survey.cloud.points import Outcome, PointCloud
from survey.products.accuracy import BOTTOM_CLASSES, elevation_errors
from survey.products.frame_file import FrameResult
from terrain.substrate import UNLABELLED

DECIMALS = 6


def substrate_metrics(
    bottom: PointCloud, results: Sequence[FrameResult], names: Mapping[int, str]
) -> dict[str, dict[str, Any]]:
    """Return what was found on every substrate, by its name; None where there is no such point.

    ================  ==========================================================================
    code              in the points' column ``substrate``
    pixels_wet        wet pixels that truly look at it, in all frames
    found_fraction    share of these whose bottom was found
    points_bottom     its points of classes 40 and 43
    bias_m, rmse_m    of these points, measured less true elevation
    ================  ==========================================================================

    Parameters
    ----------
    bottom : PointCloud
        Stitched.
    results : sequence of FrameResult
        Of all frames, a bottom point for every pixel.
    names : mapping
        Name of every code; what has no label counts as ``unlabelled``.
    """
    seen = np.concatenate([result.bottom.substrate for result in results])
    depth = np.concatenate([result.record.true_depth.ravel() for result in results])
    outcome = np.concatenate([result.record.outcome.ravel() for result in results])
    solid = bottom.select(np.isin(bottom.classification, BOTTOM_CLASSES))
    found: dict[str, dict[str, Any]] = {}
    for code, name in sorted({**names, UNLABELLED: "unlabelled"}.items()):
        here = (seen == code) & (depth > 0.0)
        points = solid.select(solid.substrate == code)
        if here.any() or len(points) > 0:
            share = float((outcome[here] == Outcome.FOUND).mean()) if here.any() else None
            found[name] = {
                "code": code,
                "pixels_wet": int(here.sum()),
                "found_fraction": share if share is None else round(share, DECIMALS),
                "points_bottom": len(points),
                **_errors(points),
            }
    return found


def _errors(points: PointCloud) -> dict[str, float | None]:
    errors = elevation_errors(points)
    if errors.size == 0:
        return {"bias_m": None, "rmse_m": None}
    return {
        "bias_m": round(float(errors.mean()), DECIMALS),
        "rmse_m": round(float(np.sqrt(np.mean(errors**2))), DECIMALS),
    }

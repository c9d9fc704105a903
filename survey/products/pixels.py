"""What became of the bottom, counted over all pixels of a mission."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Outcome, PixelRecord

DETECTABLE, HALF = 0.9, 0.5
DEPTH_BIN = 0.5
SEEN = (Outcome.FOUND, Outcome.DRY)
REASONS = {
    Outcome.FALSE_BOTTOM: "only false bottoms were found",
    Outcome.TOO_DEEP: "the bottom echo is too weak: the bottom is too deep in such water",
    Outcome.TOO_TURBID: "the bottom echo is too weak: a layer of the water is too turbid",
    Outcome.LOW_REFLECTANCE: "the bottom echo is too weak: the bottom is dark",
    Outcome.GLINT: "the bottom echo is lost in the echo of the water surface",
    Outcome.NOISE: "bottoms stood alone and were taken for noise",
    Outcome.MERGED_WITH_SURFACE: "too shallow: the bottom echo is merged with the surface echo",
    Outcome.OUTSIDE_GATE: "the bottom echo lies outside the receiver's gate",
    Outcome.SATURATED: "the detector is saturated",
    Outcome.CHANCE: "the echo could have been seen and by chance was not",
}


def pixel_metrics(records: Sequence[PixelRecord]) -> dict[str, Any]:
    """Return what the pixels say, as plain values; None where there is no such pixel.

    A wet pixel is one whose true depth is above 0.

    ======================================  ====================================================
    pixels_wet                              wet pixels
    missed                                  wet pixels by `Outcome` name, FOUND and DRY left out
    monte_carlo_relative_error              median over wet pixels with a bottom echo
    found_fraction                          share of wet pixels with outcome FOUND
    found_fraction_where_detectable         the same where detection_probability >= 0.9
    detection_depth_m                       deep edge of the deepest 0.5 m bin of true depth, or
                                            the deepest pixel, whose median
                                            detection_probability is >= 0.9
    found_fraction_above_detection_depth    share of FOUND in all wet pixels down to there
    found_depth_m                           the same edge of the deepest such bin that has 0.9 of
                                            its pixels FOUND
    half_found_depth_m                      and of that with half of them
    ======================================  ====================================================
    """
    depth = _wet_column(records, "true_depth")
    outcome = _wet_column(records, "outcome")
    probability = _wet_column(records, "detection_probability")
    error = _wet_column(records, "monte_carlo_relative_error")
    error = error[np.isfinite(error) & (_wet_column(records, "bottom_counts") > 0.0)]
    limit = deepest(depth, lambda here: np.median(probability[here]) >= DETECTABLE)
    found = outcome == Outcome.FOUND
    return {
        "pixels_wet": int(depth.size),
        "missed": {
            cause.name.lower(): int((outcome == cause).sum())
            for cause in Outcome
            if cause not in SEEN
        },
        "monte_carlo_relative_error": float(np.median(error)) if error.size else None,
        "found_fraction": _share(found),
        "found_fraction_where_detectable": _share(found[probability >= DETECTABLE]),
        "detection_depth_m": limit,
        "found_fraction_above_detection_depth": None
        if limit is None
        else _share(found[depth <= limit]),
        "found_depth_m": deepest(depth, lambda here: found[here].mean() >= DETECTABLE),
        "half_found_depth_m": deepest(depth, lambda here: found[here].mean() >= HALF),
    }


def explain_empty(records: Sequence[PixelRecord]) -> str:
    """Return in one sentence why a mission found no bottom: the commonest outcome and its share.

    Examples
    --------
    >>> record = PixelRecord(
    ...     true_position=np.zeros((1, 2, 3)), true_depth=np.full((1, 2), 40.0),
    ...     detection_probability=np.zeros((1, 2)), bottom_counts=np.zeros((1, 2)),
    ...     outcome=np.full((1, 2), Outcome.TOO_DEEP, dtype=np.uint8),
    ...     monte_carlo_relative_error=np.zeros((1, 2)))
    >>> explain_empty([record])
    'no bottom found: the bottom echo is too weak: the bottom is too deep in such water
    (100 % of 2 wet pixels, true depth 40.0 to 40.0 m)'
    """
    depth = _wet_column(records, "true_depth")
    if depth.size == 0:
        return "no bottom found: no pixel looks at water. Check flight, seabed and water level"
    outcome = _wet_column(records, "outcome")
    counts = {cause: int((outcome == cause).sum()) for cause in Outcome}
    commonest = max(REASONS, key=lambda cause: counts[cause])
    return (
        f"no bottom found: {REASONS[commonest]} "
        f"({100.0 * counts[commonest] / depth.size:.0f} % of {depth.size} wet pixels, "
        f"true depth {depth.min():.1f} to {depth.max():.1f} m)"
    )


def _wet_column(records: Sequence[PixelRecord], name: str) -> NDArray[Any]:
    columns = [getattr(record, name)[record.true_depth > 0.0] for record in records]
    return np.concatenate([np.zeros(0), *columns])


def _share(which: NDArray[np.bool_]) -> float | None:
    return float(which.mean()) if which.size else None


def deepest(depth: NDArray[Any], good: Callable[[NDArray[np.bool_]], Any]) -> float | None:
    """Return how deep the deepest good bin of depth reaches [m]; None where none is good.

    Parameters
    ----------
    depth : array (n,)
        True depths [m], sorted into bins of 0.5 m.
    good : callable
        Tells by the mask of a bin's members whether the bin is good.

    Examples
    --------
    >>> found = np.array([True, True, False, True])
    >>> deepest(np.array([1.1, 1.2, 1.6, 1.3]), lambda here: found[here].mean() > 0.5)
    1.5
    """
    bins = np.floor(depth / DEPTH_BIN).astype(np.intp)
    for number in np.unique(bins)[::-1]:
        if good(bins == number):
            return float(min((number + 1) * DEPTH_BIN, depth.max()))
    return None

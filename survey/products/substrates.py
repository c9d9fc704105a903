"""What was found on every kind of bottom."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import BOTTOM_CLASSES, Outcome, PixelRecord, PointCloud
from survey.products.pixels import share
from terrain.substrate import UNLABELLED

DECIMALS = 6
CODES = 256


class SubstrateTally:
    """Counts pixels and points by substrate."""

    def __init__(self) -> None:
        self._wet, self._found, self._points, self._known = np.zeros((4, CODES), np.int64)
        self._errors, self._squares = np.zeros((2, CODES))

    def add_pixels(self, record: PixelRecord, substrate: NDArray[np.uint8]) -> None:
        """Add pixels, each with the code of what it truly looks at (pixels,)."""
        wet = record.true_depth.ravel() > 0.0
        seen, outcome = substrate[wet], record.outcome.ravel()[wet]
        self._wet += np.bincount(seen, minlength=CODES)
        self._found += np.bincount(seen[outcome == Outcome.FOUND], minlength=CODES)

    def add_points(self, bottom: PointCloud) -> None:
        """Add stitched points."""
        solid = np.isin(bottom.classification, BOTTOM_CLASSES)
        code = bottom.substrate[solid]
        errors = (bottom.position[:, 2] - bottom.true_elevation)[solid]
        known = np.isfinite(errors)
        self._points += np.bincount(code, minlength=CODES)
        self._known += np.bincount(code[known], minlength=CODES)
        self._errors += np.bincount(code[known], errors[known], CODES)
        self._squares += np.bincount(code[known], errors[known] ** 2, CODES)

    def metrics(self, names: Mapping[int, str]) -> dict[str, dict[str, Any]]:
        """Return what was found on every substrate, by its name; None where there is no such point.

        ================  ======================================================================
        code              in the points' column ``substrate``
        pixels_wet        wet pixels that truly look at it, in all frames
        found_fraction    share of these whose bottom was found
        points_bottom     its points of classes 40 and 43
        bias_m, rmse_m    of these points, measured less true elevation
        ================  ======================================================================

        Parameters
        ----------
        names : mapping
            Name of every code; what has no label counts as ``unlabelled``.
        """
        return {
            name: {
                "code": code,
                "pixels_wet": int(self._wet[code]),
                "found_fraction": _rounded(share(int(self._found[code]), int(self._wet[code]))),
                "points_bottom": int(self._points[code]),
                **self._error_metrics(code),
            }
            for code, name in sorted({**names, UNLABELLED: "unlabelled"}.items())
            if self._wet[code] > 0 or self._points[code] > 0
        }

    def _error_metrics(self, code: int) -> dict[str, float | None]:
        count = self._known[code]
        if count == 0:
            return {"bias_m": None, "rmse_m": None}
        return {
            "bias_m": _rounded(float(self._errors[code] / count)),
            "rmse_m": _rounded(float(np.sqrt(self._squares[code] / count))),
        }


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, DECIMALS)

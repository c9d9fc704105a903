"""Errors of the bottom points by depth, and echoes found by their strength."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import BOTTOM_CLASSES, Outcome, PixelRecord, PointCloud
from survey.cloud.truth import FALSE_BOTTOM_ERROR

FloatArray = NDArray[np.float64]

DEPTH_STEP = 1.0  # [m]
ERROR_STEP = 0.002  # [m]
ERRORS = round(2.0 * FALSE_BOTTOM_ERROR / ERROR_STEP)
FEWEST = 20
DECADE_PARTS, FAINTEST, STRONGEST = 4, -1.0, 5.0


class DepthProfile:
    """How far bottom points lie off, by steps of a metre of measured depth.

    False bottoms, more than 1 m off, are counted apart: a mean of both would tell of neither.

    Examples
    --------
    >>> profile = DepthProfile()
    >>> profile.add_errors(np.full(40, 3.2), np.linspace(-0.1, 0.3, 40))
    >>> [(row["from_m"], row["points"], round(row["mean_m"], 2)) for row in profile.metrics()]
    [(3.0, 40, 0.1)]
    """

    def __init__(self) -> None:
        self._counts, self._false = np.zeros((0, ERRORS), np.int64), np.zeros(0, np.int64)

    def add(self, bottom: PointCloud) -> None:
        """Add stitched points; those under water with a known true bottom count."""
        solid = bottom.select(np.isin(bottom.classification, BOTTOM_CLASSES))
        error = solid.position[:, 2] - solid.true_elevation
        known = np.isfinite(error) & (solid.depth > 0.0)
        self.add_errors(solid.depth[known], error[known])

    def add_errors(self, depth: FloatArray, error: FloatArray) -> None:
        """Add errors (n,) at depths (n,), both [m]."""
        row = (depth / DEPTH_STEP).astype(np.intp)
        rows = max(len(self._false), int(row.max(initial=-1)) + 1)
        place = np.floor((error + FALSE_BOTTOM_ERROR) / ERROR_STEP).astype(np.intp)
        near = (place >= 0) & (place < ERRORS)
        counts = np.bincount(row[near] * ERRORS + place[near], minlength=rows * ERRORS)
        self._counts = _grown(self._counts, counts.reshape(rows, ERRORS))
        self._false = _grown(self._false, np.bincount(row[~near], minlength=rows))

    def metrics(self) -> list[dict[str, Any]]:
        """Return a row for each metre of depth that has points.

        Keys are from_m, to_m, points, false_bottoms, and, of at least twenty points that are none,
        mean_m, low_m and high_m: mean error, and between which errors 95 % lie, to 2 mm.
        """
        return [
            self._row(number)
            for number in range(len(self._false))
            if self._counts[number].any() or self._false[number]
        ]

    def _row(self, number: int) -> dict[str, Any]:
        counts = self._counts[number]
        total = int(counts.sum())
        row: dict[str, Any] = {
            "from_m": number * DEPTH_STEP,
            "to_m": (number + 1) * DEPTH_STEP,
            "points": total,
            "false_bottoms": int(self._false[number]),
        }
        if total < FEWEST:
            return row
        error = (np.arange(ERRORS) + 0.5) * ERROR_STEP - FALSE_BOTTOM_ERROR
        upto = np.cumsum(counts) / total
        low, high = error[np.searchsorted(upto, (0.025, 0.975))]
        mean = float((counts * error).sum() / total)
        return row | {"mean_m": mean, "low_m": float(low), "high_m": float(high)}


class StrengthProfile:
    """How many true bottoms were found, by the counts that their echo was expected to give."""

    def __init__(self) -> None:
        self._bins = round((STRONGEST - FAINTEST) * DECADE_PARTS)
        self._pixels, self._found = np.zeros((2, self._bins), np.int64)
        self._probable = np.zeros(self._bins)

    def add(self, record: PixelRecord) -> None:
        """Add the wet pixels of frames whose bottom's echo had light."""
        lit = (record.true_depth > 0.0) & (record.bottom_counts > 10.0**FAINTEST)
        place = (np.log10(record.bottom_counts[lit]) - FAINTEST) * DECADE_PARTS
        place = np.minimum(place.astype(np.intp), self._bins - 1)
        found = record.outcome[lit] == Outcome.FOUND
        self._pixels += np.bincount(place, minlength=self._bins)
        self._found += np.bincount(place[found], minlength=self._bins)
        self._probable += np.bincount(
            place, record.detection_probability[lit], minlength=self._bins
        )

    def metrics(self) -> list[dict[str, Any]]:
        """Return a row for each quarter of a decade that has at least twenty pixels.

        Keys are from_counts, to_counts, pixels, found_fraction and expected_fraction, the mean of
        the pixels' detection probabilities.
        """
        edges = 10.0 ** (FAINTEST + np.arange(self._bins + 1) / DECADE_PARTS)
        return [
            {
                "from_counts": float(edges[i]),
                "to_counts": float(edges[i + 1]),
                "pixels": int(self._pixels[i]),
                "found_fraction": float(self._found[i] / self._pixels[i]),
                "expected_fraction": float(self._probable[i] / self._pixels[i]),
            }
            for i in np.flatnonzero(self._pixels >= FEWEST)
        ]


def _grown(before: NDArray[np.int64], more: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the sum of counts by rows, the first possibly of fewer rows."""
    result = more.astype(np.int64)
    result[: len(before)] += before
    return result

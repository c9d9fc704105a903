"""What became of the bottom, counted over all pixels of a mission."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from survey.cloud.points import Outcome, PixelRecord
from survey.products.tally import DepthBins, ErrorTally

DETECTABLE, HALF = 0.9, 0.5
SEEN = (Outcome.FOUND, Outcome.DRY)
REASONS = {
    Outcome.FALSE_BOTTOM: "only false bottoms were found",
    Outcome.TOO_WEAK: "the bottom echo is too weak: too deep or too turbid",
    Outcome.MERGED_WITH_SURFACE: "too shallow: the bottom echo is merged with the surface echo",
    Outcome.OUTSIDE_GATE: "the bottom echo lies outside the receiver's gate",
    Outcome.SATURATED: "the detector is saturated",
    Outcome.CHANCE: "the echo could have been seen and by chance was not",
}


class PixelTally:
    """Counts what became of the bottom, frame by frame.

    Examples
    --------
    >>> record = PixelRecord(
    ...     true_position=np.zeros((1, 2, 3)), true_depth=np.full((1, 2), 40.0),
    ...     detection_probability=np.zeros((1, 2)), bottom_counts=np.zeros((1, 2)),
    ...     outcome=np.full((1, 2), Outcome.TOO_WEAK, dtype=np.uint8),
    ...     monte_carlo_relative_error=np.zeros((1, 2)))
    >>> tally = PixelTally()
    >>> tally.add(record)
    >>> tally.explain_empty()
    'no bottom found: the bottom echo is too weak: too deep or too turbid (100 % of 2 wet pixels,
    true depth 40.0 to 40.0 m)'
    """

    def __init__(self) -> None:
        self.frames = 0
        self.outcomes, self.dry = np.zeros(len(Outcome), np.int64), False
        self._depths = DepthBins(("found", "detectable", "found_and_detectable"))
        self._errors = ErrorTally()

    def add(self, record: PixelRecord) -> None:
        """Add the wet pixels of a frame."""
        wet = record.true_depth > 0.0
        found = record.outcome[wet] == Outcome.FOUND
        detectable = record.detection_probability[wet] >= DETECTABLE
        error = record.monte_carlo_relative_error[wet]
        self.frames += 1
        self.outcomes += np.bincount(record.outcome[wet], minlength=len(Outcome))
        self.dry |= bool((record.outcome == Outcome.DRY).any())
        self._depths.add(
            record.true_depth[wet],
            found=found,
            detectable=detectable,
            found_and_detectable=found & detectable,
        )
        self._errors.add(error[np.isfinite(error) & (record.bottom_counts[wet] > 0.0)])

    def metrics(self) -> dict[str, Any]:
        """Return what the pixels say, as plain values; None where there is no such pixel.

        A wet pixel is one whose true depth is above 0.

        ====================================  ==================================================
        pixels_wet                            wet pixels
        missed                                wet pixels by `Outcome` name, FOUND and DRY left
                                              out
        monte_carlo_relative_error            median over wet pixels with a bottom echo
        found_fraction                        share of wet pixels with outcome FOUND
        found_fraction_where_detectable       the same where detection_probability >= 0.9
        detection_depth_m                     deep edge of the deepest 0.5 m bin of true depth,
                                              or the deepest pixel, half of whose pixels have a
                                              detection_probability >= 0.9
        found_fraction_above_detection_depth  share of FOUND in all wet pixels of the bins down
                                              to there
        found_depth_m                         the same edge of the deepest such bin that has 0.9
                                              of its pixels FOUND
        half_found_depth_m                    and of that with half of them
        ====================================  ==================================================
        """
        depths, errors = self._depths, self._errors
        limit = depths.deepest("detectable", HALF)
        detectable = depths.total("detectable")
        return {
            "pixels_wet": depths.total("members"),
            "missed": {
                cause.name.lower(): int(self.outcomes[cause])
                for cause in Outcome
                if cause not in SEEN
            },
            "monte_carlo_relative_error": errors.quantile_of_absolute(0.5)
            if errors.count
            else None,
            "found_fraction": share(depths.total("found"), depths.total("members")),
            "found_fraction_where_detectable": share(
                depths.total("found_and_detectable"), detectable
            ),
            "detection_depth_m": limit,
            "found_fraction_above_detection_depth": None
            if limit is None
            else share(depths.total("found", depth=limit), depths.total("members", depth=limit)),
            "found_depth_m": depths.deepest("found", DETECTABLE),
            "half_found_depth_m": depths.deepest("found", HALF),
        }

    def explain_empty(self) -> str:
        """Return in one sentence why no bottom was found: the commonest outcome and its share."""
        wet = self._depths.total("members")
        if wet == 0:
            return "no bottom found: no pixel looks at water. Check flight, seabed and water level"
        commonest = max(REASONS, key=lambda cause: self.outcomes[cause])
        return (
            f"no bottom found: {REASONS[commonest]} "
            f"({100.0 * self.outcomes[commonest] / wet:.0f} % of {wet} wet pixels, "
            f"true depth {self._depths.least:.1f} to {self._depths.greatest:.1f} m)"
        )


def tallied(records: Iterable[PixelRecord]) -> PixelTally:
    """Return the tally of several frames."""
    tally = PixelTally()
    for record in records:
        tally.add(record)
    return tally


def share(part: int, whole: int) -> float | None:
    """Return a share; None of nothing."""
    return part / whole if whole else None

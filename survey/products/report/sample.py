"""One pixel of a run as an example: which, and its waveform."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from survey.cloud.points import Outcome
from survey.flight.pose import Frame
from survey.products.frame_file import FrameResult
from survey.products.observation import Observation
from survey.products.report.curves import waveform
from survey.products.report.page import Figure


@dataclass(frozen=True, kw_only=True)
class SamplePixel:
    """A pixel of a frame."""

    frame: Frame
    row: int
    column: int

    def figure(self, seen: Observation) -> Figure:
        """Return the pixel's waveform, from the frame flown again."""
        depth = float(seen.targets.depth[self.row, self.column])
        return Figure(
            name="waveform",
            png=waveform(seen, row=self.row, column=self.column),
            words=f"One pixel, frame {self.frame.index}, row {self.row}, column {self.column}: "
            "counts, expected light by origin, the plain threshold and echoes over a bottom "
            f"{depth:.1f} m deep. `bathyflash waveforms --pixel` shows any other.",
        )


def typical_pixel(
    read: Callable[[int], FrameResult], frames: Sequence[Frame]
) -> SamplePixel | None:
    """Return a pixel that found the bottom at its frame's median depth, of a frame in the middle.

    The frames are tried from the middle of the mission outwards; None where no pixel found any.
    """
    middle = len(frames) // 2
    for frame in sorted(frames, key=lambda each: abs(each.index - frames[middle].index)):
        record = read(frame.index).record
        found = record.outcome == Outcome.FOUND
        if found.any():
            off = np.abs(record.true_depth - np.median(record.true_depth[found]))
            row, column = np.unravel_index(np.where(found, off, np.inf).argmin(), found.shape)
            return SamplePixel(frame=frame, row=int(row), column=int(column))
    return None

"""A detector's own output of some pixels: histograms and time tags."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.sensor.detector import Readings


@dataclass(frozen=True, kw_only=True)
class RawReadings:
    """Histograms of n pixels, and m counts one by one.

    Parameters
    ----------
    row, column : array (n,)
        The pixels.
    counts : array (n, bins)
        Their readings, all pulses of the frame summed; see `survey.sensor.detector.Readings`.
    bin_start, bin_width : array ()
        Early edge of the first bin after emission, and width of the bins [s].
    tag_row, tag_column, tag_pulse : array (m,)
        Pixel and pulse of each count; empty where the detector tells no single counts.
    tag_time : array (m,)
        Its time after the early edge of the first bin [s].
    """

    row: NDArray[np.uint16]
    column: NDArray[np.uint16]
    counts: NDArray[Any]
    bin_start: NDArray[np.float64]
    bin_width: NDArray[np.float64]
    tag_row: NDArray[np.uint16]
    tag_column: NDArray[np.uint16]
    tag_pulse: NDArray[np.int32]
    tag_time: NDArray[np.float32]


def raw_readings(
    readings: Readings, *, step: int, bin_start: float, bin_width: float
) -> RawReadings:
    """Return the readings of every ``step``-th pixel of every ``step``-th row.

    Examples
    --------
    >>> counts = np.arange(4 * 6 * 3).reshape(4, 6, 3)
    >>> raw = raw_readings(Readings(counts=counts, blind=counts < 0), step=2,
    ...                    bin_start=1.3e-6, bin_width=1e-9)
    >>> raw.row.tolist(), raw.column.tolist(), raw.counts[1].tolist()
    ([1, 1, 1, 3, 3, 3], [1, 3, 5, 1, 3, 5], [27, 28, 29])
    """
    rows, columns, _ = readings.counts.shape
    first = step // 2
    row, column = np.mgrid[first:rows:step, first:columns:step].reshape(2, -1)
    tags = readings.tags
    tag_row, tag_column, tag_pulse, tag_time = (
        (np.empty(0),) * 4 if tags is None else (tags.row, tags.column, tags.pulse, tags.time)
    )
    kept = (tag_row % step == first) & (tag_column % step == first)
    return RawReadings(
        row=row.astype(np.uint16),
        column=column.astype(np.uint16),
        counts=readings.counts[row, column],
        bin_start=np.array(bin_start),
        bin_width=np.array(bin_width),
        tag_row=tag_row[kept].astype(np.uint16),
        tag_column=tag_column[kept].astype(np.uint16),
        tag_pulse=tag_pulse[kept].astype(np.int32),
        tag_time=tag_time[kept].astype(np.float32),
    )

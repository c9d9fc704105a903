"""How much memory and time a child may take for a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

GIB = 1 << 30
MEGABYTE = 1_000_000
LEAST_SECONDS = 6
SECONDS_PER_MEGABYTE = 1
BYTES_PER_BYTE = 40  # of memory for a file's: text to float64, with copies
WINDOW_MEMORY = 3 * GIB // 2
WINDOW_SECONDS = 20
PATIENCE_SECONDS = 60
PATIENCE = 4


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What a child may take.

    Parameters
    ----------
    memory : int
        Address space, libraries included [bytes].
    processor_time : int
        [s]; waiting is limited to four times that and a minute.

    Examples
    --------
    >>> Limits(memory=GIB, processor_time=6).waiting_time
    84
    """

    memory: int
    processor_time: int

    @property
    def waiting_time(self) -> int:
        """Longest time on the clock, for a busy machine [s]."""
        return PATIENCE_SECONDS + PATIENCE * self.processor_time


def limits_for_whole(path: Path) -> Limits:
    """Return the limits for a file that is read from end to end: they grow with its size."""
    size = path.stat().st_size
    return Limits(
        memory=GIB + BYTES_PER_BYTE * size,
        processor_time=LEAST_SECONDS + SECONDS_PER_MEGABYTE * (size // MEGABYTE),
    )


def limits_for_window() -> Limits:
    """Return the limits for a file of any size of which a part is read."""
    return Limits(memory=WINDOW_MEMORY, processor_time=WINDOW_SECONDS)

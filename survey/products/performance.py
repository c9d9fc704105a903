"""How fast a run was."""

from __future__ import annotations

import resource
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

from survey.products.json_file import write_json


@dataclass
class Stopwatch:
    """Counts frames and the time they take, from its creation on."""

    start: float = field(default_factory=time.perf_counter)
    frames: int = 0
    frame_seconds: float = 0.0

    def add(self, seconds: float) -> None:
        """Add a frame that took so many seconds of one worker."""
        self.frames += 1
        self.frame_seconds += seconds


def write_performance(path: Path, clock: Stopwatch) -> None:
    """Write performance.json: this call's frames, seconds and memory. It differs run by run.

    The memory is that of the largest process of this machine.
    """
    elapsed = time.perf_counter() - clock.start
    per_unit = 1 if sys.platform == "darwin" else 1024
    workers_and_pilot = (resource.RUSAGE_CHILDREN, resource.RUSAGE_SELF)
    peak = max(resource.getrusage(who).ru_maxrss for who in workers_and_pilot) * per_unit
    write_json(
        path,
        {
            "frames": clock.frames,
            "seconds": round(elapsed, 3),
            "frame_seconds_of_one_worker": round(clock.frame_seconds, 3),
            "seconds_per_frame_of_one_worker": round(clock.frame_seconds / clock.frames, 4)
            if clock.frames
            else None,
            "frames_per_second": round(clock.frames / elapsed, 4),
            "peak_memory_mb": round(peak / 1e6, 1),
        },
    )

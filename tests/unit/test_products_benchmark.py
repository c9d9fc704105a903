"""The benchmark of products runs: what it measures is for a quiet machine."""

from __future__ import annotations

from pathlib import Path

from tests.benchmarks.products import COLUMNS, ROWS, flight, frame_files, measured


def test_made_frames_become_products(tmp_path: Path) -> None:
    frames = list(flight(3))
    with frame_files(tmp_path, frames) as place:
        found = measured(frames, place, thinning=0.0)
    assert found["points_written"] == found["points_in"] == 2 * 3 * ROWS * COLUMNS

"""What frames gain that believe each other's weak echoes, by depth, and what that costs.

    python -m survey.overlap_gain -o docs

The gallery's `too-deep`, flashing so fast that each place is seen by several frames, over a bed
that falls through the limit and over water without a bottom. Every frame is judged alone, and then
with the others, as a run does it.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import BOTTOM_CLASSES, Outcome, PointCloud
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.mission import fly_frames
from survey.preparation import prepare
from survey.products.frame_file import FrameResult
from survey.ranging_curves import BEDS, by_bins, scenario_of

FloatArray = NDArray[np.float64]

DEPTH_STEP = 1.0
FLASH_RATE = 8.0
SECOND_LOOK_RATE = 0.1
FRAMES = 56


def frames_alone_and_helped(
    water: str, *, day: bool, frames: int, bottomless: bool, **more: Any
) -> tuple[list[FrameResult], list[FrameResult]]:
    """Fly a case, and return its frames judged alone and with each other.

    ``more`` are other keys of the scenario.
    """
    changes: dict[str, Any] = {
        "flight.flash_rate_hz": FLASH_RATE,
        "processing.second_look_rate": SECOND_LOOK_RATE,
    }
    scenario = scenario_of(water, day=day, frames=frames, bottomless=bottomless, **(changes | more))
    mission = prepare(scenario)
    alone = {index: result for index, result, _ in fly_frames(mission, mission.frames)}
    helped = mission.products.helped(alone.__getitem__, mission.frames)
    numbers = [frame.index for frame in mission.frames]
    return [alone[number] for number in numbers], [helped(number) for number in numbers]


def shares(alone: Sequence[FrameResult], helped: Sequence[FrameResult]) -> list[dict[str, float]]:
    """Return by true depth which pixels found the bottom, and which something else."""
    marks = {}
    for name, results in (("alone", alone), ("together", helped)):
        outcome = np.concatenate([result.record.outcome.ravel() for result in results])
        marks[name] = outcome == Outcome.FOUND
        marks[f"{name}_false"] = outcome == Outcome.FALSE_BOTTOM
    depth = np.concatenate([result.record.true_depth.ravel() for result in alone])
    return by_bins(depth, np.arange(0.0, depth.max() + DEPTH_STEP, DEPTH_STEP), marks)


def added(alone: Sequence[FrameResult], helped: Sequence[FrameResult]) -> PointCloud:
    """Return the points that only the help of others made bottoms."""
    parts = []
    for before, after in zip(alone, helped, strict=True):
        solid, was = (
            np.isin(result.bottom.classification, BOTTOM_CLASSES) for result in (after, before)
        )
        parts.append(after.bottom.select(solid & ~was))
    return PointCloud.concatenate(parts)


def errors_of(points: PointCloud) -> dict[str, float]:
    """Return how far points within 1 m of the truth lie off, and how many within their TVU."""
    error = points.position[:, 2] - points.true_elevation
    near = np.abs(error) <= FALSE_BOTTOM_ERROR
    return {
        "points": len(points),
        "over_1_m_off": int((~near).sum()),
        "bias_m": round(float(error[near].mean()), 3),
        "rmse_m": round(float(np.sqrt(np.mean(error[near] ** 2))), 3),
        "within_tvu": round(float((np.abs(error) <= points.tvu)[near].mean()), 3),
        "median_tvu_m": round(float(np.median(points.tvu[near])), 3),
    }


def gain(water: str, *, day: bool, frames: int, **more: Any) -> dict[str, Any]:
    """Return what a case gains over the falling bed, and what it adds over bottomless water."""
    bed = frames_alone_and_helped(water, day=day, frames=frames, bottomless=False, **more)
    empty = frames_alone_and_helped(water, day=day, frames=frames, bottomless=True, **more)
    return {
        "water": water,
        "day": day,
        "bottomless_pixels": sum(result.record.outcome.size for result in empty[0]),
        "candidates": sum(len(r.candidates) for r in empty[0] if r.candidates is not None),
        "echoes_alone": _echoes(empty[0]),
        "false_alone": _false(empty[0]),
        "false_added": sum(result.helped for result in empty[1]),
        "added": errors_of(added(*bed)),
        "by_depth_m": shares(*bed),
    }


def _echoes(results: Sequence[FrameResult]) -> int:
    """Return how many pixels had an echo, those sorted out as noise included."""
    return sum(
        int(np.isin(r.record.outcome, (Outcome.FALSE_BOTTOM, Outcome.NOISE)).sum()) for r in results
    )


def _false(results: Sequence[FrameResult]) -> int:
    return sum(int((r.record.outcome == Outcome.FALSE_BOTTOM).sum()) for r in results)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure all cases and write ``overlap_gain.json``."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("-o", "--output", type=Path, default=Path("docs"))
    given = parser.parse_args(arguments)
    cases = [gain(water, day=day, frames=FRAMES) for water, day in product(BEDS, (True, False))]
    (given.output / "overlap_gain.json").write_text(json.dumps(cases) + "\n")


if __name__ == "__main__":
    main()

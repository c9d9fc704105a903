"""The flights of the gallery: each into a folder of its own, flown once."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from survey import PlainLines, fly, load_scenario, open_run
from survey.cloud.points import Outcome, PointClass
from survey.errors import OtherRunError
from survey.products.writing import ProductError
from survey.run_folder import RunFolder
from survey.run_identity import differences, found_manifest, manifest_of
from survey.scenario import components
from survey.scenario.scenario import Scenario


def fly_anew(name: str, folder: Path) -> None:
    """Fly a scenario unless its run is there and whole; a run of older code is flown anew.

    That no bottom was found is a result too: then there are frames, but no products.
    """
    scenario = load_scenario(name)
    if is_flown(scenario, folder):
        return
    with suppress(ProductError):
        try:
            fly(scenario, folder, watch=PlainLines())
        except OtherRunError:
            fly(scenario, folder, refly=True, watch=PlainLines())


def is_flown(scenario: Scenario, folder: Path) -> bool:
    """Tell whether a folder holds a finished run of all of a scenario, by this code."""
    manifest = found_manifest(folder)
    if manifest is None or differences(manifest, manifest_of(scenario)):
        return False
    return has_products(folder) and len(open_run(folder).frames) == len(components.frames(scenario))


def has_products(folder: Path) -> bool:
    """Tell whether a run found any bottom."""
    return (folder / "metrics.json").exists()


def metrics_of(folder: Path) -> dict[str, Any]:
    """Return what stands in metrics.json; of a run without products what its frames tell."""
    if has_products(folder):
        return open_run(folder).metrics
    run = RunFolder.flown(folder)
    frames = [run.frame(index) for index in run.whole]
    outcome = np.stack([frame.record.outcome for frame in frames])
    surface = [frame.surface.classification == PointClass.WATER_SURFACE for frame in frames]
    return {
        "frames": len(frames),
        "points_surface": int(np.concatenate(surface).sum()),
        "points_bottom": 0,
        "false_bottoms": int((outcome == Outcome.FALSE_BOTTOM).sum()),
        **dict.fromkeys(("bias_m", "p95_abs_error_m", "tvu_coverage", "thu_coverage")),
    }

"""The flights of the gallery: each into a folder of its own, flown once."""

from __future__ import annotations

from pathlib import Path

from survey import PlainLines, fly, load_scenario, open_run
from survey.errors import OtherRunError, UserError
from survey.run_identity import differences, found_manifest, manifest_of
from survey.scenario.scenario import Scenario


def fly_anew(name: str, folder: Path) -> None:
    """Fly a scenario unless its run is there and whole; a run of older code is flown anew."""
    scenario = load_scenario(name)
    if is_flown(scenario, folder):
        return
    try:
        fly(scenario, folder, watch=PlainLines())
    except OtherRunError:
        fly(scenario, folder, refly=True, watch=PlainLines())


def is_flown(scenario: Scenario, folder: Path) -> bool:
    """Tell whether a folder holds a finished run of all of a scenario, by this code."""
    manifest = found_manifest(folder)
    if manifest is None or differences(manifest, manifest_of(scenario)):
        return False
    try:
        open_run(folder)
    except UserError:
        return False
    return True

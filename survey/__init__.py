"""A simulator of airborne bathymetric surveys with a photon-counting flash lidar.

from survey import load_scenario, fly, open_run            # a mission and what it found
from survey import prepare, fly_frame, labelled_waveforms  # single flashes
from survey import open_waveforms, PlainLines              # stored waveforms; progress as lines
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from survey.console import PlainLines as PlainLines
    from survey.labelled.dataset import labelled_waveforms as labelled_waveforms
    from survey.labelled.store import open_waveforms as open_waveforms
    from survey.mission import fly as fly
    from survey.mission import fly_frame as fly_frame
    from survey.opened.run import open_run as open_run
    from survey.preparation import prepare as prepare
    from survey.scenario.load import load_scenario as load_scenario

_HOMES = {
    "PlainLines": "survey.console",
    "fly": "survey.mission",
    "fly_frame": "survey.mission",
    "labelled_waveforms": "survey.labelled.dataset",
    "load_scenario": "survey.scenario.load",
    "open_run": "survey.opened.run",
    "open_waveforms": "survey.labelled.store",
    "prepare": "survey.preparation",
}

__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    """Import the public names when they are asked for, so that the command line starts at once."""
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module 'survey' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)

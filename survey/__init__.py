"""A simulator of airborne bathymetric surveys with a photon-counting flash lidar.

from survey import load_scenario, fly, fly_frame, labelled_waveforms, prepare
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from survey.labelled.dataset import labelled_waveforms as labelled_waveforms
    from survey.mission import fly as fly
    from survey.mission import fly_frame as fly_frame
    from survey.preparation import prepare as prepare
    from survey.scenario.load import load_scenario as load_scenario

__all__ = ["fly", "fly_frame", "labelled_waveforms", "load_scenario", "prepare"]

_HOMES = {
    "fly": "survey.mission",
    "fly_frame": "survey.mission",
    "labelled_waveforms": "survey.labelled.dataset",
    "prepare": "survey.preparation",
    "load_scenario": "survey.scenario.load",
}


def __getattr__(name: str) -> Any:
    """Import the public names when they are asked for, so that the command line starts at once."""
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module 'survey' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)

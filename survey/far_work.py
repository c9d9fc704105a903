"""Frames flown on another machine, which prepares the mission for itself."""

from __future__ import annotations

import json
import socket
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from threading import Lock

from survey.errors import OtherRunError
from survey.preparation import Mission, prepare
from survey.run_identity import differences, manifest_of
from survey.scenario.scenario import Scenario

ONE_AT_A_TIME = Lock()


@dataclass(frozen=True, kw_only=True)
class FarWork:
    """What is sent to a worker elsewhere, and does the work for a frame there.

    Parameters
    ----------
    manifest : str
        The run's, as JSON; the worker flies for no other.
    scenario : Scenario
        The files that it names are looked for at the same place.
    fly : callable
        Returns the content of a frame's file from the mission and the frame's number.
    """

    manifest: str
    scenario: Scenario = field(compare=False)
    fly: Callable[[Mission, int], bytes] = field(compare=False)

    @classmethod
    def of(cls, scenario: Scenario, fly: Callable[[Mission, int], bytes]) -> FarWork:
        """Return the work for a scenario."""
        placed = replace(scenario, folder=scenario.folder.resolve())
        return cls(manifest=json.dumps(manifest_of(placed)), scenario=placed, fly=fly)

    def __call__(self, index: int) -> bytes:
        """Fly a frame.

        Raises
        ------
        OtherRunError
            When code, libraries or files here are not the run's.
        """
        with ONE_AT_A_TIME:
            mission = _prepared(self)
        return self.fly(mission, index)


@lru_cache(maxsize=1)
def _prepared(work: FarWork) -> Mission:
    """Return the mission, prepared once in a process for all frames that come after each other."""
    other = differences(json.loads(work.manifest), manifest_of(work.scenario))
    if other:
        raise OtherRunError(
            f"worker on {socket.gethostname()}: other {', '.join(other)}. "
            "Install there what is installed here"
        )
    return prepare(work.scenario)

"""The mission that all faults are tried on."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from survey import mission as flights
from survey.preparation import prepare
from survey.scenario.scenario import Scenario
from tests.faults.rehearsal import ONE, TABLES, Rehearsal, products


@pytest.fixture(scope="session")
def rehearsal(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Rehearsal]:
    """Four frames of 8 x 6 pixels; preparing is done once, since no fault is tried there."""
    folder = tmp_path_factory.mktemp("rehearsal")
    scenario = Scenario.from_tables(TABLES, name="reef.toml", folder=folder)
    mission = prepare(scenario)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(flights, "prepare", lambda scenario: mission)
        flights.fly(scenario, folder / "wanted", crew=ONE)
        yield Rehearsal(scenario=scenario, mission=mission, wanted=products(folder / "wanted"))

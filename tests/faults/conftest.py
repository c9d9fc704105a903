"""The mission that all faults are tried on."""

from __future__ import annotations

import pytest

from survey import mission as flights
from survey.preparation import prepare
from survey.products.report import curves, maps
from survey.products.verdict import failure_picture
from survey.scenario.scenario import Scenario
from tests.faults.rehearsal import ONE, TABLES, Rehearsal, products


def rehearse(patch: pytest.MonkeyPatch, ready: object) -> None:
    """Let runs take a mission that is ready, and leave the report's pictures blank.

    These touch no file, and drawing them takes most of so small a run.
    """
    patch.setattr(flights, "prepare", lambda scenario: ready)
    for module in (curves, maps, failure_picture):
        patch.setattr(module, "png", lambda figure: b"")


@pytest.fixture(scope="session")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Rehearsal:
    """Four frames of 8 x 6 pixels, prepared and flown once."""
    folder = tmp_path_factory.mktemp("rehearsal")
    scenario = Scenario.from_tables(TABLES, name="reef.toml", folder=folder)
    mission = prepare(scenario)
    with pytest.MonkeyPatch.context() as patch:
        rehearse(patch, mission)
        flights.fly(scenario, folder / "wanted", crew=ONE)
    return Rehearsal(scenario=scenario, mission=mission, wanted=products(folder / "wanted"))


@pytest.fixture
def rehearsal(flown: Rehearsal, monkeypatch: pytest.MonkeyPatch) -> Rehearsal:
    """That mission, to be flown again without being prepared."""
    rehearse(monkeypatch, flown.mission)
    return flown

"""The door and a run to score by, once for all broken inputs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.bad_input.door import Door
from tests.unit.conftest import make_survey
from tests.unit.scored_run import make_run


@pytest.fixture(scope="session")
def door(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Door]:
    """The user's door."""
    door = Door(tmp_path_factory.mktemp("bad-input"))
    yield door
    door.close()


@pytest.fixture(scope="session")
def scored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run whose truth clouds are scored by."""
    return make_run(tmp_path_factory.mktemp("scored"), make_survey().bottom)

"""What all tests share."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import settings

from tests.small_scenario import small_tables

settings.register_profile("same every time", derandomize=True, deadline=None)
settings.load_profile("same every time")


@pytest.fixture
def tables() -> dict[str, dict[str, Any]]:
    """Return the tables of a small sound scenario, only what must be given."""
    return small_tables()

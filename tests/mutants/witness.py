"""Plugin of the child process: what failed, by an assertion or otherwise, and whose code ran."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

VERDICT = "verdict.json"
PACKAGES = {"survey", "terrain", "scenarios", "tests"}


class Witness:
    """Notes failures while the tests run and writes them down at the end."""

    def __init__(self) -> None:
        self.asserted: list[str] = []
        self.broken: list[str] = []

    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]) -> None:
        if call.excinfo is not None:
            failures = self.asserted if call.excinfo.errisinstance(AssertionError) else self.broken
            failures.append(f"{item.nodeid}: {call.excinfo.exconly().splitlines()[0]}")

    def pytest_sessionfinish(self) -> None:
        verdict = {"asserted": self.asserted, "broken": self.broken, "foreign": foreign_modules()}
        Path(VERDICT).write_text(json.dumps(verdict), encoding="utf-8")


def foreign_modules() -> list[str]:
    """Return the project's modules that were not imported from the working folder."""
    here = Path.cwd()
    return [
        name
        for name, module in sys.modules.items()
        if name.partition(".")[0] in PACKAGES
        and getattr(module, "__file__", None)
        and not Path(str(module.__file__)).resolve().is_relative_to(here)
    ]


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Witness())

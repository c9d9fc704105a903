"""The notebook of the documentation runs as it stands, and its outputs are there."""

from __future__ import annotations

import json

import pytest

from tools.notebook import LARGEST, NOTEBOOK, executed


def test_every_cell_has_been_executed_without_a_fault() -> None:
    content = NOTEBOOK.read_bytes()
    cells = [cell for cell in json.loads(content)["cells"] if cell["cell_type"] == "code"]
    outputs = [output for cell in cells for output in cell["outputs"]]
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    assert not [output for output in outputs if output["output_type"] == "error"]
    assert len([o for o in outputs if "image/png" in o.get("data", {})]) >= 4
    assert len(content) <= LARGEST


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.filterwarnings("default")
def test_it_runs_again() -> None:
    assert len(executed(NOTEBOOK)) <= LARGEST

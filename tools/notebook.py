"""Execute docs/notebook.ipynb anew, in its place: `make notebook`."""

from __future__ import annotations

import os
from pathlib import Path
from shutil import rmtree

import nbformat
from nbclient import NotebookClient

from survey.products.writing import write_whole

ROOT = Path(__file__).parents[1]
NOTEBOOK, RUN = ROOT / "docs/notebook.ipynb", "runs/notebook"
LARGEST = 300_000  # bytes
PATIENCE = 900  # seconds a cell


def executed(notebook: Path) -> bytes:
    """Return a notebook with the outputs of its cells, run from the root of the repository.

    What libraries say of this machine on standard error is left out.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        When a cell fails.
    """
    pages = nbformat.read(notebook, as_version=4)
    rmtree(ROOT / RUN, ignore_errors=True)
    client = NotebookClient(
        pages,
        timeout=PATIENCE,
        kernel_name="python3",
        record_timing=False,
        resources={"metadata": {"path": str(ROOT)}},
    )
    client.execute(env=os.environ | {"PYTHONPATH": str(ROOT)})
    for cell in pages.cells:
        if cell.cell_type == "code":
            cell.outputs = [part for part in cell.outputs if part.get("name") != "stderr"]
    text: str = nbformat.writes(pages)
    return f"{text}\n".encode()


def main() -> None:
    """Execute the notebook and write it."""
    content = executed(NOTEBOOK)
    if len(content) > LARGEST:
        raise SystemExit(f"{NOTEBOOK}: {len(content)} bytes, more than {LARGEST}. Plot less")
    write_whole(NOTEBOOK, content)
    print(f"written: {NOTEBOOK}, {len(content) / 1e3:.0f} kB")


if __name__ == "__main__":
    main()

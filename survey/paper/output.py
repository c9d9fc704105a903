"""The folder of the results: whole or absent, and nothing of others is touched."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from shutil import rmtree

from survey.errors import UserError
from survey.paper.report import MADE_BY
from survey.products.writing import write_whole

RESULT = "paper.json"
PICTURES = ("figure1", "figure2", "figure3", "single_element")
NAMES = (*(f"{name}.{kind}" for name in PICTURES for kind in ("png", "svg")), RESULT)


def require_place(folder: Path) -> None:
    """Check that results may be written to a folder.

    It may be absent, hold an earlier result, which is replaced, or hold other files, which stay.

    Raises
    ------
    UserError
        When it is no folder, cannot be written to, or holds a file of the same name that the
        command did not make.
    """
    place = folder.resolve()
    standing = next(path for path in (place, *place.parents) if path.exists())
    if not standing.is_dir():
        raise UserError(f"{standing}: is a file. Choose a folder with -o")
    if not os.access(standing, os.W_OK | os.X_OK):
        raise UserError(f"{standing}: cannot be written to. Choose another folder with -o")
    taken = [name for name in NAMES if os.path.lexists(place / name)]
    if taken and not _is_ours(place / RESULT):
        raise UserError(
            f"{folder}: holds {', '.join(taken)} of another making. Choose another folder with -o"
        )


def write_results(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write all files under a temporary name first, then rename them, `paper.json` last.

    Parameters
    ----------
    folder : Path
    contents : mapping
        Bytes by each of `NAMES`.

    Raises
    ------
    UserError
        As `require_place`.
    """
    require_place(folder)
    place = folder.resolve()
    is_new = not place.exists()
    beside = place.parent if is_new else place
    beside.mkdir(parents=True, exist_ok=True)
    partial = beside / f".{place.name}.partial-{os.getpid()}"
    partial.mkdir()
    try:
        for name in NAMES:
            write_whole(partial / name, contents[name])
        if is_new:
            partial.rename(place)
            return
        for name in NAMES:
            (partial / name).replace(place / name)
    finally:
        rmtree(partial, ignore_errors=True)


def _is_ours(result: Path) -> bool:
    try:
        found = json.loads(result.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(found, dict) and found.get("made_by") == MADE_BY

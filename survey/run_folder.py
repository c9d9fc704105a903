"""The folder of a run: whose it is, and which frames in it are whole."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from survey.errors import OtherRunError
from survey.products.frame_file import FrameResult, read_frame, write_frame
from survey.products.json_file import write_json
from survey.products.writing import write_whole
from survey.scenario.scenario import Scenario

MANIFEST = "manifest.json"
LIBRARIES = ("numpy", "scipy", "numba", "trimesh", "laspy", "rasterio", "pyproj")


@dataclass(frozen=True, kw_only=True)
class RunFolder:
    """A run's folder, opened for writing; frames that are whole stay.

    Parameters
    ----------
    path : Path
        The folder.
    whole : dict
        Hash of each whole frame's file by the frame's number, as the journal has it.
    """

    path: Path
    whole: dict[int, str]

    @classmethod
    def open(cls, path: Path, scenario: Scenario) -> RunFolder:
        """Make the folder, or take it up again if it belongs to the same scenario and code.

        Raises
        ------
        OtherRunError
            When the folder belongs to another run, or holds something else.
        """
        resolved = scenario.to_toml(beside=path)
        manifest = _manifest(scenario, scenario.to_toml())
        found = _found_manifest(path)
        if found is not None:
            _require_same(path, found, manifest)
        elif path.exists() and any(path.iterdir()):
            raise OtherRunError(f"{path}: holds files but no run. Choose another folder with -o")
        path.mkdir(parents=True, exist_ok=True)
        write_json(path / MANIFEST, manifest)
        write_whole(path / "scenario.toml", resolved.encode())
        (path / "frames").mkdir(exist_ok=True)
        return cls(path=path, whole=dict(whole_frames(path)))

    def frame_path(self, index: int) -> Path:
        """Return the place of a frame's file."""
        return self.path / "frames" / f"{index:06d}.npz"

    def keep(self, index: int, result: FrameResult) -> None:
        """Write a frame and note it in the journal."""
        digest = hashlib.sha256(write_frame(self.frame_path(index), result)).hexdigest()
        with (self.path / "journal.jsonl").open("a", encoding="utf-8") as journal:
            journal.write(json.dumps({"frame": index, "sha256": digest}) + "\n")
            journal.flush()
            os.fsync(journal.fileno())
        self.whole[index] = digest

    def read(self, indices: Sequence[int]) -> list[FrameResult]:
        """Read frames in the order given."""
        return [read_frame(self.frame_path(index)) for index in indices]


def _manifest(scenario: Scenario, resolved: str) -> dict[str, Any]:
    """Return what makes a run this run."""
    files = {name: _digest(scenario.folder / name) for name in scenario.files}
    return {
        "format": 1,
        "scenario_sha256": hashlib.sha256(resolved.encode()).hexdigest(),
        "files_sha256": files,
        "versions": {name: metadata.version(name) for name in ("bathyflash", *LIBRARIES)},
        "code_sha256": _code_digest(),
    }


def _found_manifest(path: Path) -> dict[str, Any] | None:
    """Return the manifest in a folder; None where there is none of ours."""
    file = path / MANIFEST
    if not file.exists():
        return None
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except ValueError:
        return None
    return found if isinstance(found, dict) and "scenario_sha256" in found else None


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _code_digest() -> str:
    digest = hashlib.sha256()
    root = Path(__file__).resolve().parent.parent
    for package in ("survey", "terrain"):
        for path in sorted((root / package).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _require_same(path: Path, found: dict[str, Any], wanted: dict[str, Any]) -> None:
    names = {
        "scenario_sha256": "scenario",
        "files_sha256": "files that the scenario names",
        "versions": "library versions",
        "code_sha256": "code",
        "format": "format",
    }
    other = [words for key, words in names.items() if found.get(key) != wanted[key]]
    if other:
        raise OtherRunError(
            f"{path}: belongs to another run: other {', other '.join(other)}. "
            "Choose another folder with -o, or delete this one"
        )


def whole_frames(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the frames whose file still is what the journal says."""
    journal = path / "journal.jsonl"
    if not journal.exists():
        return
    for line in journal.read_text(encoding="utf-8").splitlines():
        try:
            note = json.loads(line)
            index, digest = int(note["frame"]), str(note["sha256"])
        except (ValueError, KeyError, TypeError):
            continue
        file = path / "frames" / f"{index:06d}.npz"
        if file.exists() and _digest(file) == digest:
            yield index, digest

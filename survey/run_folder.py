"""The folder of a run: whose it is, and which frames in it are whole."""

from __future__ import annotations

import hashlib
import shutil
import time
from dataclasses import dataclass
from pathlib import Path

from survey.errors import OtherRunError, UserError
from survey.journal import Note, read_notes, write_note
from survey.products.frame_file import FrameResult, read_frame
from survey.products.json_file import write_json
from survey.products.report.report import FIGURES
from survey.products.writing import is_partial, write_whole
from survey.run_identity import (
    MANIFEST,
    SCENARIO,
    digest,
    found_manifest,
    manifest_of,
    require_same,
)
from survey.run_lock import LOCK, sole_pilot
from survey.scenario.scenario import Scenario

JOURNAL = "journal.jsonl"
PRODUCTS = (
    *("bottom.*", "water_surface.*", "bathymetry.*", "trajectory.*", "trajectory_*"),
    *("coverage.geojson", "lines.geojson", "failures.geojson", "strip_differences.tif"),
    *("metrics.json", "performance.json", "report.html"),
)


@dataclass(frozen=True, kw_only=True)
class RunFolder:
    """A run's folder, opened for writing; frames that are whole stay.

    Parameters
    ----------
    path : Path
        The folder.
    whole : dict
        Hash of each whole frame's file by the frame's number, as the journal has it.
    spoilt : dict
        Why frames that the journal has are no longer whole, by their number.
    """

    path: Path
    whole: dict[int, str]
    spoilt: dict[int, str]

    @classmethod
    def open(cls, path: Path, scenario: Scenario, *, refly: bool = False) -> RunFolder:
        """Make the folder, or take it up again if it belongs to the same scenario and code.

        With ``refly`` what an earlier run left there is removed first, whatever it was a run of;
        files that are no run's own stay.

        Raises
        ------
        OtherRunError
            When the folder belongs to another run, or holds something else.
        BusyRunError
            When it shall be flown anew while another process flies into it.
        """
        resolved = scenario.to_toml(beside=path)
        manifest = manifest_of(scenario)
        found = found_manifest(path)
        if found is not None and refly:
            with sole_pilot(path):
                _remove_run(path)
        elif found is not None:
            require_same(path, found, manifest, resolved)
        elif path.exists() and not all(_is_left_behind(file) for file in path.iterdir()):
            raise OtherRunError(f"{path}: holds files but no run. Choose another folder with -o")
        path.mkdir(parents=True, exist_ok=True)
        write_json(path / MANIFEST, manifest)
        write_whole(path / SCENARIO, resolved.encode())
        (path / "frames").mkdir(exist_ok=True)
        whole, spoilt = whole_frames(path)
        return cls(path=path, whole=whole, spoilt=spoilt)

    @classmethod
    def flown(cls, path: Path) -> RunFolder:
        """Return a run's folder for reading, whatever code flew it.

        Raises
        ------
        FileNotFoundError
            When there is no run.
        UserError
            When none of its frames is whole.
        """
        if found_manifest(path) is None or not (path / SCENARIO).exists():
            raise FileNotFoundError(
                f"{path}: no run. Give the folder that `bathyflash run -o` wrote"
            )
        whole, spoilt = whole_frames(path)
        if not whole:
            raise UserError(f"{path}: no frame was flown. Fly it with `bathyflash run`")
        return cls(path=path, whole=whole, spoilt=spoilt)

    def frame_path(self, index: int) -> Path:
        """Return the place of a frame's file."""
        return frame_path(self.path, index)

    def keep(self, index: int, content: bytes) -> None:
        """Write the file of a frame and note it in the journal."""
        write_whole(self.frame_path(index), content)
        sha256 = hashlib.sha256(content).hexdigest()
        write_note(self.path / JOURNAL, Note(frame=index, sha256=sha256, done=time.time()))
        self.whole[index] = sha256

    def frame(self, index: int) -> FrameResult:
        """Read a frame."""
        return read_frame(self.frame_path(index))


def _is_left_behind(file: Path) -> bool:
    """Tell whether a run that was killed at its first files may have left this."""
    return file.name == LOCK or is_partial(file)


def _remove_run(path: Path) -> None:
    """Remove what a run made; its manifest last, so that the rest is still known as a run's."""
    for made in ("frames", FIGURES):
        shutil.rmtree(path / made, ignore_errors=True)
    for pattern in (JOURNAL, *PRODUCTS, SCENARIO, MANIFEST):
        for file in path.glob(pattern):
            file.unlink()


def frame_path(folder: Path, index: int) -> Path:
    """Return the place of a frame's file in a run folder.

    Examples
    --------
    >>> frame_path(Path("run"), 7).as_posix()
    'run/frames/000007.npz'
    """
    return folder / "frames" / f"{index:06d}.npz"


def whole_frames(path: Path) -> tuple[dict[int, str], dict[int, str]]:
    """Return the frames whose file still is what the journal says, and why others are not."""
    whole, spoilt = {}, {}
    for index, sha256 in {n.frame: n.sha256 for n in read_notes(path / JOURNAL)}.items():
        file = frame_path(path, index)
        if not file.exists():
            spoilt[index] = "its file is gone"
        elif digest(file) != sha256:
            spoilt[index] = "its file is not what was written"
        else:
            whole[index] = sha256
    return whole, spoilt

"""A run as it lies on the disk, and its frames flown again from their addresses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PixelRecord, PointCloud
from survey.cloud.raw import RawReadings
from survey.errors import OtherRunError, UserError
from survey.products.frame_file import FrameResult, read_frame, read_raw
from survey.run_folder import frame_path, whole_frames
from survey.run_identity import SCENARIO, found_manifest
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario


@dataclass(frozen=True, kw_only=True)
class FlownRun:
    """A run folder, opened for reading.

    Parameters
    ----------
    folder : Path
    scenario : Scenario
        What was flown; files that it names are reached from the folder.
    identity : dict
        Hashes of scenario and code, from the manifest.
    whole : tuple of int
        Numbers of the frames that are whole, ascending.
    """

    folder: Path
    scenario: Scenario
    identity: dict[str, str]
    whole: tuple[int, ...]

    @classmethod
    def open(cls, folder: Path) -> FlownRun:
        """Read what a run is, and which of its frames are whole.

        Raises
        ------
        FileNotFoundError
            When there is no such folder.
        UserError
            When it holds no run, or a run without a whole frame.
        """
        if not folder.is_dir():
            raise FileNotFoundError(2, "No such run folder", str(folder))
        manifest = found_manifest(folder)
        if manifest is None:
            raise UserError(f"{folder}: holds no run. Make one with: bathyflash run")
        identity = {key: str(manifest.get(key)) for key in ("scenario_sha256", "code_sha256")}
        scenario = load_scenario(folder / SCENARIO)
        whole = tuple(sorted(whole_frames(folder)[0]))
        if not whole:
            raise UserError(f"{folder}: no whole frame in it. Fly it with: bathyflash run")
        return cls(folder=folder, scenario=scenario, identity=identity, whole=whole)

    def chosen(self, frames: Sequence[int] | None) -> list[int]:
        """Return the numbers of the frames asked for; None stands for all that are whole.

        Raises
        ------
        UserError
            When one of them is not in the run.
        """
        if frames is None:
            return list(self.whole)
        missing = [str(index) for index in frames if index not in set(self.whole)]
        if missing:
            raise UserError(
                f"{self.folder}: frames {_few(missing)}: not in the run. It holds "
                f"{len(self.whole)} frames from {self.whole[0]} to {self.whole[-1]}. "
                "Fly the rest with: bathyflash run"
            )
        return list(frames)

    def require_same(self, index: int, again: FrameResult) -> None:
        """Compare a frame that was flown again with the run's own, raw readings included.

        Raises
        ------
        OtherRunError
            When they differ in any number.
        """
        path = frame_path(self.folder, index)
        other = list(_differences(read_frame(path), again))
        other += _raw_differences(read_raw(path), again.raw)
        if other:
            raise OtherRunError(
                f"{path}: flown again, the frame differs in {_few(other)}. The run is of other "
                "code, other libraries or changed files: fly it anew with: bathyflash run"
            )


def _differences(kept: FrameResult, again: FrameResult) -> Iterator[str]:
    for cloud in ("bottom", "surface", "candidates"):
        old, new = _cloud_columns(kept, cloud), _cloud_columns(again, cloud)
        yield from (
            f"{cloud}_{name}"
            for name in old | new
            if name not in old or name not in new or not _equal(old[name], new[name])
        )
    for field in fields(PixelRecord):
        if not _equal(getattr(kept.record, field.name), getattr(again.record, field.name)):
            yield f"pixel_{field.name}"


def _cloud_columns(result: FrameResult, name: str) -> dict[str, NDArray[Any]]:
    cloud: PointCloud | None = getattr(result, name)
    return {} if cloud is None else cloud.columns()


def _raw_differences(kept: RawReadings | None, again: RawReadings | None) -> list[str]:
    if kept is None or again is None:
        return [] if kept is again else ["raw readings"]
    names = [field.name for field in fields(RawReadings)]
    return [f"raw_{n}" for n in names if not _equal(getattr(kept, n), getattr(again, n))]


def _equal(one: Any, other: Any) -> bool:
    return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=one.dtype.kind == "f")


def _few(words: list[str]) -> str:
    return ", ".join(words[:3]) + (f" and {len(words) - 3} more" if len(words) > 3 else "")

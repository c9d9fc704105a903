"""The truth of a finished run: its seabed, its water, and what every pixel could have seen."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from survey.cloud.points import PixelRecord
from survey.products.frame_file import read_frame
from survey.run_folder import frame_path, whole_frames
from survey.run_identity import MANIFEST, SCENARIO
from survey.scenario import components
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario
from survey.score.faults import ScoreError
from terrain.map_frame import MapFrame
from terrain.seabed import Seabed

SAME_SEABED = 1e-3  # [m]
IDENTITY = ("scenario_sha256", "code_sha256", "files_sha256", "versions")


@dataclass(frozen=True, kw_only=True)
class ScoredRun:
    """A run to score by.

    Parameters
    ----------
    folder : Path
    scenario : Scenario
        As resolved in the folder.
    manifest : mapping
        What makes the run this run.
    frames : tuple of int
        Numbers of the frames that it holds, in order.
    """

    folder: Path
    scenario: Scenario
    manifest: dict[str, Any]
    frames: tuple[int, ...]

    @classmethod
    def open(cls, folder: Path) -> ScoredRun:
        """Open a finished run for reading.

        Raises
        ------
        ScoreError
            With every fault: no run, no frames, frames that are half-written.
        """
        if not (folder / MANIFEST).is_file() or not (folder / SCENARIO).is_file():
            if not folder.is_dir():
                raise ScoreError([f"{folder}: no such folder"], only_missing_files=True)
            raise ScoreError([f"{folder}: not a run folder. Make one with bathyflash run"])
        try:
            manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
            known = {key: manifest[key] for key in IDENTITY}
        except (ValueError, KeyError, TypeError):
            raise ScoreError([f"{folder / MANIFEST}: not that of a run. Fly it anew"]) from None
        whole, spoilt = whole_frames(folder)
        faults = [
            f"{folder}: frame {index}: {why}. Run the same command again"
            for index, why in sorted(spoilt.items())
        ]
        frames = tuple(sorted(whole))
        if not frames and not faults:
            faults.append(f"{folder}: no frame was flown. Run it first")
        if faults:
            raise ScoreError(faults)
        scenario = load_scenario(folder / SCENARIO)
        return cls(folder=folder, scenario=scenario, manifest=known, frames=frames)

    @property
    def map_frame(self) -> MapFrame:
        """The run's local frame."""
        return components.map_frame(self.scenario)

    @property
    def water_level(self) -> float:
        """True mean level of the water in the vertical datum [m]."""
        return self.scenario.surface.water_level_m

    @property
    def cell(self) -> float:
        """Side of the cells of coverage, as for metrics.json [m]."""
        spacing = components.camera(self.scenario).pixel_tangent * self.scenario.flight.height_m
        return max(self.scenario.processing.grid_m, spacing)

    def records(self) -> Iterator[PixelRecord]:
        """Yield the records of the frames, one at a time."""
        for index in self.frames:
            yield read_frame(frame_path(self.folder, index)).record

    def seabed(self) -> Seabed:
        """Build the seabed anew and see that it is the one that was flown over.

        Raises
        ------
        ScoreError
            When it is not: the run was flown by other code or over another file.
        """
        seabed = components.seabed(self.scenario)
        places = next(self.records()).true_position.reshape(-1, 3)
        places = places[np.isfinite(places).all(axis=1)]
        apart = np.abs(seabed.elevation_at(places[:, 0], places[:, 1]) - places[:, 2])
        if len(places) and not np.median(apart) <= SAME_SEABED:
            raise ScoreError(
                [
                    f"{self.folder}: the scenario's seabed has changed since it was flown over, by "
                    f"{np.median(apart):.3f} m. Fly it anew"
                ]
            )
        return seabed

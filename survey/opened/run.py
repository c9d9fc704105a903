"""A finished run, opened."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from survey.cloud.points import BOTTOM_CLASSES, PointClass
from survey.export import FinishedRun
from survey.labelled.export import joined
from survey.labelled.flown_run import FlownRun
from survey.labelled.picked import PickedPixels
from survey.opened.cloud import Cloud
from survey.opened.grid import grid_dataset
from survey.products.mesh_files import grid_mesh
from survey.products.ply_file import read_records
from survey.run_summary import summary
from survey.scenario.scenario import Scenario
from survey.score.scored_run import ScoredRun
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    import trimesh
    import xarray

    from terrain.seabed import Seabed


def open_run(folder: str | os.PathLike[str]) -> Run:
    """Open a finished run for reading.

    Parameters
    ----------
    folder : path
        What `fly` returned, or ``bathyflash run -o`` wrote.

    Raises
    ------
    FileNotFoundError
        When there is no such folder.
    UserError
        When it holds no run, or one that is not finished; the text says what to do.

    Examples
    --------
    >>> open_run("runs/none")
    Traceback (most recent call last):
    FileNotFoundError: [Errno 2] No such file or directory: 'runs/none'
    """
    path = Path(folder)
    return Run(finished=FinishedRun.open(path), flown=FlownRun.open(path))


@dataclass(frozen=True, kw_only=True, repr=False)
class Run:
    """A finished run; each part is read when it is first asked for.

    Clouds and meshes of other libraries lie in the local frame, metres from ``map_frame.origin``,
    since many of them keep float32. ``print(run)`` tells what the run achieved.

    Parameters
    ----------
    finished : FinishedRun
        Its products.
    flown : FlownRun
        Its frames.
    """

    finished: FinishedRun
    flown: FlownRun

    def __str__(self) -> str:
        return summary(self.folder, self.metrics)

    def __repr__(self) -> str:
        return f"Run in {self.folder}: {self.scenario.mission.title}, {len(self.frames)} frames"

    @property
    def folder(self) -> Path:
        """The run folder."""
        return self.finished.folder

    @property
    def scenario(self) -> Scenario:
        """What was flown, with every default."""
        return self.flown.scenario

    @property
    def frames(self) -> tuple[int, ...]:
        """Numbers of the frames that the run holds."""
        return self.flown.whole

    @property
    def map_frame(self) -> MapFrame:
        """Where the local frame lies on the map; its ``crs`` is pyproj's."""
        return self.finished.map_frame

    @property
    def metrics(self) -> dict[str, Any]:
        """The flight against the truth: what stands in metrics.json."""
        return self.finished.metrics

    @cached_property
    def cloud(self) -> Cloud:
        """All points of bottom.ply: bottom, land, noise, and places where no bottom was found."""
        return self._read("bottom.ply")

    @cached_property
    def bottom(self) -> Cloud:
        """Bottom points, classes 40 and 43: those that the metrics count."""
        return self.cloud.of_class(*BOTTOM_CLASSES)

    @cached_property
    def surface(self) -> Cloud:
        """First echoes on the water, class 41; over land there are none."""
        if "water_surface" not in self.finished.clouds:
            return self.cloud[:0]
        return self._read("water_surface.ply").of_class(PointClass.WATER_SURFACE)

    @cached_property
    def grid(self) -> xarray.Dataset:
        """The gridded bathymetry by northing and easting, row 0 in the north."""
        return grid_dataset(self.finished.grid, self.map_frame)

    @cached_property
    def mesh(self) -> trimesh.Trimesh:
        """The gridded bathymetry as a mesh coloured by depth, in the local frame, z up [m].

        ``pyvista.wrap(run.mesh)`` and ``run.mesh.as_open3d`` make others of it.

        Raises
        ------
        ProductError
            When no three neighbouring cells hold points.
        """
        level = self.finished.water_level
        return grid_mesh(self.finished.grid, self.map_frame, water_level=level)

    @cached_property
    def seabed(self) -> Seabed:
        """The true seabed; ``run.seabed.mesh`` is its mesh in the local frame, z up [m].

        Raises
        ------
        ScoreError
            When a file behind it has changed since it was flown over.
        """
        return ScoredRun.open(self.folder).seabed()

    def waveforms(self, frames: int | Iterable[int]) -> xarray.Dataset:
        """Return the labelled waveforms of one frame or several, flown again.

        Every pixel's expected light by origin, counts, thresholds, echoes and truth, see
        docs/waveforms.md: 25 MB a frame of 64 x 32 pixels and 320 bins. The frames last asked for
        are remembered. For many frames use ``bathyflash waveforms`` and `survey.open_waveforms`.
        A single frame has no dimension ``frame``.

        Parameters
        ----------
        frames : int or iterable of int
            Numbers, as in ``run.frames``.

        Raises
        ------
        UserError
            When the run does not hold such a frame.
        OtherRunError
            When a frame flown again is not the run's own: the run is of other code.
        """
        if not isinstance(frames, Iterable):
            return self.waveforms([frames]).isel(frame=0)
        return joined([self._again.frame(index) for index in self.flown.chosen(list(frames))])

    @cached_property
    def _again(self) -> PickedPixels:
        return PickedPixels(self.flown)

    def _read(self, name: str) -> Cloud:
        records, map_frame = read_records(self.folder / name)
        return Cloud(records=records, map_frame=map_frame, water_level=self.finished.water_level)

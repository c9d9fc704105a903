"""A finished run in the formats of other programs."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from survey.errors import UserError
from survey.products.cells import CellGrid
from survey.products.cog_file import write_bathymetry_cog
from survey.products.grids import ElevationGrid, gridded
from survey.products.las_copy import copy_las, read_points, solid_points
from survey.products.mesh_files import write_bathymetry_glb
from survey.products.mesh_formats import write_bathymetry_mesh
from survey.products.ply_file import copy_ply
from survey.products.tif_file import read_bathymetry_tif, write_bathymetry_tif
from survey.progress import Unwatched, Watcher
from survey.run_folder import whole_frames
from survey.run_identity import found_manifest
from survey.run_lock import require_free
from terrain.map_frame import MapFrame

CLOUDS = ("bottom", "water_surface")
WAVEFORMS = "zarr"


@dataclass(frozen=True, kw_only=True)
class FinishedRun:
    """A run folder whose products are whole.

    Parameters
    ----------
    folder : Path
    map_frame : MapFrame
    water_level : float
        [m].
    cell_size : float, optional
        Side of the cells of grids and meshes [m]; without it those of the run's grid.
    """

    folder: Path
    map_frame: MapFrame
    water_level: float
    cell_size: float | None = None

    @classmethod
    def open(cls, folder: Path, *, cell_size: float | None = None) -> FinishedRun:
        """Read what a run is and check that it is finished.

        Raises
        ------
        FileNotFoundError
            When there is no such folder.
        UserError
            When it holds no run, one that is still flown or has no products, or products of other
            frames.
        """
        _require_finished(folder)
        from survey.scenario import components
        from survey.scenario.load import load_scenario

        scenario = load_scenario(folder / "scenario.toml")
        return cls(
            folder=folder,
            map_frame=components.map_frame(scenario),
            water_level=scenario.surface.water_level_m,
            cell_size=cell_size,
        )

    @property
    def clouds(self) -> list[str]:
        """Names of the clouds that the run has; over land there is no water surface."""
        return [name for name in CLOUDS if (self.folder / f"{name}.laz").exists()]

    @cached_property
    def metrics(self) -> dict[str, Any]:
        """What stands in metrics.json."""
        return _metrics(self.folder)

    @cached_property
    def grid(self) -> ElevationGrid:
        """The gridded bathymetry."""
        if self.cell_size is None:
            return read_bathymetry_tif(self.folder / "bathymetry.tif")
        on_map, tvu = solid_points(self.folder / "bottom.laz")
        return gridded(on_map, CellGrid.covering(on_map, cell_size=self.cell_size), tvu)


@dataclass(frozen=True, kw_only=True)
class How:
    """How a run is exported.

    Parameters
    ----------
    standard_only : bool
        Clouds without our own columns, truth among them.
    watch : Watcher
        Is told of the progress where frames are flown again.
    """

    standard_only: bool = False
    watch: Watcher = field(default_factory=Unwatched)


Exporter = Callable[[FinishedRun, Path, How], Iterator[Path]]


def export_run(
    run: FinishedRun,
    output: Path,
    *,
    formats: Sequence[str],
    standard_only: bool = False,
    watch: Watcher | None = None,
) -> Iterator[Path]:
    """Write a run in some formats into a folder, and yield every file when it is whole.

    Parameters
    ----------
    run : FinishedRun
    output : Path
        Folder; made if it is not there. Files of the same names are replaced.
    formats : sequence of str
        Of `FORMATS`.
    standard_only : bool
        Clouds without our own columns, truth among them.
    watch : Watcher, optional
        Is told of the progress where frames are flown again.

    Raises
    ------
    ProductError
        When the run's files are not whole, or nothing is in them that the format can hold.
    UserError
        When the folder is the run's own, or the truth is asked for and refused at once.
    """
    if output.resolve() == run.folder.resolve():
        raise UserError(f"{output}: is the run folder itself. Choose another folder with -o")
    if standard_only and WAVEFORMS in formats:
        raise UserError(
            f"--standard-only: {WAVEFORMS} is waveforms labelled with the truth. "
            "Export it without this option"
        )
    how = How(standard_only=standard_only, watch=watch or Unwatched())
    output.mkdir(parents=True, exist_ok=True)
    for name in formats:
        yield from FORMATS[name](run, output, how)


def parse_formats(text: str) -> list[str]:
    """Return the formats of a list such as ``las,copc``.

    Examples
    --------
    >>> parse_formats("las, copc")
    ['las', 'copc']

    Raises
    ------
    UserError
        With every name that is no format.
    """
    names = list(dict.fromkeys(name.strip() for name in text.split(",")))
    unknown = [repr(name) for name in names if name not in FORMATS]
    if unknown:
        raise UserError(
            f"--to: {', '.join(unknown)}: no such format. There are {', '.join(FORMATS)}"
        )
    return names


def _require_finished(folder: Path) -> None:
    if not folder.exists():
        raise FileNotFoundError(2, "No such file or directory", str(folder))
    if found_manifest(folder) is None:
        raise UserError(f"{folder}: holds no run. Fly one with bathyflash run SCENARIO -o {folder}")
    require_free(folder)
    flown = len(whole_frames(folder)[0])
    again = "The same bathyflash run goes on from here"
    if not (folder / "metrics.json").exists() or not (folder / "bottom.laz").exists():
        raise UserError(f"{folder}: not finished: {flown} whole frames, no products. {again}")
    covered = _metrics(folder)["frames"]
    if covered != flown:
        raise UserError(
            f"{folder}: {flown} whole frames, but products of {covered}: broken off or changed. "
            f"{again}"
        )


def _metrics(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "metrics.json").read_text(encoding="utf-8"))
    return found


def _las(suffix: str) -> Exporter:
    def write(run: FinishedRun, output: Path, how: How) -> Iterator[Path]:
        for name in run.clouds:
            path = output / f"{name}{suffix}"
            copy_las(run.folder / f"{name}.laz", path, standard_only=how.standard_only)
            yield path

    return write


def _copc(run: FinishedRun, output: Path, how: How) -> Iterator[Path]:
    from survey.products.copc_file import write_copc

    for name in run.clouds:
        path = output / f"{name}.copc.laz"
        write_copc(path, read_points(run.folder / f"{name}.laz", standard_only=how.standard_only))
        yield path


def _ply(run: FinishedRun, output: Path, how: How) -> Iterator[Path]:
    for name in run.clouds:
        path = output / f"{name}.ply"
        copy_ply(run.folder / f"{name}.ply", path, standard_only=how.standard_only)
        yield path
    yield from _mesh(".ply")(run, output, how)


def _mesh(suffix: str) -> Exporter:
    def write(run: FinishedRun, output: Path, _: How) -> Iterator[Path]:
        path = output / f"bathymetry{suffix}"
        write_bathymetry_mesh(path, run.grid, run.map_frame, water_level=run.water_level)
        yield path

    return write


def _glb(run: FinishedRun, output: Path, _: How) -> Iterator[Path]:
    path = output / "bathymetry.glb"
    write_bathymetry_glb(path, run.grid, run.map_frame, water_level=run.water_level)
    yield path


def _tif(run: FinishedRun, output: Path, _: How) -> Iterator[Path]:
    path = output / "bathymetry.tif"
    write_bathymetry_tif(path, run.grid, run.map_frame)
    yield path


def _cog(run: FinishedRun, output: Path, _: How) -> Iterator[Path]:
    path = output / "bathymetry.cog.tif"
    write_bathymetry_cog(path, run.grid, run.map_frame)
    yield path


def _zarr(run: FinishedRun, output: Path, how: How) -> Iterator[Path]:
    from survey.labelled.export import write_waveforms
    from survey.labelled.flown_run import FlownRun
    from survey.labelled.pixels import Pixels

    flown = FlownRun.open(run.folder)
    camera = flown.scenario.camera
    every_pixel = Pixels.every(1, (camera.rows, camera.columns))
    path = output / "waveforms.zarr"
    yield write_waveforms(flown, path, pixels=every_pixel, overwrite=True, watch=how.watch)


FORMATS: dict[str, Exporter] = {
    "las": _las(".las"),
    "laz": _las(".laz"),
    "copc": _copc,
    "ply": _ply,
    "glb": _glb,
    "obj": _mesh(".obj"),
    "stl": _mesh(".stl"),
    "tif": _tif,
    "cog": _cog,
    WAVEFORMS: _zarr,
}
"""What ``bathyflash export --to`` knows: from run, folder and how to files."""

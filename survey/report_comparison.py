"""Two runs side by side: what differs in their scenarios, and what came of it."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from survey.errors import UserError
from survey.products.cells import CellGrid
from survey.products.grids import ElevationMap
from survey.products.report.curves import error_by_depth, found_by_strength
from survey.products.report.maps import depth_map, difference_map
from survey.products.report.page import Figure, figures, page
from survey.products.report.tables import compared_figures
from survey.products.verdict.words import verdict_lines
from survey.products.writing import write_whole
from survey.run_identity import SCENARIO, flat_keys

MOST_PICTURE_CELLS = 2000  # along a side
GRID, METRICS = "bathymetry.tif", "metrics.json"
PROSE = ("mission.title", "mission.description", "mission.expect")


@dataclass(frozen=True, kw_only=True)
class FinishedReport:
    """What a run's folder tells of it.

    Parameters
    ----------
    name : str
        Of the run: its folder's.
    keys : dict
        Values of its scenario by dotted key.
    metrics : dict
        What stands in metrics.json.
    grid : ElevationMap
        Gridded bathymetry.
    crs : str
        Of the grid.
    """

    name: str
    keys: dict[str, str]
    metrics: dict[str, Any]
    grid: ElevationMap
    crs: str

    @classmethod
    def of(cls, folder: Path) -> FinishedReport:
        """Read it.

        Raises
        ------
        UserError
            When the folder is no finished run; the text says what is missing.
        """
        missing = [name for name in (SCENARIO, METRICS, GRID) if not (folder / name).is_file()]
        if missing:
            raise UserError(
                f"{folder}: no {', no '.join(missing)}. Finish the run with: bathyflash run"
            )
        try:
            keys = flat_keys(tomllib.loads((folder / SCENARIO).read_text(encoding="utf-8")))
            metrics = json.loads((folder / METRICS).read_text(encoding="utf-8"))
            grid, crs = _grid(folder / GRID)
        except (ValueError, OSError) as fault:
            raise UserError(f"{folder}: {fault}. Fly it anew with --refly") from None
        return cls(name=folder.resolve().name, keys=keys, metrics=metrics, grid=grid, crs=crs)

    @property
    def water_level(self) -> float:
        """In the vertical datum [m]."""
        return float(self.keys["surface.water_level_m"])


def write_comparison(first: Path, second: Path, file: Path) -> None:
    """Write a page that compares two finished runs, self-contained.

    Raises
    ------
    UserError
        When one of the folders is no finished run.
    """
    a, b = FinishedReport.of(first), FinishedReport.of(second)
    if a.name == b.name:
        a, b = replace(a, name=str(first)), replace(b, name=str(second))
    write_whole(file, page(f"{a.name} and {b.name}", _lines(a, b)).encode())


def _lines(a: FinishedReport, b: FinishedReport) -> Iterator[str]:
    yield f"<h1>{escape(a.name)} and {escape(b.name)}</h1>"
    yield "<p>Every point of both surveys is simulated.</p>"
    yield from _what_differs(a, b)
    for run in (a, b):
        lines = "".join(f"<p>{escape(line)}</p>" for line in verdict_lines(run.metrics))
        yield f'<div class="verdict"><p><b>{escape(run.name)}</b></p>{lines}</div>'
    yield "<h2>Key figures</h2>"
    yield compared_figures({a.name: a.metrics, b.name: b.metrics})
    yield "<h2>Figures</h2>"
    yield from figures(_figures(a, b))


def _what_differs(a: FinishedReport, b: FinishedReport) -> Iterator[str]:
    """Return the keys of the scenarios that differ, prose left out."""
    keys = sorted((a.keys.keys() | b.keys.keys()) - set(PROSE))
    other = [key for key in keys if a.keys.get(key) != b.keys.get(key)]
    if not other:
        yield "<p>Their scenarios do not differ.</p>"
        return
    rows = "".join(_row(key, *(run.keys.get(key, "absent") for run in (a, b))) for key in other)
    head = _row("key", a.name, b.name)
    yield f"<h2>What differs in the scenarios</h2><table>{head}{rows}</table>"


def _row(*cells: str) -> str:
    return f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>"


def _figures(a: FinishedReport, b: FinishedReport) -> Iterator[Figure]:
    for run in (a, b):
        yield Figure(
            name=f"depth of {run.name}",
            png=depth_map(run.grid, water_level=run.water_level),
            words=f"Depth in {run.name}, cells of {run.grid.cells.cell_size:g} m.",
        )
    both = _difference(a, b)
    if both is not None:
        yield Figure(
            name="difference",
            png=difference_map(both),
            words=f"Elevation in {b.name} less that in {a.name} where both have a point; the "
            "colours end where 95 % of the cells lie.",
        )
    depths = _rows("error_by_depth", a, b)
    if all(any("mean_m" in row for row in rows) for rows in depths.values()):
        yield Figure(
            name="error by depth",
            png=error_by_depth(depths),
            words="Mean error and the band that holds 95 % of the points, by measured depth.",
        )
    strengths = _rows("detection_by_counts", a, b)
    if all(strengths.values()):
        yield Figure(
            name="detection",
            png=found_by_strength(strengths),
            words="How many of the true bottoms were found, by the counts that their echo should "
            "give in a gate.",
        )


def _rows(key: str, *runs: FinishedReport) -> Mapping[str, list[dict[str, Any]]]:
    return {run.name: run.metrics.get(key, []) for run in runs}


def _difference(a: FinishedReport, b: FinishedReport) -> ElevationMap | None:
    """Return the second less the first; None where their cells are others or none is shared."""
    first, second = a.grid.cells, b.grid.cells
    if a.crs != b.crs or first.cell_size != second.cell_size:
        return None
    shared = first.window(second)
    off = b.grid.elevation[second.window(first)] - a.grid.elevation[shared]
    if not np.isfinite(off).any():
        return None
    return ElevationMap(cells=first.part(shared), elevation=off)


def _grid(file: Path) -> tuple[ElevationMap, str]:
    """Read the elevations; of a large map those of cells whose number on the lattice of all maps is
    a multiple of some step, so that two maps of one step have the same cells.
    """
    import rasterio

    with rasterio.open(file) as raster:
        step = max(1, -(-max(raster.shape) // MOST_PICTURE_CELLS))
        side, west, north = raster.transform.a, raster.transform.c, raster.transform.f
        row, column = round(north / side) % step, -round(west / side) % step
        elevation = raster.read(1)[row::step, column::step].astype(np.float64)
        crs = raster.crs.to_string()
    rows, columns = elevation.shape
    cells = CellGrid(
        west=west + column * side,
        north=north - row * side,
        cell_size=side * step,
        rows=rows,
        columns=columns,
    )
    return ElevationMap(cells=cells, elevation=elevation), crs

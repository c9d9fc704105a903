"""Two runs on one page: what differs in their scenarios and what came of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from survey import report_comparison
from survey.cli import app
from survey.products.cells import CellGrid
from survey.products.grids import ElevationGrid
from survey.products.tif_file import write_bathymetry_tif
from survey.report_comparison import write_comparison
from terrain.map_frame import MapFrame

ORDER = {
    "title": "Order 1a",
    "result": "pass",
    "failed": [],
    "not_assessable": [],
    "criteria": {
        "tvu": {"reason": "no points"},
        "feature_search": {"limit": None},
        "coverage": {"reason": "100 % of the wet area was seen"},
    },
}
ROWS = [
    {"from_m": float(d), "to_m": d + 1.0, "points": 40, "false_bottoms": 0}
    | {"mean_m": 0.01, "low_m": -0.1, "high_m": 0.1}
    for d in (3, 4)
]


def finished(folder: Path, *, aperture: float, elevation: float) -> Path:
    """Make what a comparison reads of a run."""
    folder.mkdir()
    text = f"[surface]\nwater_level_m = 0.0\n[receiver]\naperture_radius_m = {aperture}\n"
    (folder / "scenario.toml").write_text(text)
    metrics = {
        "frames": 2,
        "found_depth_m": None,
        "bias_m": elevation + 4.0,
        "s44": {"judged": "1a", "asked": True, "orders": {"1a": ORDER}},
        "error_by_depth": ROWS,
    }
    (folder / "metrics.json").write_text(json.dumps(metrics))
    level = np.full((4, 5), elevation)
    cells = CellGrid(west=5e5, north=6e6, cell_size=2.0, rows=4, columns=5)
    grid = ElevationGrid(
        cells=cells, elevation=level, density=level, deviation=level, uncertainty=level
    )
    frame = MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714)
    write_bathymetry_tif(folder / "bathymetry.tif", grid, frame)
    return folder


@pytest.fixture
def runs(tmp_path: Path) -> tuple[Path, Path]:
    return (
        finished(tmp_path / "small", aperture=0.005, elevation=-4.0),
        finished(tmp_path / "large", aperture=0.02, elevation=-3.9),
    )


def test_a_comparison_tells_what_differs(runs: tuple[Path, Path], tmp_path: Path) -> None:
    write_comparison(*runs, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    assert "<td>receiver.aperture_radius_m</td><td>0.005</td><td>0.02</td>" in text
    assert "surface.water_level_m" not in text
    assert "<td>+0.000 m</td><td>+0.100 m</td>" in text
    for words in ("Elevation in large less that in small", "Order 1a passes", "Mean error and"):
        assert words in text, words


def test_runs_on_other_cells_have_no_map_of_differences(
    runs: tuple[Path, Path], tmp_path: Path
) -> None:
    far = CellGrid(west=6e5, north=6e6, cell_size=2.0, rows=4, columns=5)
    values = np.zeros(far.shape)
    grid: Any = ElevationGrid(
        cells=far, elevation=values, density=values, deviation=values, uncertainty=values
    )
    frame = MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714)
    write_bathymetry_tif(runs[1] / "bathymetry.tif", grid, frame)
    write_comparison(*runs, tmp_path / "page.html")
    assert "Elevation in" not in (tmp_path / "page.html").read_text()


def test_large_maps_are_compared_at_the_same_cells(
    runs: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every second cell of two maps that begin a cell apart: a slope is no difference."""
    monkeypatch.setattr(report_comparison, "MOST_PICTURE_CELLS", 4)
    frame = MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714)
    read = []
    for run, apart in zip(runs, (0.0, 2.0), strict=True):
        cells = CellGrid(west=5e5 + apart, north=6e6 - apart, cell_size=2.0, rows=6, columns=6)
        x, y = cells.centres()[..., 0] - 5e5, cells.centres()[..., 1] - 6e6
        slope = (0.1 * x + 0.03 * y).reshape(cells.shape)
        grid = ElevationGrid(
            cells=cells, elevation=slope, density=slope, deviation=slope, uncertainty=slope
        )
        write_bathymetry_tif(run / "bathymetry.tif", grid, frame)
        read.append(report_comparison.FinishedReport.of(run))
    off = report_comparison._difference(*read)
    assert off is not None
    assert off.cells.cell_size == 4.0
    assert np.nanmax(np.abs(off.elevation)) < 1e-5


def test_an_unfinished_run_is_named_with_what_is_missing(
    runs: tuple[Path, Path], tmp_path: Path
) -> None:
    (runs[1] / "metrics.json").unlink()
    (runs[1] / "bathymetry.tif").unlink()
    page = tmp_path / "page.html"
    result = CliRunner().invoke(app, ["report", str(runs[0]), str(runs[1]), "-o", str(page)])
    assert result.exit_code != 0
    assert not page.exists()
    assert "no metrics.json, no bathymetry.tif. Finish the run" in result.output

"""Where lines overlap: figures, raster and report against plain loops."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from survey.cloud.overlaps import SOLID, LineCells, Overlap, OverlapTally, line_cells
from survey.cloud.points import PointCloud
from survey.products.cells import CellGrid
from survey.products.report.tables import overlaps
from survey.products.strip_differences import overlap_metrics, strip_differences_tif
from survey.products.strip_picture import write_strip_picture
from terrain.map_frame import MapFrame

SIDE = 4.0


@pytest.fixture(scope="module")
def bottom(small_survey: Any) -> PointCloud:
    cloud: PointCloud = small_survey.bottom
    return cloud


@pytest.fixture(scope="module")
def cells(small_survey: Any, bottom: PointCloud) -> LineCells:
    solid = bottom.select(np.isin(bottom.classification, SOLID))
    places = small_survey.map_frame.to_map(solid.position)
    return line_cells(places, solid.line, cell_size=SIDE)


def found_in(*parts: LineCells) -> list[Overlap]:
    tally = OverlapTally()
    for part in parts:
        tally.add(part)
    return tally.overlaps()


def means(bottom: PointCloud, origin: Any) -> dict[int, dict[tuple[int, int], float]]:
    """Return mean elevations by line and cell, point by point."""
    found: dict[int, dict[tuple[int, int], list[float]]] = {}
    for line, place, name in zip(bottom.line, bottom.position, bottom.classification, strict=True):
        if name in (2, 40, 43):
            east, north = (place[:2] + origin[:2]) // SIDE
            key = (int(east), int(north))
            found.setdefault(int(line), {}).setdefault(key, []).append(float(place[2]))
    return {
        line: {key: float(np.mean(values)) for key, values in held.items()}
        for line, held in found.items()
    }


def part_of(cells: LineCells, which: NDArray[np.bool_]) -> LineCells:
    return LineCells(
        cell_size=SIDE,
        cell=cells.cell[which],
        line=cells.line[which],
        elevation=cells.elevation[which],
    )


def test_differences_are_those_of_plain_loops(
    small_survey: Any, bottom: PointCloud, cells: LineCells
) -> None:
    wanted = {}
    held = means(bottom, small_survey.map_frame.origin)
    for one, other in combinations(sorted(held), 2):
        both = sorted(held[one].keys() & held[other].keys())
        if both:
            wanted[one, other] = [held[other][key] - held[one][key] for key in both]
    west = cells.cell[:, 0] < np.median(cells.cell[:, 0])
    found = found_in(part_of(cells, west), part_of(cells, ~west))
    assert [each.lines for each in found] == sorted(wanted)
    for each in found:
        assert np.sort(each.differences) == pytest.approx(np.sort(wanted[each.lines]))
        assert each.area == len(wanted[each.lines]) * SIDE**2


def test_figures_of_an_overlap(cells: LineCells) -> None:
    pair = found_in(cells)[0]
    figures = overlap_metrics([pair])[0]
    assert figures["lines"] == [0, 1]
    assert figures["cells"] == len(pair.differences)
    assert figures["mean_difference_m"] == pytest.approx(pair.differences.mean(), abs=1e-4)
    rms = np.sqrt(np.mean(pair.differences**2))
    assert figures["rms_difference_m"] == pytest.approx(rms, abs=1e-4)
    assert 0.9 < np.mean(np.abs(pair.differences) < figures["p95_abs_difference_m"]) < 1.0


def write(path: Path, cells: LineCells, map_frame: MapFrame) -> None:
    grid = CellGrid.covering((cells.cell + 0.5) * SIDE, cell_size=SIDE)
    with strip_differences_tif(path, grid, map_frame) as add:
        add(grid, cells)


def test_the_raster_holds_last_less_first_line(
    tmp_path: Path, small_survey: Any, bottom: PointCloud, cells: LineCells
) -> None:
    import rasterio

    path = tmp_path / "strip_differences.tif"
    write(path, cells, small_survey.map_frame)
    held = means(bottom, small_survey.map_frame.origin)
    with rasterio.open(path) as raster:
        difference, lines = raster.read()
        for one, other in ((0, 1), (1, 2)):
            key = min(held[one].keys() & held[other].keys())
            here = [line for line in sorted(held) if key in held[line]]
            middle = (np.array(key) + 0.5) * SIDE
            row, column = raster.index(*middle)
            step = held[here[-1]][key] - held[here[0]][key]
            assert difference[row, column] == pytest.approx(step, abs=1e-5)
            assert lines[row, column] == len(here)
    assert np.array_equal(np.isfinite(difference), lines > 1)


def test_one_line_has_no_overlap(bottom: PointCloud) -> None:
    alone = bottom.select(bottom.line == 2)
    assert found_in(line_cells(alone.position, alone.line, cell_size=SIDE)) == []


def test_the_report_says_whether_strips_are_adjusted(cells: LineCells) -> None:
    figures = overlap_metrics(found_in(cells))
    assert overlaps([], "none") == []
    assert "strips not adjusted" in "".join(overlaps(figures, "none"))
    page = "".join(overlaps(figures, "boresight"))
    assert "adjusted: boresight" in page
    assert page.count("<tr>") == len(figures) + 1


def test_the_picture_shows_both_states(tmp_path: Path, small_survey: Any, cells: LineCells) -> None:
    raster, path = tmp_path / "differences.tif", tmp_path / "differences.png"
    write(raster, cells, small_survey.map_frame)
    write_strip_picture(path, raster, raster)
    assert path.read_bytes().startswith(b"\x89PNG")

"""A mission worked on tile by tile gives what it gives at once."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import PointCloud
from survey.cloud.stitch import stitched
from survey.products.cells import CellGrid
from survey.products.coverage import CoverageTally, hull_of
from survey.products.first_look import FirstLook
from survey.products.frame_file import FrameResult
from survey.products.grids import Overview, grid_elevation, gridded, solid_places
from survey.products.map_tiles import MapTile, map_tiles
from survey.products.tally import ErrorTally
from survey.products.tile_points import TilePoints, tile_points

THINNING, GRID, REACH = 7.3, 3.7, 4.1


@pytest.fixture(scope="module")
def results(small_survey: Any) -> list[FrameResult]:
    """Its frames, with ratios that differ from point to point and with equal ones."""
    snr = np.random.default_rng(4).integers(1, 6, len(small_survey.bottom)).astype(np.float32)
    bottom, surface = replace(small_survey.bottom, snr=snr), small_survey.surface
    return [
        FrameResult(
            bottom=bottom.select(bottom.frame == number),
            surface=surface.select(surface.frame == number),
            record=record,
        )
        for number, record in enumerate(small_survey.records)
    ]


@pytest.fixture(scope="module")
def look(small_survey: Any, results: list[FrameResult]) -> FirstLook:
    look = FirstLook(small_survey.map_frame)
    for result in results:
        look.add(result)
    return look


@pytest.fixture(scope="module")
def tiles(look: FirstLook) -> list[MapTile]:
    return list(
        map_tiles(
            extents=look.extents,
            points=look.points,
            lattice=look.raster(cell_size=GRID),
            margin=max(THINNING, REACH) + GRID,
            most=500,
        )
    )


@pytest.fixture(scope="module")
def parts(small_survey: Any, results: list[FrameResult], tiles: list[MapTile]) -> list[TilePoints]:
    return [
        tile_points(
            tile,
            (results[number] for number in tile.frames),
            thinning=THINNING,
            map_frame=small_survey.map_frame,
        )
        for tile in tiles
    ]


def in_flight_order(cloud: PointCloud) -> PointCloud:
    return cloud.select(np.lexsort((cloud.column, cloud.row, cloud.frame)))


@pytest.mark.parametrize("name", ["bottom", "surface"])
def test_the_same_points_stay(parts: list[Any], results: list[Any], name: str) -> None:
    wanted = stitched([getattr(result, name) for result in results], cell_size=THINNING)
    assert len(parts) > 20
    found = PointCloud.concatenate([getattr(part, name) for part in parts])
    for column, values in in_flight_order(found).columns().items():
        assert np.array_equal(values, wanted.columns()[column], equal_nan=True), column
    assert max(len(getattr(part, name)) for part in parts) < 1000


def test_the_same_cells_are_gridded(
    small_survey: Any, look: FirstLook, results: list[FrameResult], parts: list[TilePoints]
) -> None:
    bottom = stitched([result.bottom for result in results], cell_size=THINNING)
    raster = look.raster(cell_size=GRID)
    wanted = gridded(solid_places(bottom, small_survey.map_frame), raster)
    found = {name: np.full(raster.shape, np.nan) for name in ("elevation", "density", "deviation")}
    overview = Overview(raster)
    for part in parts:
        grid = gridded(solid_places(part.bottom, small_survey.map_frame), part.tile.cells)
        for name, values in found.items():
            values[raster.window(grid.cells)] = getattr(grid, name)[grid.cells.window(raster)]
        overview.add(grid)
    np.testing.assert_array_equal(found["elevation"], wanted.elevation)
    np.testing.assert_array_equal(found["deviation"], wanted.deviation)
    np.testing.assert_array_equal(np.nan_to_num(found["density"]), wanted.density)
    np.testing.assert_array_equal(overview.map().elevation, wanted.elevation)


def test_the_same_cells_are_covered(
    small_survey: Any, parts: list[TilePoints], results: list[FrameResult]
) -> None:
    hull = hull_of(small_survey.records) + small_survey.map_frame.origin[:2]
    at_once, by_tile = (
        CoverageTally(survey_area=hull, cell_size=GRID, reach=REACH) for _ in range(2)
    )
    places = np.concatenate([r.record.true_position[..., :2].reshape(-1, 2) for r in results])
    outcomes = np.concatenate([r.record.outcome.ravel() for r in results])
    at_once.add(places + small_survey.map_frame.origin[:2], outcomes)
    for part in parts:
        by_tile.add(part.looked_at, part.outcomes, part.tile.cells)
    assert np.array_equal(at_once.map().state, by_tile.map().state)
    assert np.unique(by_tile.map().state).size >= 4


def test_tiles_cover_the_map_once(tiles: list[MapTile]) -> None:
    west, south, east, north = np.array([[t.west, t.south, t.east, t.north] for t in tiles]).T
    random = np.random.default_rng(5)
    places = np.column_stack(
        [random.uniform(west.min(), east.max(), 500), random.uniform(south.min(), north.max(), 500)]
    )
    places = np.concatenate(
        [places, np.column_stack([west, south]), np.column_stack([east, north])]
    )
    assert np.sum([tile.contains(places) for tile in tiles], axis=0).max() == 1
    borders = {*west, *east}
    assert all(min(abs(edge - other) for other in borders if other != edge) > 1 for edge in borders)


def test_wide_flights_are_cut_into_tiles_of_bounded_size() -> None:
    """Two frames 40 km apart: no tile between them."""
    survey = np.array([[0.0, 0.0, 100.0, 50.0], [4e4, 4e4, 4e4 + 100.0, 4e4 + 50.0]])
    lattice = CellGrid.covering(survey.reshape(-1, 2), cell_size=5.0)
    found = list(map_tiles(extents=survey, points=np.array([9, 9]), lattice=lattice, margin=2.0))
    assert max(tile.cells.rows for tile in found) <= 1024
    assert sum(tile.cells.rows * tile.cells.columns for tile in found) < 20e6


def test_a_large_grid_is_seen_in_fewer_cells(small_survey: Any) -> None:
    grid = grid_elevation(small_survey.bottom, small_survey.map_frame, cell_size=0.5)
    overview = Overview(grid.cells)
    overview.add(grid)
    coarse = overview.map()
    assert coarse.cells.cell_size == 0.5 * 2
    assert coarse.elevation.size <= 1_000_000 < grid.elevation.size
    row, column = np.argwhere(np.isfinite(grid.elevation))[0] // 2
    four = grid.elevation[2 * row : 2 * row + 2, 2 * column : 2 * column + 2]
    assert coarse.elevation[row, column] == pytest.approx(np.nanmean(four))


def test_quantiles_are_those_of_all_errors_to_a_micrometre() -> None:
    random = np.random.default_rng(6)
    errors = np.concatenate([random.normal(0.0, 0.1, 5000), random.normal(0.0, 30.0, 400)])
    tally = ErrorTally()
    for part in np.array_split(errors, 7):
        tally.add(part)
    for share in (0.0, 0.5, 0.9, 0.95, 0.99, 1.0):
        wanted = np.quantile(np.abs(errors), share)
        assert tally.quantile_of_absolute(share) == pytest.approx(wanted, abs=1e-6)
    assert tally.mean == pytest.approx(errors.mean(), abs=1e-12)
    assert tally.root_mean_square == pytest.approx(np.sqrt(np.mean(errors**2)))
    edges = np.linspace(-1.0, 1.0, 51)
    wanted = np.histogram(np.clip(errors, -1.0, 1.0), edges)[0]
    assert tally.histogram(edges).sum() == errors.size
    assert np.abs(tally.histogram(edges) - wanted).max() <= 1

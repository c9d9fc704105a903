"""The verdict on surveys whose errors, holes and cubes are known."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import binom

from survey.cloud.overlaps import line_cells
from survey.cloud.points import Outcome, PixelRecord, PointCloud
from survey.optics.water import WaterColumn, petzold_water
from survey.optics.water.apparent import diffuse_attenuation, secchi_depth_of, tyler_secchi_depth
from survey.products.cells import CellGrid
from survey.products.coverage import (
    GAP,
    OUTSIDE_AREA,
    CoverageMap,
    CoverageTally,
    hull_of,
    looked_at,
)
from survey.products.map_tiles import MapTile
from survey.products.standards import norwegian_rules, orders
from survey.products.standards.tables import values_of
from survey.products.tile_points import TilePoints
from survey.products.verdict.extent import judge_coverage, judge_features
from survey.products.verdict.failure_picture import failure_picture
from survey.products.verdict.features import Cube, CubeTally
from survey.products.verdict.mission import Judged, VerdictTally
from survey.products.verdict.passes import Passes, PassTally
from survey.products.verdict.report import verdict_section
from survey.products.verdict.tally import OrderTally, interval, percentile
from survey.products.verdict.uncertainty import judge_errors
from survey.products.verdict.words import verdict_lines, verdict_sentence

FloatArray = NDArray[np.float64]
ORDERS = orders()
LEVEL = 0.25


def test_limits_are_those_of_the_table() -> None:
    """S-44 edition 6, table 1, by hand: at 10 m and at 40 m."""
    tvu = {key: order.tvu([10.0, 40.0]).round(3).tolist() for key, order in ORDERS.items()}
    assert tvu == {
        **{"exclusive": [0.168, 0.335], "special": [0.261, 0.391], "order_1a": [0.517, 0.721]},
        **{"order_1b": [0.517, 0.721], "order_2": [1.026, 1.359]},
    }
    thu = [float(order.thu(40.0)) for order in ORDERS.values()]
    assert thu == [1.0, 2.0, 7.0, 7.0, 24.0]
    assert [order.feature_at(10.0) for order in ORDERS.values()] == [0.5, 1.0, 2.0, None, None]
    assert [order.coverage for order in ORDERS.values()] == [2.0, 1.0, 0.05, 0.05, 0.05]


def test_a_figure_without_a_source_is_refused() -> None:
    with pytest.raises(ValueError, match="no source for thu_m"):
        values_of({"thu_m": {"value": 1.0, "source": ""}})


def points(survey: Any, depth: FloatArray, error: FloatArray, aside: FloatArray) -> PointCloud:
    """Return bottom points at true depths with given vertical and horizontal errors."""
    some = survey.bottom.select(np.zeros(depth.size, dtype=np.intp))
    truth = np.column_stack([np.zeros((depth.size, 2)), LEVEL - depth])
    moved = truth + np.column_stack([aside, np.zeros(depth.size), error])
    return replace(
        some,
        position=moved,
        truth=truth,
        true_elevation=truth[:, 2],
        classification=np.full(depth.size, 40, dtype=np.uint8),
    )


def tallied(*clouds: PointCloud) -> OrderTally:
    tally = OrderTally(orders=list(ORDERS.values()))
    for cloud in clouds:
        tally.add(cloud, water_level=LEVEL)
    return tally


@pytest.mark.parametrize(("outside", "result"), [(10, "pass"), (11, "fail")])
def test_one_point_too_many_outside_the_limit_fails(
    small_survey: Any, outside: int, result: str
) -> None:
    """Of 200 points at 10.5 m ten may exceed 0.262 m, and ten may lie more than 2 m aside.

    The others err by 0.255 m: over the limit at the surface, under that at their depth.
    """
    wrong = np.arange(200) < outside
    depth, zeros = np.full(200, 10.5), np.zeros(200)
    beyond = float(ORDERS["special"].tvu(10.5)) + 1e-6
    deep = tallied(points(small_survey, depth, np.where(wrong, -beyond, 0.255), zeros))
    found = judge_errors(deep, ORDERS["special"], "tvu")
    assert (found.result, found.figure) == (result, 1.0 - outside / 200)
    aside = tallied(points(small_survey, depth, zeros, np.where(wrong, 2.001, 1.999)))
    assert judge_errors(aside, ORDERS["special"], "thu").result == result
    assert judge_errors(aside, ORDERS["order_1a"], "thu").result == "pass"


def test_one_bad_depth_fails_though_all_depths_together_pass(small_survey: Any) -> None:
    depth = np.concatenate([np.full(5000, 3.5), np.full(100, 8.5)])
    error = np.concatenate([np.zeros(5000), np.full(100, 0.4)])
    tally = tallied(points(small_survey, depth, error, np.zeros(5100)))
    found = judge_errors(tally, ORDERS["special"], "tvu")
    assert found.result == "fail"
    assert "at 8 to 9 m 0.0 % of 100 points" in found.reason
    assert "bias +0.40 m, spread 0.00 m" in found.reason
    assert judge_errors(tally, ORDERS["order_1a"], "tvu").result == "pass"


def test_false_bottoms_count(small_survey: Any) -> None:
    error = np.where(np.arange(100) < 6, 4.0, 0.0)
    tally = tallied(points(small_survey, np.full(100, 9.5), error, np.zeros(100)))
    found = judge_errors(tally, ORDERS["order_2"], "tvu")
    assert found.result == "fail"
    assert "6 false bottoms" in found.reason


def test_few_points_show_nothing(small_survey: Any) -> None:
    tally = tallied(points(small_survey, np.full(58, 5.5), np.zeros(58), np.zeros(58)))
    found = judge_errors(tally, ORDERS["order_2"], "tvu")
    assert found.result == "not assessable"
    assert "59 are the fewest" in found.reason


def test_counts_do_not_depend_on_how_a_cloud_is_cut(small_survey: Any) -> None:
    random = np.random.default_rng(4)
    cloud = points(
        small_survey, random.uniform(0, 30, 900), random.normal(0, 0.3, 900), np.zeros(900)
    )
    whole = judge_errors(tallied(cloud), ORDERS["special"], "tvu").as_json()
    cut = tallied(cloud.select(slice(0, 100)), cloud.select(slice(100, None)))
    assert judge_errors(cut, ORDERS["special"], "tvu").as_json() == whole


def test_percentile_by_steps_is_numpy_s_to_a_step() -> None:
    error = np.abs(np.random.default_rng(5).normal(0, 0.4, 4000))
    histogram = np.bincount((error / 0.005).astype(int), minlength=1001)
    assert percentile(histogram, 0.95) == pytest.approx(np.percentile(error, 95), abs=0.01)
    assert percentile(np.bincount([1000] * 9, minlength=1001), 0.95) is None


def test_interval_leaves_a_fortieth_on_either_side() -> None:
    """By the binomial distribution itself, not by the beta function that made it."""
    low, high = interval(95, 100)
    assert binom.sf(94, 100, low) == pytest.approx(0.025, rel=1e-6)
    assert binom.cdf(95, 100, high) == pytest.approx(0.025, rel=1e-6)
    assert interval(0, 10)[0] == 0.0


def test_passes_are_counted_as_by_hand(small_survey: Any) -> None:
    """Against the distance from every centre to every pixel."""
    cells = CellGrid.covering(np.array([[0.0, 0.0], [90.0, 60.0]]), cell_size=3.0)
    places, outcomes, flash = pixels(small_survey.records[:4])
    places, reach = places - [20.0, -10.0], 4.4
    wanted = np.zeros(cells.shape, dtype=int)
    for number in range(4):
        seen = np.isin(outcomes, (Outcome.FOUND, Outcome.DRY)) & (flash == number)
        apart = np.linalg.norm(cells.centres()[:, :, None] - places[seen], axis=-1)
        wanted += (apart <= reach).any(axis=-1)
    assert wanted.max() >= 1
    whole, parts = (PassTally(cells=cells, reach=reach) for _ in range(2))
    whole.add(places, outcomes, flash)
    for columns in (slice(0, 11), slice(11, None)):
        part = cells.part((slice(0, cells.rows), slice(*columns.indices(cells.columns)[:2])))
        parts.add(places, outcomes, flash, part)
    np.testing.assert_array_equal(whole.frames, wanted)
    np.testing.assert_array_equal(parts.frames, wanted)


def pixels(records: list[PixelRecord]) -> tuple[FloatArray, Any, Any]:
    """Return where the pixels of frames look, what became of the bottom, and which frame it was."""
    parts = [looked_at(record) for record in records]
    flash = np.repeat(np.arange(len(parts)), [len(places) for places, _ in parts])
    places, outcomes = zip(*parts, strict=True)
    return np.concatenate(places), np.concatenate(outcomes), flash


def area(frames: NDArray[np.uint16], *, cell: float = 0.5) -> tuple[Passes, CoverageMap]:
    """Return a wet survey area seen so often, its unseen cells gaps."""
    rows, columns = frames.shape
    cells = CellGrid(west=0.0, north=cell * rows, cell_size=cell, rows=rows, columns=columns)
    state = np.where(frames > 0, Outcome.FOUND, GAP).astype(np.int16)
    wet = np.ones(frames.shape, dtype=np.bool_)
    return Passes(cells=cells, wet=wet, frames=frames), CoverageMap(cells=cells, state=state)


def test_full_coverage_bears_gaps_in_which_no_cube_has_room() -> None:
    frames = np.full((20, 20), 2, dtype=np.uint16)
    frames[4, 3:9] = 0
    passes, coverage = area(frames)
    narrow = judge_coverage(passes, coverage, asked=1.0, hole=1.0)
    assert (narrow.result, narrow.figure) == ("pass", 1.0)
    assert judge_coverage(passes, coverage, asked=1.0, hole=0.5).result == "fail"
    frames[5, 3:5] = 0
    passes, coverage = area(frames)
    wide = judge_coverage(passes, coverage, asked=1.0, hole=1.0)
    assert (wide.result, wide.figure) == ("fail", 1.0 - 4 / 400)
    assert wide.details["missing"] == {"gap between frames": 0.01}
    assert judge_coverage(passes, coverage, asked=0.05, hole=0.0).result == "pass"


def test_exclusive_order_asks_every_place_twice() -> None:
    frames = np.full((20, 20), 2, dtype=np.uint16)
    frames[:, :5] = 1
    found = judge_coverage(*area(frames), asked=2.0, hole=0.5)
    assert (found.result, found.figure) == ("fail", 0.75)
    assert found.details["missing"] == {"seen too few times": 0.25}


def test_an_area_without_water_is_not_assessable() -> None:
    passes, coverage = area(np.ones((2, 2), dtype=np.uint16))
    dry = replace(passes, wet=np.zeros((2, 2), dtype=np.bool_))
    assert judge_coverage(dry, coverage, asked=1.0, hole=1.0).result == "not assessable"


def bed_with(cube: Cube) -> Any:
    """Return the elevation of a level bed at -8 m with a cube on it."""

    def elevation(x: FloatArray, y: FloatArray) -> FloatArray:
        return np.where(cube.holds(np.column_stack([x, y])), -8.0 + cube.side, -8.0)

    return elevation


def on_cube(survey: Any, cube: Cube, heights: list[float]) -> Any:
    """Return what a cloud with points of these heights over the bed, above the cube, tells."""
    tally = CubeTally(cubes=[cube], elevation_at=bed_with(cube))
    zeros = np.zeros(len(heights))
    cloud = points(survey, zeros, zeros, zeros)
    spread = np.linspace(-0.3, 0.3, len(heights))
    places = [cube.east + spread, cube.north + spread, np.array(heights) - 8.0]
    tally.add(replace(cloud, position=np.column_stack(places)))
    return tally.found()


def test_a_cube_is_found_by_three_points_that_stand_out(small_survey: Any) -> None:
    cube = Cube(side=1.0, east=3.0, north=4.0, heading=0.4)
    found = on_cube(small_survey, cube, [1.02, 0.9, 0.55, 0.1])
    assert judge_features(found, ORDERS["special"], water_level=0.0).result == "pass"
    assert (found[0].points, found[0].top, found[0].bed) == (3, -7.0, -8.0)
    assert found[0].highest == pytest.approx(-6.98)
    lost = on_cube(small_survey, cube, [1.02, 0.9, 0.45, 0.1])
    judged = judge_features(lost, ORDERS["special"], water_level=0.0)
    assert judged.result == "fail"
    assert "1 m with 2 points on it" in judged.reason


def test_cubes_of_another_size_cannot_pass_an_order(small_survey: Any) -> None:
    """A found cube of 2 m says nothing of 1 m; one of 1 m tells of 2 m; a lost one of 2 m fails."""
    large = on_cube(small_survey, Cube(side=2.0, east=3.0, north=4.0), [2.0, 2.0, 2.0])
    assert judge_features(large, ORDERS["special"], water_level=0.0).result == "not assessable"
    assert judge_features(large, ORDERS["order_1a"], water_level=0.0).result == "pass"
    small = on_cube(small_survey, Cube(side=1.0, east=3.0, north=4.0), [1.0, 1.0, 1.0])
    assert judge_features(small, ORDERS["order_1a"], water_level=0.0).result == "pass"
    unseen = on_cube(small_survey, Cube(side=1.0, east=3.0, north=4.0), [0.1])
    assert judge_features(unseen, ORDERS["order_1a"], water_level=0.0).result == "not assessable"
    lost = on_cube(small_survey, Cube(side=2.0, east=3.0, north=4.0), [0.1, 0.0])
    assert judge_features(lost, ORDERS["special"], water_level=0.0).result == "fail"
    assert judge_features([], ORDERS["special"], water_level=0.0).result == "not assessable"
    assert judge_features([], ORDERS["order_2"], water_level=0.0).result == "pass"


def judged(
    survey: Any,
    *,
    bottom: PointCloud | None = None,
    cubes: Sequence[Cube] = (),
    asked: str | None = None,
) -> Judged:
    """Return the verdict over a survey's hull in cells of 8 m, as one tile."""
    places, outcomes, flash = pixels(survey.records)
    places = places + survey.map_frame.origin[:2]
    area = hull_of(survey.records) + survey.map_frame.origin[:2]
    coverage = CoverageTally(survey_area=area, cell_size=8.0, reach=9.1)
    coverage.add(places, outcomes)
    tally = VerdictTally(
        cells=coverage.cells,
        seabed=survey,
        water_level=survey.water_level,
        reach=9.1,
        cubes=cubes,
    )
    west, east, south, north = coverage.cells.extent
    borders = {"west": west, "south": south, "east": east, "north": north, "margin": 0.0}
    part = TilePoints(
        tile=MapTile(cells=coverage.cells, frames=np.arange(32), **borders),
        bottom=survey.bottom if bottom is None else bottom,
        surface=survey.surface,
        looked_at=places,
        outcomes=outcomes,
        flash=flash,
        lines=line_cells(survey.bottom.position, survey.bottom.line, cell_size=8.0),
    )
    tally.add(part)
    return tally.judged(coverage.map(), asked=asked)


def test_a_survey_passes_as_strict_an_order_as_it_can(small_survey: Any) -> None:
    """Errors of 8 cm, no cube: Special Order on all but the cube; Exclusive asks all twice."""
    found = judged(small_survey)
    s44 = found.metrics["s44"]
    results = {key: order["result"] for key, order in s44["orders"].items()}
    assert results.pop("exclusive") == "fail"
    assert set(results.values()) == {"pass"}
    assert s44["judged"] == "special"
    assert s44["orders"]["special"]["not_assessable"] == ["feature_detection"]
    assert verdict_sentence(s44["orders"]["special"]) == (
        "Special Order passes on all that is assessable; not assessable: feature detection"
    )
    assert found.failures.title == "Exclusive Order"
    assert found.metrics["norwegian_alb"]["result"] == "fail"
    assert found.metrics["norwegian_alb"]["criteria"]["density"]["figure"] < 0.1


def test_a_shifted_survey_fails_with_its_reason_and_its_place(small_survey: Any) -> None:
    position = small_survey.bottom.position.copy()
    half = position[:, 1] > np.median(position[:, 1])
    position[half, 2] += 0.7
    found = judged(
        small_survey, bottom=replace(small_survey.bottom, position=position), asked="order_1a"
    )
    order = found.metrics["s44"]["orders"]["order_1a"]
    assert (order["result"], order["failed"]) == ("fail", ["tvu"])
    assert "bias +0." in order["criteria"]["tvu"]["reason"]
    wrong = found.failures.state > 0
    north = found.failures.passes.cells.centres()[..., 1] > 6000456.75 + np.median(position[:, 1])
    assert wrong[north & found.failures.passes.wet].mean() > 0.8
    assert wrong[~north & found.failures.passes.wet].mean() < 0.1
    section = "\n".join(verdict_section(found))
    assert "Order 1a fails: depth error (TVU)" in section
    assert failure_picture(found.failures).startswith(b"\x89PNG")


def test_three_lines_tell_errors_coverage_and_reach(small_survey: Any) -> None:
    metrics = judged(small_survey, asked="order_1a").metrics | {
        **{"found_depth_m": 7.0, "found_depth_secchi": 0.47, "found_depth_k_d_z": 1.33},
        "secchi_depth_m": 14.8,
    }
    errors, coverage, reached = verdict_lines(metrics)
    assert errors.startswith("Order 1a passes on all that is assessable")
    assert "Depth errors come nearest to its limit at" in errors
    assert re.search(r"95 % of \d+ points within 0\.1\d m, 0\.5\d m allowed", errors)
    assert coverage == "coverage: 100 % of the wet area was seen"
    assert reached == (
        "bottom reached by nine pixels in ten down to 7.0 m: 0.47 Secchi depths (of 14.8 m), "
        "K_d z 1.33"
    )


def test_what_keeps_the_next_stricter_order_from_passing_is_told() -> None:
    row = {
        **{"from_depth_m": 0.0, "to_depth_m": 1.0, "points": 290, "share": 1.0},
        **{"limit_m": 1.0, "p95_abs_error_m": 0.73},
    }
    depth = {"result": "pass", "by_depth": [row], "reason": "at 0 to 1 m all"}
    asked = {"limit": None, "reason": "88 % was seen"}
    criteria = {"tvu": depth, "coverage": asked, "feature_search": asked}
    passed = {"title": "Order 2", "result": "pass", "failed": [], "not_assessable": []}
    failed = {"title": "Order 1b", "result": "fail", "failed": ["tvu"], "not_assessable": []}
    orders = {
        "order_1b": failed | {"criteria": criteria | {"tvu": {"reason": "at 0 to 1 m 17 %"}}},
        "order_2": passed | {"criteria": criteria},
    }
    metrics: dict[str, Any] = {"found_depth_m": None}
    s44 = {"judged": "order_2", "asked": None, "orders": orders}
    first, stricter, *rest = verdict_lines(metrics | {"s44": s44})
    assert first == (
        "Order 2 passes. Depth errors come nearest to its limit at 0 to 1 m: 95 % of 290 points "
        "within 0.73 m, 1.00 m allowed"
    )
    assert stricter == "Order 1b fails: depth error (TVU): at 0 to 1 m 17 %"
    assert len(rest) == 2
    assert len(verdict_lines(metrics | {"s44": s44 | {"asked": "order_2"}})) == 3


def test_cubes_outside_the_area_are_nobody_s_fault(small_survey: Any) -> None:
    far = Cube(side=2.0, east=-5000.0, north=0.0)
    found = judged(small_survey, cubes=[far]).metrics["s44"]["orders"]["order_1a"]
    assert found["criteria"]["feature_detection"]["result"] == "not assessable"


def test_outside_the_area_nothing_fails(small_survey: Any) -> None:
    failures = judged(small_survey).failures
    assert (failures.state[~failures.passes.wet] == -1).all()
    assert OUTSIDE_AREA not in failures.state[failures.passes.wet]


def test_secchi_depth_of_layers_is_where_their_integral_says() -> None:
    clear, harbor = (
        petzold_water(kind, refractive_index=1.34, group_index=1.36) for kind in ("clear", "harbor")
    )
    column = WaterColumn.uniform(clear).with_layer(harbor, top=5.0, bottom=6.5)
    depth = secchi_depth_of(column)
    steps = np.linspace(0.0, depth, 200_001)
    middle = 0.5 * (steps[1:] + steps[:-1])
    turbid = (middle > 5.0) & (middle < 6.5)
    rates = [water.attenuation + diffuse_attenuation(water) for water in (clear, harbor)]
    integral = np.where(turbid, rates[1], rates[0]).sum() * (steps[1] - steps[0])
    assert integral == pytest.approx(8.69, abs=1e-3)
    alone = tyler_secchi_depth(
        attenuation=clear.attenuation, diffuse_attenuation=diffuse_attenuation(clear)
    )
    assert depth < alone
    assert secchi_depth_of(WaterColumn.uniform(clear)) == pytest.approx(alone)


def test_norwegian_density_is_judged_two_metres_down() -> None:
    rules = norwegian_rules()
    assert (rules.density, rules.cell, rules.cells, rules.hole) == (5.0, 2.0, 0.8, 50.0)
    assert (rules.least_depth, rules.largest_depth) == (1.5, 2.5)

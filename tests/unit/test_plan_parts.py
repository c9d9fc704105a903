"""Overlaps, gaps and response tables of a plan, each by itself."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib import resources

import numpy as np
import pytest

from survey.flight.pose import Frame, Pose
from survey.optics import water_response as responses
from survey.optics.response_table import response_table
from survey.optics.water import WaterColumn, petzold_water
from survey.planning.gaps import Swath, swath
from survey.planning.make_response_tables import tables
from survey.planning.overlap import (
    between,
    one_after_another,
    overlap,
    side_by_side,
    triangles,
)
from survey.planning.views import WaterSurface, views
from survey.sensor.camera import Camera

CAMERA = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")


def line(
    number: int, east: float, *, heading: float = 0.0, frames: int = 3, first: int = 0
) -> list[Frame]:
    """Return frames that fly north 100 m apart, or back south."""
    steps = range(frames) if heading == 0.0 else reversed(range(frames))
    return [
        Frame(
            index=first + i,
            line=number,
            time=float(i),
            pose=Pose(
                position=np.array([east, 100.0 * step, 200.0]), roll=0.0, pitch=0.0, heading=heading
            ),
        )
        for i, step in enumerate(steps)
    ]


def two_lines(apart: float) -> list[Frame]:
    return [*line(0, 0.0), *line(1, apart, heading=np.pi, first=3)]


def test_sidelap_of_lines_flown_there_and_back() -> None:
    frames = two_lines(40.0)
    seen = views(CAMERA, frames, WaterSurface(level=0.0))
    beside = side_by_side(frames, seen)
    assert sorted(map(tuple, beside.pairs.tolist())) == [(0, 5), (1, 4), (2, 3)]
    found = overlap(beside, seen)
    assert found is not None
    assert (found.length, found.share) == pytest.approx((11.2, 11.2 / 51.2))


def test_each_line_has_its_next_one_as_neighbour_only() -> None:
    frames = [f for i in range(4) for f in line(i, 30.0 * i, first=3 * i)]
    seen = views(CAMERA, frames, WaterSurface(level=0.0))
    pairs = side_by_side(frames, seen).pairs
    assert {(frames[a].line, frames[b].line) for a, b in pairs} == {(0, 1), (1, 2), (2, 3)}
    assert len(pairs) == 9


def test_lines_that_cross_are_no_neighbours() -> None:
    across = [
        Frame(
            index=3 + i,
            line=1,
            time=float(i),
            pose=Pose(
                position=np.array([100.0 * i - 100.0, 100.0, 200.0]),
                roll=0.0,
                pitch=0.0,
                heading=0.5 * np.pi,
            ),
        )
        for i in range(3)
    ]
    frames = [*line(0, 0.0), *across]
    seen = views(CAMERA, frames, WaterSurface(level=0.0))
    assert len(side_by_side(frames, seen).pairs) == 0
    assert len(one_after_another(frames).pairs) == 4


def test_many_flashes_a_view_are_thinned_and_give_the_same_sidelap() -> None:
    frames = [
        Frame(
            index=100 * number + i,
            line=number,
            time=0.01 * i,
            pose=Pose(
                position=np.array([40.0 * number, 1.0 * i, 200.0]), roll=0.0, pitch=0.0, heading=0.0
            ),
        )
        for number in range(2)
        for i in range(100)
    ]
    seen = views(CAMERA, frames, WaterSurface(level=0.0))
    beside = side_by_side(frames, seen)
    assert 5 <= len(beside.pairs) <= 20
    found = overlap(beside, seen)
    assert found is not None
    assert found.length == pytest.approx(11.2)


def test_overlap_of_unlike_views() -> None:
    """From 200 m 51.2 m ahead are seen, from 100 m 25.6 m back."""
    frames = line(0, 0.0, frames=2)
    for frame, height, north in zip(frames, (200.0, 100.0), (0.0, 70.0), strict=True):
        frame.pose.position[1:] = north, height
    seen = views(CAMERA, frames, WaterSurface(level=0.0))
    found = overlap(one_after_another(frames), seen)
    assert found is not None
    assert (found.length, found.share) == pytest.approx((6.8, 6.8 / 102.4))


def missed(frames: list[Frame], camera: Camera = CAMERA) -> Swath:
    seen = views(camera, frames, WaterSurface(level=0.0))
    following, beside = one_after_another(frames), side_by_side(frames, seen)
    planned = [*between(following, seen), *between(beside, seen)]
    planned += triangles(following, beside, seen)
    return swath(seen.polygons(), planned, direction=np.array([0.0, 1.0]))


def test_a_gap_between_lines_is_found_with_its_area() -> None:
    (gap,) = missed(two_lines(80.0)).gaps
    assert gap.area == pytest.approx((80.0 - 51.2) * 302.4, rel=0.005)
    low, high = gap.rings[0].min(axis=0), gap.rings[0].max(axis=0)
    assert (low[0], high[0]) == pytest.approx((25.6, 54.4), abs=0.3)


def test_gaps_both_ways_are_one_with_the_corners_between_four_frames() -> None:
    turned = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="across")
    (gap,) = missed(two_lines(130.0), turned).gaps
    along, aside = 48.8, 130.0 - 102.4
    alongside = 2 * 2 * along * 102.4  # between frames of both lines
    assert gap.area == pytest.approx(alongside + aside * (3 * 51.2 + 2 * along), rel=0.01)


def test_swinging_views_leave_ragged_edges_that_are_no_gaps() -> None:
    frames = [
        replace(frame, pose=replace(frame.pose, roll=np.radians(roll), heading=np.radians(yaw)))
        for frame, roll, yaw in zip(
            line(0, 0.0, frames=4), (0.0, 3.0, -3.0, 3.0), (1.0, -1.0, 1.0, 0.0), strict=True
        )
    ]
    assert missed(frames).gaps == []


def test_an_ordered_area_counts_and_not_what_lies_beside_it() -> None:
    (only,) = frames = line(0, 0.0, frames=1)
    seen = views(CAMERA, frames, WaterSurface(level=0.0))
    area = only.pose.position[:2] + np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 20.0], [0.0, 20.0]])
    found = swath(seen.polygons(), [area], direction=np.array([0.0, 1.0]))
    assert found.gap_area == pytest.approx((100.0 - 25.6) * 20.0, rel=0.01)


def test_small_rests_are_no_gaps() -> None:
    box = np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 10.0], [0.0, 10.0]])
    found = swath([box], [box * [1.2, 1.0]], direction=np.array([1.0, 0.0]))
    assert found.gaps == []


def stated(**changes: float) -> WaterColumn:
    return WaterColumn.uniform(
        petzold_water("coastal", refractive_index=1.33, group_index=1.33, **changes)
    )


@pytest.mark.parametrize("name", ["clear", "coastal", "harbor"])
@pytest.mark.parametrize("lit", ["flood", "isolated"])
def test_tables_fall_with_depth_and_share_out_all_their_light(name: str, lit: str) -> None:
    table = response_table(name, "flood" if lit == "flood" else "isolated")
    assert np.all(np.diff(table.two_way) < 0.0)
    assert table.late_share.sum(axis=1) == pytest.approx(1.0, abs=1e-3)
    assert table.two_way_at(np.array([0.0, *table.depth[1:3]])) == pytest.approx(table.two_way[:3])
    deeper = 1.2 * table.depth[-1]
    assert 0.0 < table.two_way_at(np.array([deeper]))[0] < table.two_way[-1]


def test_the_script_makes_the_shipped_tables() -> None:
    """With a fiftieth of the walks, at a depth where a tenth of the light comes back."""
    made = tables(work=0.02)
    folder = resources.files("survey.optics") / "data"
    shipped = json.loads((folder / "response_tables.json").read_text(encoding="utf-8"))
    assert set(made) == set(shipped)
    assert made["late_edges_m"] == shipped["late_edges_m"]
    for name, water in shipped["waters"].items():
        again = made["waters"][name]
        assert again["depth_m"] == water["depth_m"]
        at = int(np.searchsorted(-np.array(water["flood"]["two_way"]), -0.1))
        for lit in ("flood", "isolated"):
            error = np.hypot(again[lit]["two_way_sem"][at], water[lit]["two_way_sem"][at])
            assert abs(again[lit]["two_way"][at] - water[lit]["two_way"][at]) < 4.0 * error
            assert len(again[lit]["column_sem"]) == len(water[lit]["column_per_m_sr"])


def test_a_flood_sends_back_more_than_an_isolated_pixel() -> None:
    for name in ("clear", "coastal", "harbor"):
        flood, isolated = (response_table(name, lit) for lit in ("flood", "isolated"))
        assert np.all(flood.two_way[1:] > isolated.two_way[1:])
        assert np.all(flood.column[20:] > isolated.column[20:])


def test_twice_the_coefficients_is_half_the_depth() -> None:
    """A flooded water scaled as a whole; the K_d of Lee et al. itself scales to 1 %."""
    water = stated(absorption=2 * 0.179, scattering=2 * 0.219)
    found = responses.water_response(water, "flood")
    traced = response_table("coastal", "flood")
    depth = np.array([3.0, 8.0, 15.0])
    assert found.is_estimate
    assert found.table.two_way_at(0.5 * depth) == pytest.approx(traced.two_way_at(depth), rel=0.04)
    assert found.table.column_at(0.5 * depth) == pytest.approx(
        2.0 * traced.column_at(depth), rel=0.05
    )


@pytest.mark.parametrize("lit", ["flood", "isolated"])
def test_coastal_water_made_from_its_neighbours_comes_near(
    lit: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the docstring of `water_response` says."""
    which = "flood" if lit == "flood" else "isolated"
    others = {k: v for k, v in responses.PAPER_COEFFICIENTS.items() if k != "coastal"}
    monkeypatch.setattr(responses, "PAPER_COEFFICIENTS", others)
    made = responses.water_response(stated(), which)
    assert made.is_estimate
    traced, depth = response_table("coastal", which), np.linspace(0.1, 60.0, 3000)
    for wanted in (2.0, 5.0, 10.0, 15.0, 25.0):
        light = traced.two_way_at(np.array([wanted]))
        same = np.interp(-np.log(light), -np.log(made.table.two_way_at(depth)), depth)[0]
        assert same == pytest.approx(wanted, rel=0.07)
    at = np.array([5.0, 10.0, 15.0])
    assert np.all(made.table.column_at(at) / traced.column_at(at) < 3.0)

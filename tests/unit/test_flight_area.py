"""Lines over a polygon: all of it is seen, and nothing is flown in vain."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from survey.flight.area import AreaPlan
from survey.flight.plan import FlightPlan, unit_axes
from survey.flight.polygon import clipped, polygon_faults, signed_area
from survey.flight.profile import Profile, even_times
from survey.flight.trajectory import fly_lines, footprint
from survey.flight.turns import shortest_turn, turn_radius
from survey.sensor.camera import Camera

FloatArray = NDArray[np.float64]
CAMERA = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
FIELD = np.array([[0.0, 20.0], [60.0, 0.0], [560.0, 0.0], [620.0, 110.0], [600.0, 250.0]])
L_SHAPE = np.array([[0, 0], [900, 0], [900, 90], [200, 90], [200, 500], [0, 500.0]])
U_SHAPE = np.array([[0, 0], [300, 0], [300, 900], [200, 900], [200, 100], [100, 100], [100, 900]])


def area_plan(polygon: FloatArray = FIELD, **changes: Any) -> AreaPlan:
    plan = AreaPlan(
        polygon=np.asarray(polygon, dtype=float),
        heading=np.radians(65.0),
        height=200.0,
        water_level=0.5,
        speed=90.0,
        flash_rate=1.0,
        swath=51.2,
        view_length=102.4,
        sidelap=0.2,
        turn="alternate",
        turn_time=60.0,
    )
    return replace(plan, **changes)


def seen_share(plan: AreaPlan, *, step: float = 4.0) -> float:
    """Share of the places in the polygon that lie in some footprint."""
    from terrain.coverage import inside_any

    low, high = plan.polygon.min(axis=0), plan.polygon.max(axis=0)
    x, y = (np.arange(low[i] + 0.5 * step, high[i], step) for i in range(2))
    wanted = inside_any([plan.polygon], x, y)
    views = [footprint(CAMERA, frame.pose, plan.water_level) for frame in fly_lines(plan)]
    return float((wanted & inside_any(views, x, y)).sum() / wanted.sum())


@pytest.mark.parametrize("polygon", [FIELD, L_SHAPE, U_SHAPE])
@pytest.mark.parametrize("heading_deg", [0.0, 65.0, 90.0, 200.0])
def test_lines_see_all_of_the_polygon(polygon: FloatArray, heading_deg: float) -> None:
    assert seen_share(area_plan(polygon, heading=np.radians(heading_deg))) == 1.0


def test_no_more_lines_than_it_takes() -> None:
    plan = area_plan(np.array([[0, 0], [0, 500], [256, 500], [256, 0.0]]), heading=0.0)
    assert plan.line_count == 6
    wider = area_plan(np.array([[0, 0], [0, 500], [256.1, 500], [256.1, 0]]), heading=0.0)
    assert wider.line_count == 7


def test_lines_go_to_and_fro_and_cross_lines_come_last() -> None:
    plan = area_plan(cross_lines=2)
    courses = [round(float(np.degrees(line.course))) for line in plan.survey_lines]
    assert courses[:-2] == [65, 245] * 3 + [65] * ((len(courses) - 2) % 2)
    assert courses[-2:] == [155, 335]
    frames = fly_lines(plan)
    assert [frame.index for frame in frames] == list(range(plan.frame_count))
    assert np.all(np.diff([frame.time for frame in frames]) > 0.0)
    same = area_plan(turn="same", cross_lines=1)
    assert {round(float(np.degrees(line.course))) for line in same.survey_lines} == {65, 155}


def test_lines_step_to_the_right_and_cross_lines_lie_evenly_along() -> None:
    plan = area_plan(np.array([[0, 0], [0, 800], [250, 800], [250, 0.0]]), heading=0.0)
    plan = replace(plan, cross_lines=2)
    east = [line.places[0, 0] for line in plan.survey_lines[:-2]]
    assert np.diff(east) == pytest.approx(40.96)
    assert np.mean(east) == pytest.approx(125.0)
    assert [line.places[0, 1] for line in plan.survey_lines[-2:]] == pytest.approx([200.0, 600.0])


def test_no_flash_is_wasted_between_the_legs_of_a_u() -> None:
    plan = area_plan(U_SHAPE, heading=np.radians(90.0), sidelap=0.0)
    across = plan.survey_lines[2]
    assert plan.origin[0] == pytest.approx(0.0)
    assert len(across.along) == 3
    far = area_plan(U_SHAPE * [4.0, 1.0], heading=np.radians(90.0))
    middle = far.survey_lines[5]
    gaps = np.diff(middle.times)
    assert gaps.max() >= 2.0
    assert np.abs(np.diff(middle.along)) == pytest.approx(90.0 * gaps)


def test_a_small_area_takes_one_flash() -> None:
    plan = area_plan(np.array([[0, 0], [20, 0], [20, 20], [0, 20.0]]))
    (frame,) = fly_lines(plan)
    assert frame.pose.position == pytest.approx([10.0, 10.0, 200.5])


def test_flashes_far_apart_still_see_both_ends_of_short_lines() -> None:
    plan = area_plan(np.array([[0, 0], [0, 150], [40, 150], [40, 0.0]]), heading=0.0, speed=1000.0)
    assert [len(line.along) for line in plan.survey_lines] == [1]


@pytest.mark.parametrize(
    ("corners", "words"),
    [
        ([[0, 0], [90, 90], [90, 0], [0, 90]], "side 0-1 crosses side 2-3 near easting 45.0"),
        ([[0, 0], [90, 0], [90, 90], [40, 0], [0, 90]], "side 0-1 crosses side 2-3"),
        ([[0, 0], [90, 0]], "2 corners. Give 3 to 2000"),
        ([[0, 0], [90, 0], [90, 0], [0, 90]], "corner 2 is repeated"),
        ([[0, 0], [90, 0], [50, 0]], "less than 1 m2"),
        ([[0, 0], [90, float("nan")], [50, 50]], "corner 1 is not a finite place"),
    ],
)
def test_what_is_no_polygon_is_told(corners: list[list[float]], words: str) -> None:
    assert words in polygon_faults(np.array(corners, dtype=float))[0]


@pytest.mark.parametrize("polygon", [FIELD, L_SHAPE, U_SHAPE, FIELD[::-1]])
def test_sound_polygons_have_no_fault(polygon: FloatArray) -> None:
    assert polygon_faults(np.asarray(polygon, float) + np.array([5e5, 6e6])) == []


def test_all_crossings_are_told_at_once() -> None:
    star = np.array([[np.sin(4 * np.pi * k / 5), np.cos(4 * np.pi * k / 5)] for k in range(5)])
    assert len(polygon_faults(star * 100.0)) == 5


@given(
    st.lists(st.floats(-20.0, 20.0), min_size=2, max_size=2),
    st.lists(st.floats(0.5, 30.0), min_size=2, max_size=2),
)
def test_clipping_keeps_what_a_lattice_counts(corner: list[float], size: list[float]) -> None:
    from terrain.coverage import inside_any

    low = np.array(corner)
    high = low + size
    shape = L_SHAPE / 50.0
    part = clipped(shape, low=low, high=high)
    step = 0.1
    x, y = (np.arange(low[i] + 0.5 * step, high[i], step) for i in range(2))
    counted = inside_any([shape], x, y).sum() * step**2
    assert abs(signed_area(part)) == pytest.approx(counted, abs=5.0 * step * np.sum(size))


def test_height_profile_holds_at_the_place_whichever_way_it_is_flown() -> None:
    climb = Profile(distances=(0.0, 500.0), values=(200.0, 250.0))
    plan = area_plan(np.array([[0, 0], [0, 600], [90, 600], [90, 0.0]]), heading=0.0)
    for frame in fly_lines(replace(plan, height_profile=climb, cross_lines=1)):
        north = frame.pose.position[1]
        assert frame.pose.position[2] == pytest.approx(200.5 + min(max(north, 0), 500) / 10)


def test_speed_profile_keeps_the_flash_rate_and_the_coverage() -> None:
    slower = Profile(distances=(0.0, 300.0), values=(90.0, 45.0))
    plan = area_plan(np.array([[0, 0], [0, 600], [90, 600], [90, 0.0]]), heading=0.0)
    plan = replace(plan, speed_profile=slower)
    assert seen_share(plan) == 1.0
    for line in plan.survey_lines:
        assert np.diff(line.times) == pytest.approx(1.0)
        steps = np.abs(np.diff(np.sort(line.along)))
        assert 44.999 < steps.min() < steps.max() < 90.0


def test_speed_profile_falls_as_the_exponential_that_it_is() -> None:
    places, times = even_times(
        Profile(distances=(0.0, 900.0), values=(100.0, 10.0)), start=0.0, end=850.0, rate=2.0
    )
    assert places == pytest.approx(1000.0 * (1.0 - np.exp(-0.1 * times)), abs=1e-2)


def test_lines_with_a_speed_profile_lie_abreast() -> None:
    plan = FlightPlan(
        start=(0.0, 0.0),
        heading=0.3,
        height=200.0,
        water_level=0.0,
        speed=100.0,
        flash_rate=1.0,
        frames_per_line=5,
        lines=2,
        swath=50.0,
        sidelap=0.0,
        turn="alternate",
        turn_time=60.0,
        speed_profile=Profile(distances=(0.0, 200.0), values=(50.0, 100.0)),
    )
    there, back = plan.survey_lines
    assert there.along == pytest.approx(back.along[::-1])
    assert there.along[:3] == pytest.approx(200.0 * np.expm1(0.25 * np.arange(3)), abs=1e-2)


RADIUS = 500.0


@pytest.mark.parametrize("spacing", [1000.0, 1400.0, 3000.0])
def test_wide_turns_are_two_quarters_and_a_straight(spacing: float) -> None:
    length = shortest_turn(start=(0.0, 0.0, 0.0), end=(spacing, 0.0, np.pi), radius=RADIUS)
    assert length == pytest.approx(np.pi * RADIUS + spacing - 2.0 * RADIUS)


@pytest.mark.parametrize("spacing", [40.0, 400.0, 900.0])
def test_narrow_turns_first_lead_away(spacing: float) -> None:
    length = shortest_turn(start=(0.0, 0.0, 0.0), end=(spacing, 0.0, np.pi), radius=RADIUS)
    away = np.arccos((spacing + 2.0 * RADIUS) / (4.0 * RADIUS))
    assert length == pytest.approx(RADIUS * (np.pi + 4.0 * away))


@given(st.floats(-3e3, 3e3), st.floats(-3e3, 3e3), st.floats(0.0, 6.28), st.floats(0.0, 6.28))
def test_a_turn_is_as_long_flown_back_or_seen_in_a_mirror(
    east: float, north: float, course: float, end_course: float
) -> None:
    length = shortest_turn(start=(0.0, 0.0, course), end=(east, north, end_course), radius=RADIUS)
    back = shortest_turn(
        start=(east, north, end_course + np.pi), end=(0.0, 0.0, course + np.pi), radius=RADIUS
    )
    mirror = shortest_turn(
        start=(0.0, 0.0, -course), end=(-east, north, -end_course), radius=RADIUS
    )
    assert length >= np.hypot(east, north) - 1e-6
    if length > 1e-3:
        assert back == pytest.approx(length, abs=1e-5)
        assert mirror == pytest.approx(length, abs=1e-5)


def test_banked_turns_take_the_time_of_their_way() -> None:
    plan = area_plan(turn_bank=np.radians(25.0))
    frames = fly_lines(plan)
    first, second = plan.survey_lines[:2]
    radius = turn_radius(speed=90.0, bank=np.radians(25.0))
    assert radius == pytest.approx(90.0**2 / (9.80665 * np.tan(np.radians(25.0))))
    length = shortest_turn(
        start=(*first.places[-1], first.course),
        end=(*second.places[0], second.course),
        radius=radius,
    )
    last = len(first.along) - 1
    assert frames[last + 1].time - frames[last].time == pytest.approx(length / 90.0)


def test_profiles_count_from_where_the_polygon_begins() -> None:
    plan = area_plan(FIELD + np.array([3000.0, -800.0]))
    ahead, right = unit_axes(plan.heading)
    field = plan.polygon - np.array(plan.origin)
    assert (field @ ahead).min() == pytest.approx(0.0, abs=1e-9)
    assert (field @ right).min() == pytest.approx(0.0, abs=1e-9)

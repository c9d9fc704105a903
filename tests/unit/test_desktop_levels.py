"""Levels of detail, the pace of drawing, and which point a click hits."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.desktop.levels import LeveledPlaces, Pace, coarse_to_fine
from viewer.desktop.orbit import Orbit
from viewer.desktop.pick import nearest
from viewer.desktop.point_layer import together


def places(n: int = 40_000) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Return places of which nine tenths crowd into one corner."""
    lot = np.random.default_rng(3)
    crowd = lot.uniform(0.0, 50.0, (9 * n // 10, 3))
    return np.vstack([crowd, lot.uniform(0.0, 512.0, (n // 10, 3))])


def test_order_holds_every_place_once_and_is_the_same_again() -> None:
    order = coarse_to_fine(places())
    assert np.array_equal(np.sort(order), np.arange(40_000))
    assert np.array_equal(order, coarse_to_fine(places()))


@pytest.mark.parametrize("side", [8, 16])
def test_first_places_lie_one_in_every_cell(side: int) -> None:
    given = places()
    order = coarse_to_fine(given)
    low, extent = given[:, :2].min(axis=0), np.ptp(given[:, :2], axis=0).max()
    cell = np.minimum((given[:, :2] - low) / extent * side, side - 1).astype(int)
    code = side * cell[:, 0] + cell[:, 1]
    filled = len(np.unique(code))
    assert len(np.unique(code[order[:filled]])) == filled
    by_lot = np.random.default_rng(0).permutation(len(given))[:filled]
    assert len(np.unique(code[by_lot])) < 0.7 * filled


def test_few_and_equal_places_have_an_order() -> None:
    assert coarse_to_fine(np.zeros((0, 3))).tolist() == []
    assert sorted(coarse_to_fine(np.ones((5, 3))).tolist()) == list(range(5))


def test_first_wanted_are_taken_in_order() -> None:
    given = places(1000)
    leveled = LeveledPlaces.of(given, np.arange(1000, dtype=np.uint32), spacing=1.0)
    found = leveled.first(5, lambda part: leveled.frame[part] % 2 == 0)
    assert np.all(np.diff(found) > 0)
    assert np.all(leveled.order[found] % 2 == 0)
    wanted = np.flatnonzero(leveled.order % 2 == 0)
    assert np.array_equal(found, wanted[:5])
    assert leveled.spacing_of(250) == pytest.approx(2.0)


def test_a_thinned_cloud_keeps_its_numbers() -> None:
    given = places(1000)
    leveled = LeveledPlaces.of(given, np.zeros(1000, np.uint32), spacing=1.0, at_most=100)
    assert len(leveled) == 100
    np.testing.assert_allclose(leveled.place, given[leveled.order], rtol=1e-6)


def test_points_in_motion_show_the_whole_and_what_was_in_view() -> None:
    everywhere, in_view = np.arange(0, 50), np.arange(1, 1000, 3)
    found = together(everywhere, in_view, 100)
    assert len(found) == len(np.unique(found)) == 100
    assert set(everywhere) <= set(found)
    assert set(found) - set(everywhere) <= set(in_view)


def test_pace_finds_how_many_points_fit_the_time() -> None:
    pace = Pace(seconds=0.07, points=1_000_000, least=10_000)
    for _ in range(30):
        pace.told(pace.points, 0.01 + 5e-7 * pace.points)
    assert pace.points == pytest.approx(120_000, rel=0.02)


def test_pace_does_not_grow_by_pictures_of_few_points() -> None:
    pace = Pace(seconds=0.07, points=100_000, least=10_000)
    pace.told(500, 0.001)
    assert pace.points == 100_000
    for _ in range(9):
        pace.told(pace.points, 9.0)
    assert pace.points == 10_000


def test_a_click_hits_the_point_in_front() -> None:
    view = Orbit(centre=(0.0, 0.0, 0.0), azimuth=0.2, elevation=0.9, metres_per_pixel=0.5).view(
        (800, 600)
    )
    behind = np.array([3.0, 4.0, 0.0])
    given = np.vstack([behind, behind + 20.0 * view.towards, behind + 40.0 * view.right])
    at = view.pixels(behind)[0]
    assert nearest(given, view, (at[0], at[1])) == 1
    assert nearest(given[:1], view, (at[0] + 5.0, at[1])) == 0
    assert nearest(given[:1], view, (at[0] + 20.0, at[1])) is None
    assert nearest(np.zeros((0, 3)), view, (1.0, 1.0)) is None

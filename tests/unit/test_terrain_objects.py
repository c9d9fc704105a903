"""Bodies on the seabed: closed, outward, with overhangs, and standing where they were put."""

from __future__ import annotations

import numpy as np
import pytest

from terrain.generators import Ground, slope
from terrain.map_frame import MapFrame
from terrain.objects import boulder, cube, place, wreck
from terrain.raycast import build_grid, cast_rays
from terrain.seabed import Seabed

FRAME = MapFrame(easting=500000.0, northing=6000000.0, epsg=25832, vertical_epsg=5714)


def bottom() -> Seabed:
    ground = Ground(map_frame=FRAME, length=200.0, width=200.0, reflectance=0.1)
    return slope(ground=ground, depth=10.0, gradient=0.05)


def test_the_wreck_is_closed_and_faces_outwards() -> None:
    body = wreck()
    assert body.is_watertight
    assert body.is_winding_consistent
    assert body.body_count == 3
    assert all(part.volume > 0.0 for part in body.split())
    np.testing.assert_allclose(body.extents, [6.0, 30.0, 3.0])
    assert body.area_faces.min() > 0.0
    assert wreck(length=60.0, beam=9.0, height=5.0, edge=0.5).is_watertight


def test_under_the_deck_is_a_room_and_amidships_a_gap() -> None:
    grid = build_grid(wreck())
    over_deck, over_gap = np.array([0.01, 6.0, 10.0]), np.array([0.01, -0.6, 10.0])
    t, face = cast_rays(grid, np.array([over_deck, over_gap]), np.array([0.0, 0.0, -1.0]))
    np.testing.assert_allclose(10.0 - t, [2.25, 0.1], atol=0.01)
    assert (grid.normals[face, 2] > 0.9).all()
    inside = np.array([0.01, 6.0, 1.0])
    up_down, _ = cast_rays(grid, inside, np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]))
    assert up_down[0] == pytest.approx(2.15 - 1.0, abs=0.01)
    assert 0.7 < up_down[1] < 1.0


def test_the_deck_stays_within_the_hull() -> None:
    hull, *decks = sorted(wreck().split(), key=lambda part: -part.volume)
    for deck in decks:
        for vertex in deck.vertices[:: max(len(deck.vertices) // 50, 1)]:
            side = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
            t, _ = cast_rays(build_grid(hull), vertex, side)
            assert np.isfinite(t).all()
            assert t.min() > 0.005


def test_a_boulder_is_rough_closed_and_reproducible() -> None:
    rock = boulder(radius=1.5, relief=0.1, seed=4)
    assert rock.is_watertight
    radii = np.linalg.norm(rock.vertices, axis=1) / 1.5
    assert 0.03 < radii.std() < 0.2
    np.testing.assert_array_equal(rock.vertices, boulder(radius=1.5, relief=0.1, seed=4).vertices)
    assert (rock.vertices != boulder(radius=1.5, relief=0.1, seed=5).vertices).any()
    assert boulder(radius=2.0, relief=0.0, seed=1).volume == pytest.approx(33.51, rel=0.01)
    with pytest.raises(ValueError, match="relief"):
        boulder(radius=1.0, relief=0.5, seed=1)


def test_the_lowest_point_stands_on_the_bottom_or_under_it() -> None:
    seabed = bottom()
    for burial in (0.0, 0.4):
        body = place(wreck(), seabed=seabed, east=20.0, north=-30.0, heading=1.0, burial=burial)
        lowest = body.vertices[body.vertices[:, 2].argmin()]
        ground = seabed.elevation_at(lowest[0], lowest[1])
        assert lowest[2] == pytest.approx(float(ground) - burial, abs=1e-9)
    assert seabed.elevation_at(20.0, -30.0) == pytest.approx(-8.5)


def test_heading_list_and_trim_turn_the_way_they_say() -> None:
    seabed = bottom()
    east_going = place(wreck(), seabed=seabed, east=0.0, north=0.0, heading=np.pi / 2)
    np.testing.assert_allclose(east_going.extents[:2], [30.0, 6.0], atol=1e-6)
    box = cube(side=2.0)
    starboard, bow = np.argmax(box.vertices @ [1, 0, 1]), np.argmax(box.vertices @ [0, 1, 1])
    level = place(box, seabed=seabed, east=0.0, north=0.0)
    listing = place(box, seabed=seabed, east=0.0, north=0.0, list_angle=0.2)
    middle = listing.vertices[:, 2].mean() - level.vertices[:, 2].mean()
    assert listing.vertices[starboard, 2] - middle < level.vertices[starboard, 2]
    trimmed = place(box, seabed=seabed, east=0.0, north=0.0, trim_angle=0.2)
    middle = trimmed.vertices[:, 2].mean() - level.vertices[:, 2].mean()
    assert trimmed.vertices[bow, 2] - middle > level.vertices[bow, 2]
    turned = place(box, seabed=seabed, east=0.0, north=0.0, heading=0.3)
    assert (turned.vertices[bow] - turned.centroid) @ [np.sin(0.3), np.cos(0.3), 0] == (
        pytest.approx(1.0)
    )


def test_a_body_off_the_seabed_is_refused() -> None:
    with pytest.raises(ValueError, match="no seabed at east"):
        place(cube(side=1.0), seabed=bottom(), east=500.0, north=0.0)

"""What a sensor sees through water, and what the ground hides."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import trimesh

from survey.cloud.sight import entry_points, is_hidden
from survey.products.cells import CellGrid
from survey.products.coverage import GAP, OUTSIDE_AREA, SHADOW, CoverageMap
from survey.products.shadows import with_shadows
from survey.sensor.camera import Camera

SENSOR = np.array([0.0, 0.0, 100.0])
WATER = {"level": 0.0, "refractive_index": 1.34}


def test_light_takes_the_quickest_way() -> None:
    """Fermat: no other entry makes the optical path shorter."""
    places = np.array([[30.0, -20.0, -7.0], [0.0, 0.0, -3.0], [2.0, 40.0, -25.0]])
    entry = entry_points(places, sensor=SENSOR, **WATER)

    def way(at: Any) -> Any:
        below = 1.34 * np.linalg.norm(places - at, axis=1)
        return np.linalg.norm(at - SENSOR, axis=1) + below

    for step in ([0.01, 0.0, 0.0], [-0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, -0.01, 0.0]):
        assert np.all(way(entry + step) > way(entry))
    dry = np.array([[5.0, 5.0, 2.0]])
    assert np.array_equal(entry_points(dry, sensor=SENSOR, **WATER), dry)


@pytest.fixture(scope="module")
def walled(look_at: Any) -> Any:
    """A bed 10 m deep with a wall 6 m high, 20 m east of the sensor."""
    bed = look_at(depth=10.0, gradient=0.0).seabed
    wall = trimesh.creation.box(extents=[1.0, 60.0, 6.0])
    wall.apply_translation([20.0, 0.0, -7.0])
    return bed.with_object(wall, reflectance=0.1, source="a wall")


def test_a_wall_hides_what_lies_right_behind_it(walled: Any) -> None:
    """Its top edge is 4 m deep at x = 20.5; the ray that grazes it meets the bed further out."""
    edge = np.array([[20.5, 0.0, -4.0]])
    entry = entry_points(edge, sensor=SENSOR, **WATER)
    slope = (edge - entry)[0, 0] / 4.0
    end = 20.5 + 6.0 * slope
    x = np.array([10.0, 20.6, end - 0.05, end + 0.05, 30.0])
    places = np.column_stack([x, np.zeros(5), np.full(5, -10.0)])
    hidden = is_hidden(places, sensor=SENSOR, seabed=walled, **WATER)
    assert hidden.tolist() == [False, True, True, False, False]


def test_gaps_behind_the_wall_are_shadows_and_others_are_not(walled: Any, look_at: Any) -> None:
    camera = Camera(rows=32, columns=64, pixel_tangent=0.016, long_side="along")
    look = look_at()
    pose = replace(look.frame.pose, position=SENSOR, heading=0.0)
    origin = walled.map_frame.origin
    cells = CellGrid.covering(np.array([[-60.0, -0.4], [59.9, 0.4]]) + origin[:2], cell_size=0.5)
    state = np.full(cells.shape, GAP, np.int16)
    state[:, 0] = OUTSIDE_AREA
    found = with_shadows(
        CoverageMap(cells=cells, state=state),
        frames=[replace(look.frame, pose=pose)],
        camera=camera,
        seabed=walled,
        **WATER,
    )
    x = (cells.centres() - origin[:2])[..., 0]
    shadows = np.unique(x[found.state == SHADOW])
    assert shadows.min() > 20.5
    assert 0.5 <= np.ptp(shadows) < 1.5
    assert np.all(found.state[:, 0] == OUTSIDE_AREA)
    assert found.cause(SHADOW) == "shadow"
    assert not (found.state[x > 30.0] == SHADOW).any()

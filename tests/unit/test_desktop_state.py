"""What keys do to the state of the view, without a window."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.desktop.keys import ACTIONS, KEYS, Command, action_of, help_text
from viewer.desktop.orbit import Orbit
from viewer.desktop.state import Layer, Pick, Reach, ViewState

HOME = Orbit(centre=(10.0, 20.0, -5.0), azimuth=0.3, elevation=0.5, metres_per_pixel=0.5)


def state(**changes: object) -> ViewState:
    """Return a view of 30 frames."""
    given = {"home": HOME, "orbit": HOME, "frames": 30, "exaggeration": 4.0, "frame": 10}
    return ViewState(**(given | changes))  # type: ignore[arg-type]


def after(keys: str, start: ViewState | None = None) -> ViewState:
    """Return the state after some keys."""
    found = start or state()
    for key in keys.split():
        name = key.removeprefix("Shift+")
        action = action_of(name, shift=name != key)
        assert callable(action), key
        found = action(found)
    return found


def picked(*place: float, flash: int = 3) -> Pick:
    """Return a point of the bottom."""
    x, y, z = place
    return Pick(layer=Layer.BOTTOM, index=7, place=(x, y, z), flash=flash)


def test_every_digit_colours_by_another_attribute() -> None:
    names = [after(digit).attribute for digit in [*"1234567890o"]]
    assert names[0] == "depth"
    assert len(set(names)) == 11


def test_frames_step_and_stop_at_the_ends() -> None:
    assert after("bracketright").frame == 11
    assert after("braceleft bracketleft bracketleft").frame == 0
    assert after("braceright braceright braceright").frame == 29


def test_flight_plays_to_the_last_frame_and_starts_over() -> None:
    flying = after("space", state(frame=27))
    assert (flying.playing, flying.reach) == (True, Reach.SO_FAR)
    flying = flying.flown_on()
    assert (flying.frame, flying.playing) == (28, True)
    flying = flying.flown_on()
    assert (flying.frame, flying.playing) == (29, False)
    again = after("space", flying)
    assert (again.frame, again.playing) == (0, True)
    assert not after("space", again).playing


def test_heights_are_multiplied_by_the_next_round_factor() -> None:
    assert after("H").exaggeration == 5.0
    assert after("h h h h h h").exaggeration == 1.0


def test_layers_are_switched_one_by_one() -> None:
    found = after("m s u k b")
    assert {Layer.MESH, Layer.SEABED, Layer.OTHER, Layer.FOOTPRINTS} <= found.layers
    assert Layer.BOTTOM not in found.layers
    assert after("m s u k b", found).layers == state().layers


def test_frames_shown_go_round() -> None:
    assert [after("f " * count).reach for count in (1, 2, 3)] == [
        Reach.SO_FAR,
        Reach.ONE,
        Reach.ALL,
    ]


def test_a_click_picks_a_point_and_goes_to_its_flash() -> None:
    found = state().clicked(picked(1.0, 2.0, -3.0))
    assert found.picked is not None
    assert (found.frame, found.picked.index) == (3, 7)
    assert after("Escape", found).picked is None


def test_two_clicks_end_a_profile() -> None:
    begun = after("d")
    assert begun.measuring
    one = begun.clicked(picked(0.0, 0.0, -3.0))
    two = one.clicked(picked(9.0, 0.0, -4.0))
    assert (one.measuring, len(one.ends)) == (True, 1)
    assert (two.measuring, two.ends) == (False, ((0.0, 0.0, -3.0), (9.0, 0.0, -4.0)))
    assert two.picked is None
    assert two.clicked(picked(1.0, 1.0, 1.0)).ends == ()


def test_view_turns_moves_and_returns() -> None:
    turned = after("Right Up Up Shift+Left plus")
    assert turned.orbit.azimuth == pytest.approx(0.3 + np.radians(5.0))
    assert turned.orbit.elevation == pytest.approx(0.5 + np.radians(10.0))
    assert turned.orbit.metres_per_pixel == pytest.approx(0.5 / 1.2)
    assert turned.orbit.centre != HOME.centre
    assert after("r", turned).orbit == HOME


def test_from_above_north_is_up() -> None:
    view = after("t").orbit.view((800, 600))
    np.testing.assert_allclose(view.right, [1.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(view.up, [0.0, 1.0, 0.0], atol=0.01)


def test_what_is_moved_by_pixels_is_seen_so_many_pixels_further() -> None:
    place = np.array([[12.0, 25.0, -6.0]])
    before = HOME.view((800, 600)).pixels(place)
    moved = HOME.moved(30.0, -12.0).view((800, 600)).pixels(place)
    np.testing.assert_allclose(moved - before, [[30.0, -12.0]])


def test_help_lists_every_key_once() -> None:
    names = [name for key in KEYS for name in key.actions]
    assert len(names) == len(set(names)) == len(ACTIONS)
    assert len(help_text().splitlines()) == len(KEYS)
    assert {action for action in ACTIONS.values() if isinstance(action, Command)} == set(Command)

"""The window without a display: keys, clicks and the scene that they make."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from survey.cloud.points import Outcome, PointClass
from survey.errors import UserError
from terrain.seabed import Seabed, uniform_seabed
from viewer import rendering
from viewer.attributes import depth_attribute, outcome_attribute
from viewer.desktop.colouring import painted
from viewer.desktop.content import Content
from viewer.desktop.flight_path import moments
from viewer.desktop.movie_files import format_of, write_gif
from viewer.desktop.profile import profile
from viewer.desktop.state import Layer, Reach
from viewer.desktop.window import Window
from viewer.run_folder import FlownSurvey
from viewer.scene import stretched

SIZE = (640, 400)


def flat_seabed(survey: Any) -> Seabed:
    """Return a level seabed 5 m below zero under a survey."""
    low, high = (survey.bottom.position[:, :2].min(0) - 50.0, survey.bottom.position.max(0) + 50.0)
    corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
    mesh = trimesh.Trimesh([[x, y, -5.0] for x, y in corners], [[0, 1, 2], [0, 2, 3]])
    return uniform_seabed(mesh, reflectance=0.2, map_frame=survey.map_frame, source="level")


@pytest.fixture(scope="module")
def content(small_survey: Any) -> Content:
    """A survey of four lines as the window takes it."""
    frames = small_survey.frames
    flown = FlownSurvey(
        title="A bar",
        description="",
        water_level=0.25,
        bottom=small_survey.bottom,
        surface=small_survey.surface,
        positions=np.array([frame.pose.position for frame in frames]),
        headings=np.array([frame.pose.heading for frame in frames]),
        frame=np.array([frame.index for frame in frames]),
        line=np.array([frame.line for frame in frames]),
        map_frame=small_survey.map_frame,
    )
    return Content.of(flown, seabed=flat_seabed(small_survey))


@pytest.fixture(scope="module")
def opened(content: Content, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Window]:
    """A window that nobody sees."""
    rendering.require_rendering()
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=list(SIZE))
    made = Window(plotter, content, pictures=tmp_path_factory.mktemp("pictures"))
    plotter.show(auto_close=False, interactive=False)
    yield made
    made.charts.close()
    plotter.close()


@pytest.fixture
def window(opened: Window, content: Content) -> Window:
    """The window as it opens."""
    opened.become(content.first_state(SIZE))
    return opened


def picture(window: Window) -> np.ndarray[Any, Any]:
    """Return what the window shows."""
    return np.asarray(window.plotter.screenshot(return_img=True)).astype(int)


def place_of(window: Window, index: int) -> tuple[float, float]:
    """Return where a point of the bottom is drawn [pixels]."""
    place = window.content.bottom.position[[index]]
    drawn = stretched(place, water_level=0.25, exaggeration=window.state.exaggeration)
    x, y = window.state.orbit.view(SIZE).pixels(drawn)[0]
    return float(x), float(y)


def test_window_shows_depths_flight_and_legend(window: Window) -> None:
    seen = picture(window).reshape(-1, 3)
    for colour in ((196, 80, 12), (33, 144, 140), (253, 231, 37)):
        assert np.mean(np.abs(seen - colour).max(axis=1) < 30) > 5e-4, colour


def test_attribute_key_changes_colours_alone(window: Window) -> None:
    before = picture(window)
    window.key("2")
    assert window.state.attribute == "error"
    changed = np.any(picture(window) != before, axis=2)
    assert 0.01 < changed.mean() < 0.6
    window.key("1")
    assert np.array_equal(picture(window), before)


def test_a_drag_turns_the_view_with_few_points_and_rest_brings_all(window: Window) -> None:
    window.stage.paces["moving"].points = 500
    window.become(replace(window.state, exaggeration=3.0))
    window.drag(40.0, 0.0, move=False)
    moving = window.stage.layers[Layer.BOTTOM].drawn
    window._moved_at = -1e9
    window.tick()
    resting = window.stage.layers[Layer.BOTTOM].drawn
    assert moving <= 500
    assert resting == len(window.content.bottom)


def test_slow_pictures_thin_the_points_while_it_still_moves(window: Window) -> None:
    window.stage.paces["moving"].points = 4000
    window.become(replace(window.state, exaggeration=5.0))
    window.drag(10.0, 0.0, move=False)
    before = window.stage.layers[Layer.BOTTOM].drawn
    window.stage.paces["moving"].points = 600
    window.drag(10.0, 0.0, move=False)
    assert before > 2000
    assert window.stage.layers[Layer.BOTTOM].drawn <= 600


def test_interactor_events_turn_zoom_and_pick(window: Window) -> None:
    interactor: Any = window.plotter.iren.interactor  # type: ignore[union-attr]
    start = window.state.orbit
    interactor.SetEventInformation(300, 200, 0, 0, "\0", 0, None)
    interactor.LeftButtonPressEvent()
    interactor.SetEventInformation(340, 200, 0, 0, "\0", 0, None)
    interactor.MouseMoveEvent()
    interactor.LeftButtonReleaseEvent()
    assert window.state.orbit.azimuth < start.azimuth
    assert window.state.picked is None
    interactor.MouseWheelForwardEvent()
    assert window.state.orbit.metres_per_pixel < start.metres_per_pixel
    interactor.SetEventInformation(0, 0, 0, 0, "\0", 0, "m")
    interactor.KeyPressEvent()
    assert Layer.MESH in window.state.layers


def test_a_click_picks_the_point_and_goes_to_its_frame(window: Window) -> None:
    window.key("t")
    window.key("w")
    window.become(window.state)
    index = int(np.flatnonzero(window.content.bottom.frame == 9)[7])
    window.click(place_of(window, index))
    pick = window.state.picked
    assert pick is not None
    off = np.array(pick.place[:2]) - window.content.bottom.position[index, :2]
    assert np.hypot(*off) < 20.0
    number = window.content.flashes.frame[window.state.frame]
    assert number == window.content.bottom.frame[pick.index]
    window.key("Escape")
    assert window.state.picked is None


def test_only_points_of_the_frames_wanted_are_drawn(window: Window) -> None:
    window.become(replace(window.state, reach=Reach.ONE, frame=5))
    layer = window.stage.layers[Layer.BOTTOM]
    assert set(layer.places.frame[layer.resting]) == {window.content.flashes.frame[5]}
    window.become(replace(window.state, reach=Reach.SO_FAR))
    assert layer.places.frame[layer.resting].max() == window.content.flashes.frame[5]


def test_flight_goes_on_by_ticks(window: Window) -> None:
    window.become(replace(window.state, frame=28))
    window.key("space")
    for _ in range(5):
        window.tick()
    assert (window.state.frame, window.state.playing) == (31, False)
    assert window.slider._slider.GetRepresentation().GetValue() == 31


def test_every_layer_and_picture_key(window: Window) -> None:
    for key in ("m", "s", "u", "k", "question"):
        window.key(key)
    shown = {layer for layer in Layer if layer in window.state.layers}
    assert shown == set(Layer)
    path = window.save_picture()
    assert path.name == "bathyflash-1.png"
    assert window.save_picture().name == "bathyflash-2.png"


def test_outcomes_without_frames_are_a_notice_not_a_crash(window: Window) -> None:
    window.key("o")
    assert window.state.attribute == "depth"


def test_profile_takes_points_beside_the_line_and_the_true_seabed(content: Content) -> None:
    places = content.bottom.position
    ends = (tuple(places[100]), tuple(places[3000]))
    found = profile(content.bottom, ends, spacing=2.0, seabed=content.seabed)
    length = np.hypot(*(places[3000] - places[100])[:2])
    assert 0.0 <= found.along.min() <= found.along.max() <= length
    assert {100, 3000} <= set(found.number)
    np.testing.assert_allclose(found.true_elevation, -5.0)
    np.testing.assert_array_equal(found.elevation, places[found.number, 2])


def test_colours_of_depth_land_and_outcomes() -> None:
    attribute = depth_attribute(np.array([-1.0, 0.5, 8.0]))
    shown = painted(attribute, np.array([0.0, 8.0, -1.0, np.nan]))
    assert shown.tolist()[1:] == [[68, 1, 84], [196, 178, 142], [154, 160, 166]]
    codes = np.array([Outcome.FOUND, Outcome.TOO_DEEP], dtype=np.uint8)
    assert painted(outcome_attribute(codes), codes).tolist() == [[0, 114, 178], [86, 180, 233]]


def test_movie_flies_every_flash_with_the_footprint_under_the_aircraft(content: Content) -> None:
    path = moments(
        content.flashes,
        water_level=0.25,
        exaggeration=2.0,
        height=450,
        rate=10.0,
        shortest=8.0,
        longest=60.0,
    )
    assert [each.place for each in path] == sorted(each.place for each in path)
    assert {each.place for each in path} == set(range(32))
    for each in path[::40]:
        middle = each.flash.corners.mean(axis=0)
        assert np.hypot(*(middle - each.flash.position)[:2]) < 60.0
        pixel = each.orbit.view((800, 450)).pixels(each.flash.position)[0]
        assert np.all((pixel > 0.0) & (pixel < [800.0, 450.0]))


def test_a_gif_holds_every_picture(tmp_path: Path) -> None:
    from PIL import Image

    shades = [np.full((4, 6, 3), shade, dtype=np.uint8) for shade in (10, 90, 200)]
    write_gif(tmp_path / "a.gif", iter(shades), 10.0)
    with Image.open(tmp_path / "a.gif") as made:
        assert (made.n_frames, made.size) == (3, (6, 4))


def test_a_movie_that_cannot_be_written_says_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UserError, match=r"apt-get install -y ffmpeg\. Or name a file that ends"):
        format_of(tmp_path / "a.mp4")
    with pytest.raises(UserError, match=r"no folder .*Make it first"):
        format_of(tmp_path / "none" / "a.gif")


@pytest.mark.parametrize("display", [None, ":4242"])
def test_without_a_display_the_other_ways_are_named(
    monkeypatch: pytest.MonkeyPatch, display: str | None
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    if display:
        monkeypatch.setenv("DISPLAY", display)
    with pytest.raises(UserError, match=r"no display .*--screenshot .*--web .*--movie"):
        rendering.require_display()


def test_pixels_without_a_bottom_are_a_cloud_of_their_own(content: Content) -> None:
    kinds = content.clouds[Layer.OTHER].classification
    assert np.all(kinds == PointClass.NO_BOTTOM_FOUND)

"""The page in a real browser: it draws, tells, answers keys, and asks the network for nothing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

READY_MS = 60_000
BACKGROUND = (243, 246, 248)


@dataclass
class Opened:
    """A page with all that it said and asked for."""

    page: Any
    said: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)


@pytest.fixture(scope="module")
def opened(browser: Any, page_file: Path) -> Iterator[Opened]:
    page = browser.new_page(viewport={"width": 900, "height": 600})
    found = Opened(page)
    page.on("console", lambda message: found.said.append(message.text))
    page.on("pageerror", lambda error: found.said.append(str(error)))
    page.on("request", lambda request: found.asked.append(request.url))
    page.goto(page_file.as_uri())
    page.wait_for_selector("body[data-ready]", timeout=READY_MS)
    settle(page)
    yield found
    page.close()


@pytest.fixture
def page(opened: Opened) -> Any:
    """The page as it is after its opening: one frame for all, nothing picked."""
    opened.page.keyboard.press("Escape")
    opened.page.evaluate("document.activeElement.blur()")
    opened.page.keyboard.press("r")
    opened.page.keyboard.press("1")
    settle(opened.page)
    return opened.page


def settle(page: Any) -> None:
    """Wait for two pictures of the browser."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def picture(page: Any) -> np.ndarray[Any, Any]:
    """Return what stands on the canvas (height, width, 3)."""
    settle(page)
    return decoded(page.locator("#canvas").screenshot())


def decoded(png: bytes) -> np.ndarray[Any, Any]:
    from io import BytesIO

    from matplotlib.image import imread

    return np.round(imread(BytesIO(png), format="png")[..., :3] * 255).astype(int)


def drawn(image: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return a mask of the pixels that are not background."""
    return np.abs(image - np.array(BACKGROUND)).max(axis=2) > 8


def near(image: np.ndarray[Any, Any], colour: tuple[int, int, int], by: int = 12) -> int:
    return int((np.abs(image - np.array(colour)).max(axis=2) <= by).sum())


def test_points_land_and_flight_are_drawn_in_their_colours(page: Any) -> None:
    page.uncheck("#show-marks")
    image = picture(page)
    page.check("#show-marks")
    assert 0.02 < drawn(image).mean() < 0.6
    assert near(image, (196, 178, 142)) > 200
    assert near(image, (33, 145, 140), 25) > 200
    assert near(image, (68, 1, 84), 30) > 200
    assert near(image, (196, 80, 12), 40) > 30


def test_a_click_tells_the_point_and_shows_a_waveform(page: Any) -> None:
    image = picture(page)
    rows, columns = np.nonzero(np.abs(image - np.array((33, 145, 140))).max(axis=2) < 30)
    middle = len(rows) // 2
    page.mouse.click(*at_canvas(page, float(columns[middle]), float(rows[middle])))
    assert "Depth below the water level:" in page.inner_text("#picked")
    assert page.is_visible("#waveform")
    title, told = page.inner_text("#waveform-title"), page.inner_text("#picked").split("\n")[0]
    assert title.endswith(": found")
    if not title.startswith("Marked pixel"):
        assert told.removeprefix("Point of frame ") == title.removeprefix("Frame ")[:-7]
    assert page.locator("#plots polyline").count() == 8
    points = page.locator("#plots polyline").first.get_attribute("points")
    heights = {round(float(point.split(",")[1])) for point in points.split()}
    assert len(heights) > 10
    assert "true depth" in page.inner_text("#numbers")


def at_canvas(page: Any, x: float, y: float) -> tuple[float, float]:
    box = page.locator("#canvas").bounding_box()
    return box["x"] + x, box["y"] + y


def test_picked_numbers_are_those_of_the_run(page: Any, flown: Any) -> None:
    page.keyboard.press("t")
    page.keyboard.press("Enter")
    words = page.inner_text("#picked")
    frame, row, column = (int(w.strip(",")) for w in words.split("\n")[0].split()[3::2])
    cloud = flown.bottom
    at = (cloud.frame == frame) & (cloud.row == row) & (cloud.column == column)
    x, y, z = cloud.position[at][0]
    told = {
        name: float(value.split()[0])
        for name, value in (line.split(": ", 1) for line in words.split("\n")[2:])
        if value.endswith(" m")
    }
    place = words.split("\n")[1].replace(",", "").split()
    assert float(place[1]) == pytest.approx(500000.0 + x, abs=0.02)
    assert float(place[4]) == pytest.approx(6.0e6 + y, abs=0.02)
    assert float(place[7]) == pytest.approx(z, abs=0.003)
    assert told["Depth below the water level"] == pytest.approx(0.25 - z, abs=0.003)
    error = z - cloud.true_elevation[at][0]
    assert told["Error, measured less true elevation"] == pytest.approx(error, abs=0.003)
    assert told["Vertical uncertainty, 95 % (TVU)"] == pytest.approx(cloud.tvu[at][0], abs=0.003)


LEGENDS = {
    "1": "Depth below the water level [m]",
    "2": "Error, measured less true elevation [m]",
    "3": "Vertical uncertainty, 95 % (TVU) [m]",
    "4": "Horizontal uncertainty, 95 % (THU) [m]",
    "5": "Signal-to-noise ratio of the echo",
    "6": "Class (LAS)",
    "7": "What moved the point most",
    "8": "What the bottom is made of",
    "9": "Frame, in the order of flight",
    "0": "Survey line",
}


def test_keys_colour_by_every_attribute(page: Any) -> None:
    shown = {}
    for key in LEGENDS:
        page.keyboard.press(key)
        shown[key] = page.inner_text("#legend h3")
    assert shown == LEGENDS


def test_categories_have_their_colours_and_counts(page: Any) -> None:
    page.keyboard.press("8")
    assert "sand" in page.inner_text("#legend")
    image = picture(page)
    assert near(image, (0, 114, 178)) > 200
    assert near(image, (230, 159, 0)) > 200


def test_arrows_turn_and_signs_zoom(page: Any) -> None:
    before = picture(page)
    page.keyboard.press("ArrowLeft")
    turned = picture(page)
    assert (np.abs(turned - before).max(axis=2) > 8).mean() > 0.01
    page.keyboard.press("ArrowRight")
    page.uncheck("#show-flight")
    plain = drawn(picture(page)).sum()
    page.keyboard.press("-")
    page.keyboard.press("-")
    assert drawn(picture(page)).sum() < 0.8 * plain
    page.check("#show-flight")


def test_frames_step_back_and_points_go(page: Any) -> None:
    whole = drawn(picture(page)).sum()
    for _ in range(3):
        page.keyboard.press("[")
    assert page.inner_text("#frame-told") == "3 of 6"
    assert page.inner_text("#frame-words") == "Frame 2, line 0"
    assert drawn(picture(page)).sum() < 0.8 * whole
    for _ in range(3):
        page.keyboard.press("]")
    assert page.inner_text("#frame-told") == "6 of 6"


def test_waveforms_are_reached_without_a_mouse(page: Any) -> None:
    page.keyboard.press("n")
    first = page.inner_text("#waveform-title")
    page.keyboard.press("n")
    assert page.inner_text("#waveform-title") != first
    page.keyboard.press("p")
    assert page.inner_text("#waveform-title") == first
    page.keyboard.press("Escape")
    assert not page.is_visible("#waveform")


def test_every_control_has_a_name_and_the_focus_is_seen(page: Any) -> None:
    nameless = page.evaluate(
        "[...document.querySelectorAll('input, select, button')].filter((control) => "
        "!control.labels?.length && !control.textContent.trim() && !control.ariaLabel)"
        ".map((control) => control.id)"
    )
    assert nameless == []
    page.keyboard.press("Tab")
    assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"


def test_the_page_says_what_it_is_and_what_it_left_out(page: Any) -> None:
    assert page.inner_text("h1") == "A <made> slope"
    assert "Simulated" in page.inner_text(".simulated")
    left_out = page.inner_text("#left-out")
    assert "All 1,641 points of bottom" in left_out
    assert "rounded to 2 cm" in left_out
    assert "The true seabed is not here." in left_out
    overlay = page.text_content("#overlay")
    assert "m across the page" in overlay
    assert overlay.endswith("N")


def test_nothing_was_asked_for_and_nothing_went_wrong(opened: Opened, page_file: Path) -> None:
    opened.page.evaluate("fetch('https://example.org/').catch(() => 0)")
    asked = [url for url in opened.asked if not url.startswith(("data:", "blob:"))]
    assert asked == [page_file.as_uri()]
    assert [words for words in opened.said if "Content Security Policy" not in words] == []


def test_without_webgl_the_page_says_so(browser: Any, page_file: Path) -> None:
    page = browser.new_page()
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(page_file.as_uri())
    page.wait_for_function("document.getElementById('message').textContent.includes('WebGL')")
    page.close()


def test_a_page_without_waveforms_opens(
    browser: Any, contents: dict[str, Any], tmp_path: Path
) -> None:
    from viewer.web.page import html

    file = tmp_path / "plain.html"
    file.write_text(html({**contents, "waveforms": None}), encoding="utf-8")
    page = browser.new_page()
    said: list[str] = []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(file.as_uri())
    page.wait_for_selector("body[data-ready]", timeout=READY_MS)
    page.keyboard.press("Enter")
    assert page.is_visible("#picked")
    assert page.is_disabled("#next-mark")
    assert said == []
    page.close()

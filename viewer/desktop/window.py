"""`bathyflash view RUN`: the window. Events make a new state, the stage shows it."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from survey.products.writing import write_whole
from survey.progress import Watcher
from viewer.desktop.content import Content, read_content
from viewer.desktop.flight_slider import FlightSlider
from viewer.desktop.keys import ZOOM, Command, action_of, help_text
from viewer.desktop.overlay import FONT_SIZES, GAP, Words
from viewer.desktop.profile import draw_profile, profile
from viewer.desktop.stage import Stage
from viewer.desktop.state import Layer, ViewState
from viewer.desktop.waveform_chart import WaveformCharts
from viewer.desktop.words import address_of
from viewer.rendering import require_display, require_rendering

if TYPE_CHECKING:
    import pyvista

SIZE = (1280, 720)
TICK_MS = 100
REST_AFTER_S = 0.35
TURN_PER_PIXEL = 0.006
STILL = 4.0
"""A press and release within so many pixels is a click."""

HINT = "? lists the keys"
FLYING = "The frame is flown again for its waveform; the first takes longest ..."


def open_window(run: Path, *, watch: Watcher) -> None:
    """Show a finished run in a window until it is closed.

    Parameters
    ----------
    run : Path
        Run folder.
    watch : Watcher
        Told of what cannot be shown.

    Raises
    ------
    FileNotFoundError
        If the folder or a product that is drawn is missing.
    UserError
        If there is no display, or nothing to show.
    RuntimeError
        If this machine cannot render.
    """
    require_display()
    content = read_content(run)
    require_rendering()
    for sentence in content.missing:
        watch.noticed(sentence)
    import pyvista

    title = f"{content.flown.title} - bathyflash"
    plotter = pyvista.Plotter(window_size=list(SIZE), title=title, off_screen=False)
    window = Window(plotter, content, pictures=Path.cwd())
    try:
        window.open()
    finally:
        window.charts.close()


class Window:
    """A plotter whose keys and mouse change the state of the view.

    Parameters
    ----------
    plotter : pyvista.Plotter
    content : Content
    pictures : Path
        Folder for pictures that are saved.
    """

    def __init__(self, plotter: pyvista.Plotter, content: Content, *, pictures: Path) -> None:
        self.plotter, self.content, self.pictures = plotter, content, pictures
        self.stage = Stage(plotter, content)
        self.charts = WaveformCharts(content.run)
        self.slider = FlightSlider(plotter, frames=len(content.flashes), moved=self._slid)
        self.state = content.first_state(self.stage.size)
        self._help = Words(plotter, size=FONT_SIZES["help"], boxed=True)
        self._notice = Words(plotter, size=FONT_SIZES["state"])
        self._hint = Words(plotter, size=FONT_SIZES["hint"])
        self._hint.say(HINT, (GAP, GAP))
        self._pressed: tuple[int, int] | None = None
        self._last: tuple[int, int] = (0, 0)
        self._moved_at = 0.0
        self._moving_view = False
        self._listen()
        self.become(self.state)

    def open(self) -> None:
        """Show the window until it is closed."""
        self.plotter.show(auto_close=False, interactive=False, interactive_update=True)
        interactor = self._interactor
        interactor.CreateRepeatingTimer(TICK_MS)
        self.become(self.state)
        interactor.Start()
        self.plotter.close()

    def become(self, state: ViewState, *, kind: str = "resting") -> None:
        """Show another state."""
        old, self.state = self.state, state
        self._open_charts(old, state)
        self.stage.apply(state, kind=kind)
        self.slider.show(state.frame)
        width, height = self.stage.size
        self._help.say(help_text() if state.help else "", (0.2 * width, 0.16 * height))
        self._draw()

    def key(self, name: str, *, shift: bool = False) -> None:
        """Do what a key does; VTK's name of it."""
        action = action_of(name, shift=shift)
        if action is Command.PICK_MIDDLE:
            width, height = self.stage.size
            self.click((0.5 * width, 0.5 * height))
        elif action is Command.SAVE_PICTURE:
            self.say(f"written: {self.save_picture()}")
        elif action is Command.QUIT:
            self._interactor.ExitCallback()
        elif action is not None:
            state = action(self.state)
            turned = state.orbit != self.state.orbit
            self._change(state, moving=turned)

    def click(self, at: tuple[float, float]) -> None:
        """Pick the point at a place of the window, from the lower left corner [pixels]."""
        pick = self.stage.pick(self.state, at)
        if pick is None:
            self.say("no point there")
        else:
            self.become(self.state.clicked(pick))

    def drag(self, right: float, up: float, *, move: bool) -> None:
        """Turn or move the view by so many pixels of the mouse."""
        orbit = self.state.orbit
        turned = orbit.turned(-TURN_PER_PIXEL * right, -TURN_PER_PIXEL * up)
        self._change(self.state.seen_from(orbit.moved(right, up) if move else turned), moving=True)

    def tick(self) -> None:
        """Go on: fly the mission, show a chart that is ready, draw all points after a move."""
        answer = self.charts.answer()
        if isinstance(answer, str):
            self.say(answer)
        elif answer is not None:
            self.stage.chart.show(answer)
            self.say("")
            self.become(self.state)
        if self.state.playing:
            on = self.state.flown_on()
            self.become(on, kind="moving" if on.playing else "resting")
        elif self.stage.kind == "moving" and self._pressed is None and self._is_at_rest():
            self.become(self.state)

    def say(self, text: str) -> None:
        """Show a notice."""
        width, _ = self.stage.size
        self._notice.say(text, (0.3 * width, 12.0))
        self._draw()

    def save_picture(self) -> Path:
        """Write the window as PNG under the next free name, and return its path."""
        from io import BytesIO

        import matplotlib.image

        names = (self.pictures / f"bathyflash-{number}.png" for number in range(1, 10_000))
        path = next(name for name in names if not name.exists())
        content = BytesIO()
        picture: Any = self.plotter.screenshot(return_img=True)
        matplotlib.image.imsave(content, picture, format="png")
        write_whole(path, content.getvalue())
        return path

    @property
    def _interactor(self) -> Any:
        held: Any = self.plotter.iren
        return held.interactor

    def _change(self, state: ViewState, *, moving: bool) -> None:
        if state == self.state:
            return
        if moving:
            self._moved_at = time.monotonic()
        old = self.state
        try:
            self.become(state, kind="moving" if moving else "resting")
        except (OSError, ValueError) as fault:
            self.become(old)
            self.say(str(fault))

    def _is_at_rest(self) -> bool:
        return time.monotonic() - self._moved_at > REST_AFTER_S

    def _draw(self) -> None:
        begun = time.monotonic()
        self.plotter.render()
        self.stage.told(time.monotonic() - begun)

    def _open_charts(self, old: ViewState, new: ViewState) -> None:
        """Ask for the waveform of a new pick, draw a new profile, hide what is closed."""
        if new.picked == old.picked and new.ends == old.ends:
            return
        self.stage.chart.hide()
        self.charts.forget()
        self._notice.say("", (0.0, 0.0))
        if new.picked is not None:
            self.charts.ask(address_of(new.picked, self.content))
            self.say(FLYING)
        elif len(new.ends) == 2:
            found = profile(
                self.content.clouds[Layer.BOTTOM],
                (new.ends[0], new.ends[1]),
                spacing=self.content.spacing,
                seabed=self.content.seabed,
            )
            level = self.content.flown.water_level
            self.stage.chart.show(draw_profile(found, water_level=level))

    def _slid(self, frame: int) -> None:
        if frame != self.state.frame:
            self.become(replace(self.state.at_frame(frame), playing=False), kind="moving")
            self._moved_at = time.monotonic()

    def _listen(self) -> None:
        interactor = self._interactor
        interactor.RemoveObservers("KeyPressEvent")
        interactor.SetInteractorStyle(None)
        for event, heard in (
            ("KeyPressEvent", self._key_pressed),
            ("LeftButtonPressEvent", self._button_pressed),
            ("LeftButtonReleaseEvent", self._button_released),
            ("MiddleButtonPressEvent", self._button_pressed),
            ("MiddleButtonReleaseEvent", self._button_released),
            ("RightButtonPressEvent", self._button_pressed),
            ("RightButtonReleaseEvent", self._button_released),
            ("MouseMoveEvent", self._mouse_moved),
            ("MouseWheelForwardEvent", self._wheel),
            ("MouseWheelBackwardEvent", self._wheel),
            ("ConfigureEvent", self._resized),
            ("TimerEvent", lambda *_: self.tick()),
        ):
            interactor.AddObserver(event, heard)

    def _key_pressed(self, interactor: Any, _event: str) -> None:
        self.key(interactor.GetKeySym(), shift=bool(interactor.GetShiftKey()))

    def _button_pressed(self, interactor: Any, event: str) -> None:
        self._pressed = self._last = interactor.GetEventPosition()
        self._moving_view = bool(interactor.GetShiftKey()) or not event.startswith("Left")

    def _button_released(self, interactor: Any, event: str) -> None:
        at, pressed, self._pressed = interactor.GetEventPosition(), self._pressed, None
        self._moved_at = time.monotonic()
        if pressed is None or not event.startswith("Left"):
            return
        if max(abs(at[0] - pressed[0]), abs(at[1] - pressed[1])) < STILL:
            self.click((float(at[0]), float(at[1])))

    def _mouse_moved(self, interactor: Any, _event: str) -> None:
        if self._pressed is None:
            return
        at = interactor.GetEventPosition()
        right, up = at[0] - self._last[0], at[1] - self._last[1]
        far = max(abs(at[0] - self._pressed[0]), abs(at[1] - self._pressed[1])) >= STILL
        if far or self._last != self._pressed:
            self._last = at
            self.drag(right, up, move=self._moving_view)

    def _wheel(self, _interactor: Any, event: str) -> None:
        factor = ZOOM if event == "MouseWheelForwardEvent" else 1.0 / ZOOM
        self._change(self.state.seen_from(self.state.orbit.nearer(factor)), moving=True)

    def _resized(self, *_: Any) -> None:
        self.become(self.state)

"""A plotter that shows a state of the view: the window's, the movie's and the tests'."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from viewer import scene
from viewer.desktop.colouring import Colouring
from viewer.desktop.content import Content
from viewer.desktop.levels import LeveledPlaces, Pace
from viewer.desktop.overlay import FONT_SIZES, GAP, Inset, ScaleBar, Words
from viewer.desktop.pick import nearest
from viewer.desktop.pictures import legend
from viewer.desktop.point_layer import FrameFilter, PointLayer
from viewer.desktop.scenery import Scenery
from viewer.desktop.state import Layer, Pick, Reach, ViewState
from viewer.desktop.words import state_words
from viewer.flashes import Flashes
from viewer.view import View

if TYPE_CHECKING:
    import pyvista

FloatArray = NDArray[np.float64]
FAR = 10.0
"""From the centre to the eye, in widths of the picture."""

SHARE = {Layer.BOTTOM: 1.0, Layer.SURFACE: 0.1, Layer.OTHER: 0.1}
"""Of the points that may be drawn."""

SEA_POINTS, SEA_OF = 3_000, 500_000
"""Of the sea so few in view, and small, so that the bottom shines through; taken of so many."""

TOO_MANY = 1.2
"""Times the points that the pace allows, and fewer are drawn at once."""

MOVING_SECONDS, RESTING_SECONDS = 0.07, 1.0


@dataclass(frozen=True, kw_only=True)
class Flash:
    """Where the aircraft is and what it lights, to scale [m, rad]."""

    position: FloatArray
    heading: float
    corners: FloatArray

    @classmethod
    def of(cls, flashes: Flashes, place: int) -> Flash:
        """Return one of the flashes of a run."""
        return cls(
            position=flashes.position[place],
            heading=float(flashes.heading[place]),
            corners=flashes.corners[place],
        )


class Stage:
    """Shows a run as a state says.

    Parameters
    ----------
    plotter : pyvista.Plotter
    content : Content
    """

    def __init__(self, plotter: pyvista.Plotter, content: Content) -> None:
        self.plotter, self.content = plotter, content
        self.colouring = Colouring(content)
        self.paces = {
            "moving": Pace(seconds=MOVING_SECONDS, points=60_000, least=10_000),
            "resting": Pace(seconds=RESTING_SECONDS, points=1_000_000, least=200_000),
        }
        plotter.renderer.set_background("white")
        window: Any = plotter.render_window
        window.SetMultiSamples(0)
        plotter.renderer.SetUseOIT(False)
        self.layers = {
            layer: PointLayer(plotter, self._leveled(layer), closed=layer is not Layer.SURFACE)
            for layer in content.clouds
        }
        bottom = self.layers[Layer.BOTTOM].places
        self.scenery = Scenery(plotter, content, self.colouring, bottom)
        self._legend, self._bar = Inset(plotter), ScaleBar(plotter)
        self.chart = Inset(plotter)
        self._words = Words(plotter, size=FONT_SIZES["state"], top=True)
        self._chosen: tuple[Any, ...] = ()
        self._painted: tuple[Any, ...] = ()
        self._legend_of = ""
        self.kind = "resting"

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture [pixels]."""
        width, height = self.plotter.window_size
        return int(width), int(height)

    def apply(self, state: ViewState, *, kind: str = "resting", flash: Flash | None = None) -> None:
        """Bring the scene into a state; nothing is rendered.

        Parameters
        ----------
        state : ViewState
        kind : {"resting", "moving"}
            Whether all points in view are drawn, or so few that pictures follow each other.
        flash : Flash, optional
            Drawn in place of the state's own.
        """
        view = state.orbit.view(self.size)
        self.kind = kind
        self.scenery.fly(state, **vars(flash or Flash.of(self.content.flashes, state.frame)))
        self.scenery.mark(state)
        self.scenery.show(state)
        self._points(state, view)
        self._paint(state)
        self._aim(view)
        self._write(state, view)

    def told(self, seconds: float) -> None:
        """Learn from the time that a picture took [s]."""
        self.paces[self.kind].told(self.layers[Layer.BOTTOM].drawn, seconds)

    def pick(self, state: ViewState, at: tuple[float, float]) -> Pick | None:
        """Return the point that a click hits, from the lower left corner [pixels]."""
        view, best = state.orbit.view(self.size), None
        for layer in (Layer.BOTTOM, Layer.OTHER, Layer.SURFACE):
            if layer in state.layers and best is None:
                best = self._pick_of(layer, state, view, at)
        return best

    def _pick_of(
        self, layer: Layer, state: ViewState, view: View, at: tuple[float, float]
    ) -> Pick | None:
        shown = self.layers[layer]
        places = self._stretch(shown.places.place[shown.resting], state)
        hit = nearest(places, view, at)
        if hit is None:
            return None
        index = int(shown.places.order[shown.resting[hit]])
        x, y, z = (float(value) for value in self.content.clouds[layer].position[index])
        number = self.content.clouds[layer].frame[index]
        flash = int(np.searchsorted(self.content.flashes.frame, number))
        return Pick(layer=layer, index=index, place=(x, y, z), flash=flash)

    def _leveled(self, layer: Layer) -> LeveledPlaces:
        cloud = self.content.clouds[layer]
        most = SEA_OF if layer is Layer.SURFACE else None
        spacing = self.content.spacing
        return LeveledPlaces.of(cloud.position, cloud.frame, spacing=spacing, at_most=most)

    def _stretch(self, places: NDArray[Any], state: ViewState) -> FloatArray:
        level = self.content.flown.water_level
        return scene.stretched(places, water_level=level, exaggeration=state.exaggeration)

    def _points(self, state: ViewState, view: View) -> None:
        """Choose points anew where others are in view or wanted; while it moves only if wanted."""
        wanted = (state.reach, state.frame if state.reach is not Reach.ALL else 0, state.layers)
        seen = (state.orbit, state.exaggeration, self.size)
        if self._chosen[:1] != (wanted,) or (
            self.kind == "resting" and self._chosen != (wanted, seen, "resting")
        ):
            self._choose(state, view)
            self._chosen, self._painted = (wanted, seen, self.kind), ()
        elif self.kind == "moving":
            self._thin(state)
        for layer, points in self.layers.items():
            points.stretch(state.exaggeration, self.content.flown.water_level)
            points.show(self.kind if layer in state.layers else "", view)

    def _thin(self, state: ViewState) -> None:
        """Draw fewer points at once where pictures take too long for the number last chosen."""
        most = self.paces["moving"].points
        for layer, points in self.layers.items():
            count = int(SHARE[layer] * most)
            if layer in state.layers and len(points.moving) > TOO_MANY * count:
                points.thin(count, partial(self.colouring.colours, state.attribute, layer))

    def _choose(self, state: ViewState, view: View) -> None:
        moving, resting = self.paces["moving"].points, self.paces["resting"].points
        for layer, points in self.layers.items():
            if layer not in state.layers:
                continue
            most = SEA_POINTS if layer is Layer.SURFACE else len(points.places)
            points.choose(
                view,
                lambda places: self._stretch(places, state),
                self._filter(state),
                resting=min(
                    int(SHARE[layer] * (resting if self.kind == "resting" else moving)), most
                ),
                moving=min(int(SHARE[layer] * moving), most),
            )

    def _filter(self, state: ViewState) -> FrameFilter:
        number = self.content.flashes.frame[state.frame]
        filters: dict[Reach, FrameFilter] = {
            Reach.ALL: lambda frames: np.ones(len(frames), dtype=np.bool_),
            Reach.SO_FAR: lambda frames: frames <= number,
            Reach.ONE: lambda frames: frames == number,
        }
        return filters[state.reach]

    def _paint(self, state: ViewState) -> None:
        looks = (state.attribute, state.layers)
        if self._painted == looks:
            return
        for layer, points in self.layers.items():
            if layer in state.layers:
                points.paint(partial(self.colouring.colours, state.attribute, layer))
        self.scenery.paint(state.attribute)
        if self._legend_of != state.attribute:
            self._legend.show(legend(self.colouring.attribute(state.attribute)))
            self._legend_of = state.attribute
        self._painted = looks

    def _aim(self, view: View) -> None:
        camera: Any = self.plotter.camera
        far = FAR * view.metres_per_pixel * view.size[0]
        camera.focal_point = tuple(view.centre)
        camera.position = tuple(view.centre + far * view.towards)
        camera.up = tuple(view.up)
        camera.is_set = True
        camera.parallel_projection = True
        camera.parallel_scale = 0.5 * view.size[1] * view.metres_per_pixel
        self.plotter.renderer.ResetCameraClippingRange()

    def _write(self, state: ViewState, view: View) -> None:
        width, height = view.size
        drawn = {
            layer: points.drawn for layer, points in self.layers.items() if layer in state.layers
        }
        self._words.say(state_words(state, self.content, drawn), (GAP, height - GAP))
        self._legend.place(width - self._legend.size[0] - GAP, height - self._legend.size[1] - GAP)
        self._bar.update(view, state.exaggeration)
        self.chart.place(width - self.chart.size[0] - GAP, 5.0 * GAP)

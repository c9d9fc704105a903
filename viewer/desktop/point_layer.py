"""A cloud in the scene: all of it while the view rests, few points while it moves."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from viewer.desktop.feeding import COLOUR, feed
from viewer.desktop.levels import LeveledPlaces
from viewer.view import View

if TYPE_CHECKING:
    import pyvista

IndexArray = NDArray[np.intp]
Paint = Callable[[IndexArray], NDArray[np.uint8]]
FrameFilter = Callable[[NDArray[np.uint32]], NDArray[np.bool_]]
SMALLEST, LARGEST, LARGEST_MOVING = 2.0, 9.0, 5.0
"""Points drawn [pixels]."""

OVERLAP = 1.25
"""Width of a point drawn over the distance of neighbours, so that level ground looks closed."""


class PointLayer:
    """Points of one cloud.

    Parameters
    ----------
    plotter : pyvista.Plotter
    places : LeveledPlaces
    closed : bool
        Whether points are drawn so large that level ground looks closed.
    """

    def __init__(
        self, plotter: pyvista.Plotter, places: LeveledPlaces, *, closed: bool = True
    ) -> None:
        self.places, self._closed = places, closed
        self.resting: IndexArray = np.zeros(0, dtype=np.intp)
        self.moving: IndexArray = np.zeros(0, dtype=np.intp)
        self._actors = {"resting": _actor(plotter), "moving": _actor(plotter)}
        self._shown = ""

    def choose(
        self, view: View, stretch: Stretch, wanted: FrameFilter, *, resting: int, moving: int
    ) -> None:
        """Choose which points are drawn: at rest those in view, in motion also some of all.

        Parameters
        ----------
        view : View
        stretch : callable
            From places (n, 3) to scale to those drawn.
        wanted : callable
            From frames' numbers to whether their points are shown.
        resting, moving : int
            At most so many points.
        """
        frames, place = self.places.frame, self.places.place

        def seen(part: slice) -> NDArray[np.bool_]:
            x, y = view.pixels(stretch(place[part])).T
            width, height = view.size
            inside = (x >= 0.0) & (x <= width) & (y >= 0.0) & (y <= height)
            return np.asarray(inside & wanted(frames[part]))

        self.resting = self.places.first(resting, seen)
        everywhere = self.places.first(moving // 2, lambda part: wanted(frames[part]))
        self.moving = together(everywhere, self.resting, moving)

    def paint(self, paint: Paint) -> None:
        """Give the chosen points their colours."""
        self._feed("resting", self.resting, paint)
        self._feed("moving", self.moving, paint)

    def thin(self, count: int, paint: Paint) -> None:
        """Draw no more than so many points while it moves."""
        self.moving = self.moving[:count]
        self._feed("moving", self.moving, paint)

    def show(self, kind: str, view: View) -> None:
        """Show the points for a kind of view, "resting" or "moving"; with "" none."""
        for name, actor in self._actors.items():
            actor.visibility = name == kind
        self._shown = kind
        if kind:
            self._actors[kind].prop.point_size = self._size(kind, view)

    def stretch(self, exaggeration: float, water_level: float) -> None:
        """Multiply heights above the water level."""
        for actor in self._actors.values():
            actor.SetOrigin(0.0, 0.0, water_level)
            actor.SetScale(1.0, 1.0, exaggeration)

    @property
    def drawn(self) -> int:
        """How many points are drawn."""
        chosen = {"resting": self.resting, "moving": self.moving}.get(self._shown)
        return 0 if chosen is None else len(chosen)

    def _feed(self, kind: str, chosen: IndexArray, paint: Paint) -> None:
        data = _points(self.places.place[chosen], paint(self.places.order[chosen]))
        feed(self._actors[kind], data)

    def _size(self, kind: str, view: View) -> float:
        if not self._closed:
            return SMALLEST
        chosen = self.resting if kind == "resting" else self.moving
        reached = int(chosen[-1]) + 1 if len(chosen) else 1
        pixels = OVERLAP * self.places.spacing_of(reached) / view.metres_per_pixel
        largest = LARGEST if kind == "resting" else LARGEST_MOVING
        return float(np.clip(np.round(pixels), SMALLEST, largest))


Stretch = Callable[[NDArray[Any]], NDArray[Any]]


def together(first: IndexArray, second: IndexArray, count: int) -> IndexArray:
    """Return the first and as many of the second that fit a count; both ascend, none comes twice.

    Examples
    --------
    >>> together(np.array([0, 1, 2]), np.array([1, 2, 5, 9]), 4)
    array([0, 1, 2, 5])
    """
    if len(first) == 0:
        return second[:count]
    new = np.setdiff1d(second[: count + len(first)], first, assume_unique=True)
    return np.sort(np.concatenate([first, new[: count - len(first)]]))


def _actor(plotter: pyvista.Plotter) -> Any:
    empty = _points(np.zeros((1, 3), np.float32), np.zeros((1, 3), np.uint8))
    return plotter.add_mesh(
        empty,
        scalars=COLOUR,
        rgb=True,
        style="points",
        lighting=False,
        point_size=SMALLEST,
        reset_camera=False,
        render=False,
        pickable=False,
    )


def _points(places: NDArray[np.float32], colours: NDArray[np.uint8]) -> pyvista.PolyData:
    """Return points as one cell: ten million of their own would take a third more memory."""
    import pyvista

    data = pyvista.PolyData()
    data.points = places
    if len(places):
        data.verts = np.append(len(places), np.arange(len(places)))
    data[COLOUR] = colours
    data.set_active_scalars(COLOUR)
    return data

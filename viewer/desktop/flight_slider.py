"""The slider that flies the mission frame by frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from viewer.labels import FLIGHT, INK

if TYPE_CHECKING:
    import pyvista

FROM, TO = (0.28, 0.055), (0.72, 0.055)
"""Ends, in shares of the window."""


class FlightSlider:
    """A slider over the flashes of a run.

    Parameters
    ----------
    plotter : pyvista.Plotter
    frames : int
        How many flashes there are.
    moved : callable
        Told the place of the flash that the user chose.
    """

    def __init__(
        self, plotter: pyvista.Plotter, *, frames: int, moved: Callable[[int], None]
    ) -> None:
        self._moved = moved
        self._listening = False
        add: Any = plotter.add_slider_widget
        self._slider: Any = add(
            self._heard,
            (0, max(frames - 1, 1)),
            value=0,
            pointa=FROM,
            pointb=TO,
            style="modern",
            interaction_event="always",
            slider_width=0.018,
            tube_width=0.006,
            fmt="",
        )
        looks = self._slider.GetRepresentation()
        looks.SetShowSliderLabel(False)
        looks.GetSliderProperty().SetColor(*_rgb(FLIGHT))
        looks.GetTubeProperty().SetColor(*_rgb(INK))
        self._listening = True

    def show(self, frame: int) -> None:
        """Put the slider at a flash."""
        self._listening = False
        self._slider.GetRepresentation().SetValue(frame)
        self._listening = True

    def _heard(self, value: float) -> None:
        if self._listening:
            self._moved(round(value))


def _rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return red, green, blue

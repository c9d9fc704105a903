"""What lies over the scene: words, pictures, scale bar."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from viewer.desktop.pictures import Picture
from viewer.labels import INK, round_length
from viewer.view import View

if TYPE_CHECKING:
    import pyvista

GAP = 12.0
BAR_SHARE = 0.16
"""Of the window's width, at most."""

BAR_PLACE = (24.0, 74.0)
FONT_SIZES = {"state": 15, "hint": 14, "help": 14, "bar": 14}


class Words:
    """A few lines of text at a place of the window.

    Parameters
    ----------
    plotter : pyvista.Plotter
    size : int
        Of the letters [pixels].
    top : bool
        Whether the place is the text's upper left corner, not its lower left.
    boxed : bool
        On a white ground, in letters of one width.
    """

    def __init__(
        self, plotter: pyvista.Plotter, *, size: int, top: bool = False, boxed: bool = False
    ) -> None:
        from vtkmodules.vtkRenderingCore import vtkTextActor

        self._actor = vtkTextActor()
        looks: Any = self._actor.GetTextProperty()
        looks.SetFontSize(size)
        looks.SetColor(*_unit_rgb(INK))
        looks.SetLineSpacing(1.15)
        if top:
            looks.SetVerticalJustificationToTop()
        looks.SetBackgroundColor(1.0, 1.0, 1.0)
        looks.SetBackgroundOpacity(0.75)
        if boxed:
            looks.SetFontFamilyToCourier()
            looks.SetBackgroundOpacity(0.92)
            looks.SetFrame(True)
            looks.SetFrameColor(*_unit_rgb(INK))
        plotter.renderer.AddViewProp(self._actor)

    def say(self, text: str, at: tuple[float, float]) -> None:
        """Show a text at a place, from the lower left corner [pixels]; none for no text."""
        self._actor.SetInput(text)
        self._actor.SetDisplayPosition(*(int(value) for value in at))
        self._actor.SetVisibility(bool(text))


class Inset:
    """A picture over the scene.

    Parameters
    ----------
    plotter : pyvista.Plotter
    """

    def __init__(self, plotter: pyvista.Plotter) -> None:
        from vtkmodules.vtkRenderingCore import vtkPolyDataMapper2D, vtkTexturedActor2D

        self._actor, self._mapper = vtkTexturedActor2D(), vtkPolyDataMapper2D()
        self._actor.SetMapper(self._mapper)
        self._actor.SetVisibility(False)
        self._size = (0, 0)
        self._placed: tuple[Any, ...] = ()
        plotter.renderer.AddViewProp(self._actor)

    def show(self, picture: Picture) -> None:
        """Take a picture (height, width, 4); `place` puts it somewhere."""
        import pyvista

        make: Any = pyvista.Texture
        texture = make(picture)
        texture.InterpolateOff()
        self._actor.SetTexture(texture)
        self._size = (picture.shape[1], picture.shape[0])
        self._actor.SetVisibility(True)

    def hide(self) -> None:
        """Show nothing."""
        self._actor.SetVisibility(False)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture [pixels]."""
        return self._size

    def place(self, left: float, bottom: float) -> None:
        """Put the picture's lower left corner at a place of the window [pixels]."""
        if self._placed == (left, bottom, self._size):
            return
        import pyvista

        self._placed = (left, bottom, self._size)
        width, height = self._size
        across = [0.0, width, width, 0.0]
        upwards = [0.0, 0.0, height, height]
        corners = np.column_stack([across, upwards, np.zeros(4)])
        quad = pyvista.PolyData(corners, faces=[4, 0, 1, 2, 3])
        quad.active_texture_coordinates = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        self._mapper.SetInputData(quad)
        self._actor.SetPosition(left, bottom)


class ScaleBar:
    """A round length across the picture.

    Parameters
    ----------
    plotter : pyvista.Plotter
    """

    def __init__(self, plotter: pyvista.Plotter) -> None:
        from vtkmodules.vtkRenderingCore import vtkActor2D, vtkPolyDataMapper2D

        self._words = Words(plotter, size=FONT_SIZES["bar"])
        self._shown: tuple[Any, ...] = ()
        self._actor, self._mapper = vtkActor2D(), vtkPolyDataMapper2D()
        self._actor.SetMapper(self._mapper)
        looks: Any = self._actor.GetProperty()
        looks.SetColor(*_unit_rgb(INK))
        looks.SetLineWidth(3.0)
        plotter.renderer.AddViewProp(self._actor)

    def update(self, view: View, exaggeration: float) -> None:
        """Draw the bar for a view, and say how heights are stretched."""
        shown = (view.metres_per_pixel, view.size, exaggeration)
        if self._shown == shown:
            return
        import pyvista

        self._shown = shown
        length = round_length(BAR_SHARE * view.size[0] * view.metres_per_pixel)
        pixels = length / view.metres_per_pixel
        ends = np.array([[0.0, 0.0, 0.0], [pixels, 0.0, 0.0]])
        self._mapper.SetInputData(pyvista.PolyData(ends, lines=[2, 0, 1]))
        x, y = BAR_PLACE
        self._actor.SetPosition(x, y)
        heights = "" if exaggeration == 1.0 else f", heights of sea and bottom x {exaggeration:g}"
        self._words.say(f"{length:g} m{heights}", (x, y + 8.0))


def _unit_rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return red, green, blue

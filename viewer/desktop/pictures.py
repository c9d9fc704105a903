"""Figures and legends as pictures to lay over the scene."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.products.depth_colours import LAND
from viewer.attributes import Attribute, Scale
from viewer.labels import INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Picture = NDArray[np.uint8]
DOTS_PER_INCH = 80
SCALE_WIDTH, CATEGORIES_WIDTH = 2.1, 3.1
LETTERS_PER_INCH = 10.5
LINE = 0.24
"""Inches."""


def picture_of(figure: Figure) -> Picture:
    """Return a figure as a picture (height, width, 4) of bytes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.set_dpi(DOTS_PER_INCH)
    figure.patch.set(edgecolor=INK, linewidth=1.5)
    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba()).copy()


def legend(attribute: Attribute) -> Picture:
    """Return the legend of what points are coloured by: a scale, or categories with counts."""
    scale = attribute.scale
    return _categories(attribute) if scale is None else _scale(attribute, scale)


def _new(width: float, height: float) -> Figure:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), facecolor=(1.0, 1.0, 1.0, 0.85))


def _scale(attribute: Attribute, scale: Scale) -> Picture:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, LogNorm, Normalize
    from matplotlib.ticker import LogLocator, NullLocator

    figure = _new(SCALE_WIDTH, 3.0)
    axes = figure.add_axes((0.08, 0.14 if scale.land else 0.05, 0.13, 0.69))
    norm = (LogNorm if scale.logarithmic else Normalize)(scale.low, scale.high)
    colours = ListedColormap(list(scale.palette))
    bar = figure.colorbar(ScalarMappable(norm=norm, cmap=colours), cax=axes)
    bar.ax.tick_params(labelsize=10, colors=INK)
    bar.outline.set_visible(False)
    if scale.logarithmic:
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        bar.ax.yaxis.set_major_formatter("{x:g}")
        bar.ax.yaxis.set_minor_locator(NullLocator())
    if attribute.name == "depth":
        bar.ax.invert_yaxis()
    _title(figure, attribute)
    if scale.land:
        _swatch(figure, 0.05, LAND, "land")
    return picture_of(figure)


def _categories(attribute: Attribute) -> Picture:
    count = len(attribute.categories)
    height = LINE * count + 0.75
    figure = _new(CATEGORIES_WIDTH, height)
    _title(figure, attribute)
    for place, category in enumerate(attribute.categories):
        words = f"{category.label}: {category.count:,}"
        _swatch(figure, 1.0 - (0.72 + LINE * place) / height, category.colour, words)
    return picture_of(figure)


def _title(figure: Figure, attribute: Attribute) -> None:
    unit = f" [{attribute.unit}]" if attribute.unit else ""
    top = 1.0 - 0.1 / figure.get_figheight()
    letters = int(LETTERS_PER_INCH * figure.get_figwidth())
    words = textwrap.fill(f"{attribute.label}{unit}", letters)
    figure.text(0.05, top, words, fontsize=10, color=INK, weight="bold", va="top")


def _swatch(figure: Figure, height: float, colour: str, words: str) -> None:
    from matplotlib.patches import Rectangle

    tall = 0.14 / figure.get_figheight()
    wide = 0.2 / figure.get_figwidth()
    figure.add_artist(Rectangle((wide, height - 0.5 * tall), wide, tall, color=colour))
    figure.text(2.5 * wide, height, words, fontsize=9.5, color=INK, va="center")


def framed(axes: Axes) -> None:
    """Give a chart the project's plain looks."""
    axes.grid(alpha=0.25)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)

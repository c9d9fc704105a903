"""Title, caption, scales and arrows drawn over a rendered picture."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.products.depth_colours import COLOURS
from viewer.view import View

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FloatArray = NDArray[np.float64]
INK = "#26323a"
FLIGHT = "#c4500c"
SEA = "#2f7fb0"
DOTS_PER_INCH = 100
CAPTION_WIDTH = 165
BAR_LENGTHS = (10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0)


@dataclass(frozen=True, kw_only=True)
class Label:
    """Words at a place of the scene, (3,) [m], shifted by so many pixels."""

    words: str
    place: FloatArray
    shift: tuple[float, float]
    colour: str
    align: str = "left"


def draw_labels(
    picture: NDArray[np.uint8],
    view: View,
    *,
    title: str,
    caption: str,
    depths: tuple[float, float],
    labels: list[Label],
    bar_start: FloatArray,
    bar_axis: FloatArray,
    bar_length: float,
) -> bytes:
    """Return the finished PNG.

    Parameters
    ----------
    picture : array (height, width, 3)
        What was rendered.
    view : View
        How places lie on it.
    title, caption : str
        Above and below the picture.
    depths : (shallow, deep)
        Ends of the depth scale [m].
    labels : list of Label
        Words beside things.
    bar_start, bar_axis : array (3,)
        Where the horizontal scale bar begins [m], and its direction.
    bar_length : float
        Its length [m].
    """
    from matplotlib.figure import Figure

    width, height = view.size
    figure = Figure(figsize=(width / DOTS_PER_INCH, height / DOTS_PER_INCH), dpi=DOTS_PER_INCH)
    figure.figimage(picture, zorder=-1)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(0, width)
    axes.set_ylim(0, height)
    axes.axis("off")
    axes.text(48, height - 52, title, fontsize=21, weight="bold", color=INK, va="center")
    lines = [textwrap.fill(line, CAPTION_WIDTH) for line in caption.splitlines()]
    wrapped = "\n".join(lines)
    axes.text(48, 30, wrapped, fontsize=11.5, color=INK, va="bottom", linespacing=1.35)
    for label in labels:
        _write(axes, view, label)
    _scale_bar(axes, view, bar_start, bar_axis, bar_length)
    _north_arrow(axes, view)
    _depth_scale(figure, depths)
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    return buffer.getvalue()


def round_length(wanted: float) -> float:
    """Return the round length nearest below a wanted one [m]."""
    return max((length for length in BAR_LENGTHS if length <= wanted), default=BAR_LENGTHS[0])


def _write(axes: Axes, view: View, label: Label) -> None:
    x, y = view.pixels(label.place)[0] + label.shift
    axes.text(x, y, label.words, fontsize=12.5, color=label.colour, ha=label.align, va="center")


def _scale_bar(axes: Axes, view: View, start: FloatArray, axis: FloatArray, length: float) -> None:
    ends = view.pixels(np.stack([start, start + length * axis]))
    axes.plot(ends[:, 0], ends[:, 1], color=INK, linewidth=3.0, solid_capstyle="butt")
    slope = ends[1] - ends[0]
    angle = float(np.degrees(np.arctan2(slope[1], slope[0])))
    angle = angle - 180.0 if angle > 90.0 else angle + 180.0 if angle < -90.0 else angle
    below = np.array([np.sin(np.radians(angle)), -np.cos(np.radians(angle))])
    x, y = ends.mean(axis=0) + 17.0 * below
    style: dict[str, Any] = {"ha": "center", "va": "center", "rotation_mode": "anchor"}
    axes.text(x, y, f"{length:g} m", fontsize=12.5, color=INK, rotation=angle, **style)


def _north_arrow(axes: Axes, view: View) -> None:
    """Draw a level arrow to grid north in the upper right corner."""
    north = np.array([view.right[1], view.up[1]])
    tail = np.array([view.size[0] - 235.0, view.size[1] - 105.0]) - 27.0 * north
    head = tail + 70.0 * north
    axes.annotate(
        "",
        xy=tuple(head),
        xytext=tuple(tail),
        arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 2.0, "mutation_scale": 18},
    )
    x, y = head + 15.0 * north / np.linalg.norm(north)
    axes.text(x, y, "N", fontsize=14, weight="bold", color=INK, ha="center", va="center")


def _depth_scale(figure: Figure, depths: tuple[float, float]) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    place = figure.add_axes((0.922, 0.24, 0.014, 0.46))
    scale = ScalarMappable(norm=Normalize(*depths), cmap=COLOURS)
    bar = figure.colorbar(scale, cax=place)
    bar.ax.invert_yaxis()
    bar.ax.tick_params(labelsize=11.5, colors=INK)
    bar.set_label("depth below water level [m]", fontsize=12.5, color=INK)
    bar.outline.set_visible(False)

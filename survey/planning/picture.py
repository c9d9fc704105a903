"""A plan as a picture: what is seen at the surface and on the seabed, and how deep that is."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from survey.errors import UserError
from survey.products.writing import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from survey.planning.plan import Coverage, SurveyPlan

PICTURES = (".png", ".svg")
DOTS_PER_INCH = 130
MOST_OUTLINED = 600
LONG = 2.5  # from this ratio of width to height on, maps stand over each other
BELOW = 1.15  # what of the picture lies below the deepest limit
VIEW, GAP, TRACK, NIGHT, SEABED = "#0072b2", "#d55e00", "#303030", "#cc79a7", "#9a9a9a"
AREA = "#009e73"
"""Okabe and Ito (2008), told apart by the colour-blind."""


def require_place(path: Path) -> None:
    """Refuse a picture's file of another kind, or in a folder that is not there.

    Raises
    ------
    UserError
    """
    if path.suffix.lower() not in PICTURES:
        raise UserError(f"--plot {path}: writes {' or '.join(PICTURES)}. Choose one.")
    if not path.parent.is_dir():
        raise UserError(f"--plot {path}: there is no folder {path.parent}. Make it first.")


def draw(path: Path, plan: SurveyPlan) -> None:
    """Write the picture, PNG or SVG by the suffix."""
    from matplotlib.figure import Figure

    width, height = np.ptp(np.concatenate(plan.surface.views.polygons()), axis=0)
    is_long = width > LONG * height
    figure = Figure(figsize=(11.0, 9.0), layout="constrained")
    panels = figure.subplot_mosaic(
        [["surface"], ["bottom"], ["depth"]]
        if is_long
        else [["surface", "bottom"], ["depth", "depth"]],
        height_ratios=[1.0, 1.0, 0.7] if is_long else [2.0, 0.7],
    )
    figure.suptitle(
        f"{plan.title}: {len(plan.frames)} frames, {plan.flight_seconds:.0f} s", x=0.01, ha="left"
    )
    _map(panels["surface"], plan, plan.surface, "at the water surface")
    _map(panels["bottom"], plan, plan.bottom, "on the seabed, by bent rays")
    _depths(panels["depth"], plan)
    content = io.BytesIO()
    metadata = {"Software": None} if path.suffix.lower() == ".png" else {"Date": None}
    figure.savefig(content, format=path.suffix[1:].lower(), dpi=DOTS_PER_INCH, metadata=metadata)
    write_whole(path, content.getvalue())


def _map(axes: Axes, plan: SurveyPlan, cover: Coverage, words: str) -> None:
    from matplotlib.collections import PathCollection, PolyCollection
    from matplotlib.path import Path as Outline

    origin = plan.map_frame.origin[:2]
    polygons = [ring + origin for ring in cover.views.polygons()]
    is_few = len(polygons) <= MOST_OUTLINED
    axes.add_collection(
        PolyCollection(
            polygons, facecolors=VIEW, edgecolors=VIEW, alpha=0.3, linewidths=0.8 if is_few else 0.0
        )
    )
    gaps = [
        Outline.make_compound_path(*(Outline(ring + origin) for ring in gap.rings))
        for gap in cover.swath.gaps
    ]
    if gaps:
        axes.add_collection(
            PathCollection(
                gaps, facecolors=GAP, edgecolors=GAP, alpha=0.6, transform=axes.transData
            )
        )
    if plan.area is not None:
        ring = np.concatenate([plan.area, plan.area[:1]]) + origin
        axes.plot(*ring.T, color=AREA, ls="--", lw=1.2)
    _tracks(axes, plan)
    axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim")
    axes.ticklabel_format(useOffset=False, style="plain")
    axes.locator_params(axis="both", nbins=5)
    axes.set_xlabel(f"easting [m], EPSG:{plan.map_frame.epsg}")
    axes.set_ylabel("northing [m]")
    axes.set_title(f"Seen {words}; {_gap_words(cover)}", loc="left", fontsize="medium")


def _gap_words(cover: Coverage) -> str:
    if not cover.swath.gaps:
        return "no gaps"
    count = len(cover.swath.gaps)
    return f"{count} gap{'s' * (count > 1)} (red), {cover.swath.gap_area:,.0f} m2"


def _tracks(axes: Axes, plan: SurveyPlan) -> None:
    """Draw each line with an arrow at its end."""
    origin = plan.map_frame.origin[:2]
    place = np.array([frame.pose.position[:2] for frame in plan.frames]) + origin
    line = np.array([frame.line for frame in plan.frames])
    for number in np.unique(line):
        x, y = place[line == number].T
        axes.plot(x, y, ".-" if len(x) <= MOST_OUTLINED else "-", color=TRACK, lw=0.8, ms=3.0)
        if len(x) > 1:
            axes.annotate(
                "",
                xy=(x[-1], y[-1]),
                xytext=(x[-2], y[-2]),
                arrowprops={"arrowstyle": "-|>", "color": TRACK, "lw": 0.8},
            )


def _depths(axes: Axes, plan: SurveyPlan) -> None:
    """Draw the depths under each frame, and down to where the bottom shows."""
    level = plan.surface.views.centre[0, 2]
    depth = level - plan.bottom.views.outline[..., 2]
    known = np.isfinite(depth).any(axis=1)
    number, depth = np.arange(len(plan.frames))[known], depth[known]
    low, high = np.nanmin(depth, axis=1), np.nanmax(depth, axis=1)
    axes.bar(
        number,
        high - low,
        bottom=low,
        width=1.0,
        color=SEABED,
        edgecolor=SEABED,
        label="under a frame",
    )
    expected = plan.expectation
    for limit, words, colour, style in (
        (expected.day, "limit by day", GAP, "-"),
        (expected.night, "limit by night", NIGHT, "--"),
    ):
        label = f"{words}, {limit.depth:.1f} m"
        axes.axhline(limit.depth, color=colour, ls=style, label=label)
    axes.axhline(0.0, color=VIEW, lw=1.0)
    axes.set_ylim(top=BELOW * max(expected.night.depth, expected.day.depth, *high))
    axes.invert_yaxis()
    axes.set_xlabel("frame")
    axes.set_ylabel("depth [m]")
    axes.set_title("Depth of the seabed and of sight", loc="left", fontsize="medium")
    axes.legend(loc="best", fontsize="small")

"""Maps of the report: depth, errors and outcomes, and their histogram, as PNG bytes."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np

from survey.cloud.points import Outcome
from survey.products.cells import CellGrid
from survey.products.coverage import GAP, OUTSIDE_AREA, SHADOW, CoverageMap
from survey.products.depth_colours import COLOURS, LAND, depth_range
from survey.products.grids import ElevationMap
from survey.products.tally import ErrorTally

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DOTS_PER_INCH = 110
WIDTH = 9.0
HISTOGRAM_BINS = 50
MOST_PICTURE_CELLS = 2000  # along a side
STATE_LOOKS = {
    Outcome.FOUND: ("bottom found", "#0072b2"),
    Outcome.DRY: ("land", LAND),
    Outcome.FALSE_BOTTOM: ("false bottom", "#d55e00"),
    Outcome.TOO_DEEP: ("too deep", "#56b4e9"),
    Outcome.TOO_TURBID: ("too turbid", "#8c6d31"),
    Outcome.LOW_REFLECTANCE: ("low reflectance", "#3b5323"),
    Outcome.GLINT: ("glint", "#e69f00"),
    Outcome.NOISE: ("taken for noise", "#e8a5c5"),
    Outcome.MERGED_WITH_SURFACE: ("merged with surface", "#f0e442"),
    Outcome.OUTSIDE_GATE: ("outside gate", "#cc79a7"),
    Outcome.SATURATED: ("saturated", "#000000"),
    Outcome.CHANCE: ("missed by chance", "#009e73"),
    GAP: ("gap between frames", "#9a9a9a"),
    SHADOW: ("shadow", "#4d4d4d"),
}
"""Words and colours (Okabe and Ito 2008, told apart by the colour-blind)."""


def depth_map(grid: ElevationMap, *, water_level: float) -> bytes:
    """Return a map of depth below the water level, land in sand colour."""
    from matplotlib import colormaps

    depth = water_level - grid.elevation
    figure, axes = map_axes(grid.cells)
    shallow, deep = depth_range(depth[np.isfinite(depth)])
    land = {"under": LAND} if shallow == 0.0 else {}
    colours = colormaps[COLOURS].with_extremes(**land)
    image = axes.imshow(
        depth,
        cmap=colours,
        vmin=shallow,
        vmax=deep,
        extent=grid.cells.extent,
        interpolation="nearest",
    )
    figure.colorbar(
        image, ax=axes, label="depth below water level [m]", extend="min" if land else "neither"
    )
    return png(figure)


def error_map(errors: ElevationMap) -> bytes:
    """Return a map of errors: red where too high, blue where too low, as far as 95 % of them go."""
    return _signed_map(errors, "measured less true elevation [m]")


def difference_map(off: ElevationMap) -> bytes:
    """Return a map of the elevations of one survey less those of another, in the same colours."""
    return _signed_map(off, "difference of elevation [m]")


def _signed_map(values: ElevationMap, label: str) -> bytes:
    figure, axes = map_axes(values.cells)
    known = np.abs(values.elevation[np.isfinite(values.elevation)])
    limit = max(float(np.ceil(100.0 * np.quantile(known, 0.95)) / 100.0), 0.01)
    image = axes.imshow(
        values.elevation,
        cmap="RdBu_r",
        vmin=-limit,
        vmax=limit,
        extent=values.cells.extent,
        interpolation="nearest",
    )
    figure.colorbar(image, ax=axes, label=label, extend="both")
    return png(figure)


def outcome_map(coverage: CoverageMap) -> bytes:
    """Return a map of what became of the bottom, each outcome that occurs with its share."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    figure, axes = map_axes(coverage.cells)
    inside = coverage.state != OUTSIDE_AREA
    handles, step = [], -(-max(coverage.state.shape) // MOST_PICTURE_CELLS)
    for state, (words, colour) in STATE_LOOKS.items():
        here = coverage.state == state
        if here.any():
            share = 100.0 * here.sum() / inside.sum()
            handles.append(Patch(color=colour, label=f"{words} ({share:.1f} %)"))
            shown = here[::step, ::step]
            axes.imshow(
                np.ma.masked_array(np.ones(shown.shape), ~shown),
                cmap=ListedColormap([colour]),
                extent=coverage.cells.extent,
                interpolation="nearest",
            )
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
    return png(figure)


def error_histogram(errors: ErrorTally) -> bytes:
    """Return a histogram of elevation errors [m]; the end bins hold all that is beyond."""
    figure, axes = new_figure(height=3.2)
    limit = np.ceil(20.0 * errors.quantile_of_absolute(0.95) + 1e-9) / 10.0
    edges = np.linspace(-limit, limit, HISTOGRAM_BINS + 1)
    axes.stairs(errors.histogram(edges), edges, fill=True, color="#0072b2")
    axes.axvline(0.0, color="#303030", linewidth=0.8)
    axes.set_xlim(-limit, limit)
    axes.set_xlabel("measured less true elevation [m]")
    axes.set_ylabel(f"bottom points per {200.0 * limit / HISTOGRAM_BINS:.2g} cm")
    axes.spines[["top", "right"]].set_visible(False)
    return png(figure)


def map_axes(cells: CellGrid) -> tuple[Figure, Axes]:
    """Return an empty map of the cells."""
    west, east, south, north = cells.extent
    figure, axes = new_figure(
        height=float(np.clip(7.0 * (north - south) / (east - west), 2.6, 7.5))
    )
    axes.set_xlabel("easting [m]")
    axes.set_ylabel("northing [m]")
    axes.set_aspect("equal")
    axes.ticklabel_format(useOffset=False, style="plain")
    axes.locator_params(axis="x", nbins=5 if east - west > 0.5 * (north - south) else 2)
    axes.set_facecolor("#f4f4f4")
    return figure, axes


def new_figure(*, height: float, width: float = WIDTH) -> tuple[Figure, Axes]:
    """Return an empty figure, its sides in inches."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=DOTS_PER_INCH, layout="constrained")
    return figure, figure.add_subplot()


def png(figure: Figure) -> bytes:
    """Return a figure as PNG, the same bytes every time."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()

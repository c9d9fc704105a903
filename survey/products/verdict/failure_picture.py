"""The map of failures as a picture."""

from __future__ import annotations

import numpy as np

from survey.products.report.maps import STATE_LOOKS, map_axes, png
from survey.products.verdict.failures import (
    DEPTH_ERROR,
    FALSE_BOTTOM,
    FIRST_HOLE,
    HOLE,
    MEETS,
    OUTSIDE,
    PLACE_ERROR,
    TOO_FEW_TIMES,
    FailureMap,
)

LOOKS = {
    MEETS: "#cfe3d4",
    DEPTH_ERROR: "#d55e00",
    FALSE_BOTTOM: "#7b3294",
    PLACE_ERROR: "#e69f00",
    TOO_FEW_TIMES: "#b8b8b8",
}


def failure_picture(failures: FailureMap) -> bytes:
    """Return a map as PNG: what meets the order, and each cause of failure with its share."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    cells = failures.passes.cells
    figure, axes = map_axes(cells)
    wet = failures.state != OUTSIDE
    handles = []
    for state in np.unique(failures.state[wet]).tolist():
        here = failures.state == state
        colour = LOOKS[state] if state < FIRST_HOLE else STATE_LOOKS[state - HOLE][1]
        words = "meets the order" if state == MEETS else failures.cause(state)
        share = 100.0 * here.sum() / wet.sum()
        handles.append(Patch(color=colour, label=f"{words} ({share:.1f} %)"))
        axes.imshow(
            np.ma.masked_array(np.ones(here.shape), ~here),
            cmap=ListedColormap([colour]),
            extent=cells.extent,
            interpolation="nearest",
        )
    if failures.lost:
        places = np.array([[cube.cube.east, cube.cube.north] for cube in failures.lost])
        places += failures.origin[:2]
        marks = axes.scatter(*places.T, marker="s", color="#000000", label="cube not found")
        handles.append(marks)  # type: ignore[arg-type]
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
    return png(figure)

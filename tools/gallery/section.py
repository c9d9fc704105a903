"""Bottom points from the side, before the true bed."""

from __future__ import annotations

import numpy as np

from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.opened.run import Run
from survey.products.report.curves import BLUE, GREY, ORANGE
from survey.products.report.maps import new_figure, png

HALF_WIDTH = 2.5  # [m]
STEP = 0.5  # [m]


def section(run: Run) -> bytes:
    """Return a picture of the points of a strip along the flight, right and false ones."""
    level = run.scenario.surface.water_level_m
    places = run.cloud.position[:, :2]
    low, high = places.min(axis=0), places.max(axis=0)
    along = int(np.argmax(high - low))
    across = 1 - along
    middle = 0.5 * (low + high)[across]
    strip = run.bottom[np.abs(run.bottom.position[:, across] - middle) < HALF_WIDTH]
    false = np.abs(strip.error) > FALSE_BOTTOM_ERROR

    line = np.arange(low[along], high[along], STEP)
    both = (line, np.full_like(line, middle))
    bed = run.seabed.elevation_at(both[along], both[across])

    drawing, axes = new_figure(height=4.2)
    axes.axhline(0.0, color=BLUE, lw=0.8, label="water level")
    axes.plot(line, level - bed, color=GREY, lw=1.5, label="true bed")
    for which, colour, words in ((~false, BLUE, "bottom points"), (false, ORANGE, "false ones")):
        axes.scatter(
            strip.position[which, along],
            level - strip.position[which, 2],
            s=3.0,
            color=colour,
            label=f"{words}: {int(which.sum()):,}",
        )
    axes.invert_yaxis()
    axes.set_xlabel(f"{'easting' if along == 0 else 'northing'} from the origin [m]")
    axes.set_ylabel("depth [m]")
    axes.spines[["top", "right"]].set_visible(False)
    drawing.legend(loc="outside upper center", ncols=4, frameon=False, markerscale=3.0)
    return png(drawing)

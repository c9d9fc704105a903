"""The flight as the page's frame slider shows it: places, headings, footprints."""

from __future__ import annotations

from typing import Any

import numpy as np

from viewer.flashes import flashes_of
from viewer.run_folder import FlownSurvey


def flight_of(flown: FlownSurvey) -> dict[str, Any]:
    """Return frames, lines, places (m, local), headings (rad) and footprints' corners as lists.

    Only frames that have a point are listed, in the order of their numbers.
    """
    flashes = flashes_of(flown)
    return {
        "frame": flashes.frame.tolist(),
        "line": flashes.line.tolist(),
        "position": np.round(flashes.position, 2).tolist(),
        "heading": np.round(flashes.heading, 4).tolist(),
        "corners": np.round(flashes.corners, 2).tolist(),
    }

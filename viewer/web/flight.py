"""The flight as the page's frame slider shows it: places, headings, footprints."""

from __future__ import annotations

from typing import Any

import numpy as np

from survey.cloud.points import PointCloud
from viewer.run_folder import FlownSurvey
from viewer.scene import footprint


def flight_of(flown: FlownSurvey) -> dict[str, Any]:
    """Return frames, lines, places (m, local), headings (rad) and footprints' corners as lists.

    Only frames that have a point are listed, in the order of their numbers.
    """
    corners = _corners(flown.bottom)
    listed = [place for place in np.argsort(flown.frame) if int(flown.frame[place]) in corners]
    return {
        "frame": [int(flown.frame[place]) for place in listed],
        "line": [int(flown.line[place]) for place in listed],
        "position": np.round(flown.positions[listed], 2).tolist(),
        "heading": np.round(flown.headings[listed], 4).tolist(),
        "corners": [corners[int(flown.frame[place])] for place in listed],
    }


def _corners(bottom: PointCloud) -> dict[int, list[list[float]]]:
    """Return the corners (4, 3) of every frame's footprint [m], by the number of the frame."""
    order = np.argsort(bottom.frame, kind="stable")
    frames, starts = np.unique(bottom.frame[order], return_index=True)
    members = np.split(order, starts[1:])
    return {
        int(frame): np.round(footprint(bottom.select(member), int(frame)), 2).tolist()
        for frame, member in zip(frames, members, strict=True)
    }

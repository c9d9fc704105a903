"""What the window says of its state, in lines."""

from __future__ import annotations

import numpy as np

from survey.cloud.points import Cause, PointClass
from viewer.attributes import elevation_error
from viewer.desktop.content import Content
from viewer.desktop.state import Layer, Pick, ViewState

NAMES = {
    Layer.BOTTOM: "bottom",
    Layer.OTHER: "pixels without a bottom",
    Layer.SURFACE: "sea",
}


def state_words(state: ViewState, content: Content, drawn: dict[Layer, int]) -> str:
    """Return title, flash, how many points are drawn, and what a click does.

    Parameters
    ----------
    state : ViewState
    content : Content
    drawn : dict
        Points drawn of every cloud that is shown.
    """
    flashes = content.flashes
    lines = [
        content.flown.title,
        f"frame {flashes.frame[state.frame]} of line {flashes.line[state.frame]} "
        f"({state.frame + 1} of {state.frames}), points of {state.reach}",
        *(
            f"{count:,} of {len(content.clouds[layer]):,} points: {NAMES[layer]}"
            for layer, count in drawn.items()
        ),
    ]
    if state.measuring:
        lines.append(f"profile: click its {'second' if state.ends else 'first'} end")
    if state.picked is not None:
        lines += ["", *pick_words(state.picked, content)]
    return "\n".join(lines)


def pick_words(pick: Pick, content: Content) -> list[str]:
    """Return the numbers of a picked point."""
    cloud = content.clouds[pick.layer].select(np.array([pick.index]))
    frame, row, column = address_of(pick, content)
    x, y, z = cloud.position[0]
    kind = PointClass(int(cloud.classification[0])).name.lower().replace("_", " ")
    place = content.flown.map_frame
    lines = [
        f"picked: {kind}, frame {frame}, row {row}, column {column}",
        f"easting {place.easting + x:.2f}, northing {place.northing + y:.2f}, up {z:.3f} m",
    ]
    if pick.layer is Layer.OTHER:
        return lines
    uncertainty = f"TVU {cloud.tvu[0]:.3f} m, THU {cloud.thu[0]:.2f} m"
    return [
        *lines,
        f"depth {content.flown.water_level - z:.3f} m, error {elevation_error(cloud)[0]:+.3f} m",
        f"{uncertainty}, signal-to-noise ratio {cloud.snr[0]:.1f}",
        f"moved most by {Cause(int(cloud.cause[0])).name.lower().replace('_', ' ')}",
    ]


def address_of(pick: Pick, content: Content) -> tuple[int, int, int]:
    """Return frame, row and column of the pixel that saw a picked point."""
    cloud, index = content.clouds[pick.layer], pick.index
    return int(cloud.frame[index]), int(cloud.row[index]), int(cloud.column[index])

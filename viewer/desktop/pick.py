"""Which point is clicked: by arithmetic, so that no window is needed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from viewer.view import View

FloatArray = NDArray[np.float64]
REACH = 8.0
"""So near a click must be to a point [pixels]."""


def nearest(
    places: FloatArray, view: View, at: tuple[float, float], *, reach: float = REACH
) -> int | None:
    """Return the number of the point that is clicked, None for a click beside all.

    Of those within the reach it is the one nearest the eye, with a pixel beside the click as far
    as so many pixels further away.

    Parameters
    ----------
    places : array (n, 3)
        As drawn, heights stretched [m].
    view : View
    at : (x, y)
        Of the click, from the lower left corner [pixels].
    reach : float
        [pixels]
    """
    if len(places) == 0:
        return None
    beside = np.hypot(*(view.pixels(places) - at).T)
    near = np.flatnonzero(beside <= reach)
    if near.size == 0:
        return None
    further = -(places[near] - view.centre) @ view.towards / view.metres_per_pixel
    return int(near[np.argmin(further + beside[near])])

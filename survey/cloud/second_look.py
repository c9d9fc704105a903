"""Weak echoes that a pixel alone does not believe, kept for the frames that look there too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from survey.cloud.bottom_search import BottomSearch
from survey.cloud.echo import Echo
from survey.cloud.matched import MatchedSearch
from survey.cloud.noise import Readout
from survey.cloud.points import PointClass, PointCloud


def second_echo(
    search: BottomSearch, *, counts: Readout, bottom: Echo, rate: float | None
) -> Echo | None:
    """Return what the matched filter finds at a laxer rate in pixels that have no echo.

    Parameters
    ----------
    search : BottomSearch
        That of the flash. Only a `MatchedSearch` looks twice.
    counts : array (rows, columns, bins)
        Readings.
    bottom : Echo
        What was found at the stated rate.
    rate : float or None
        False-alarm rate of the second look, of a pixel and flash [1]; None: there is none.

    Returns
    -------
    Echo or None
        None where nothing was looked for, or nothing found.
    """
    if rate is None or not isinstance(search, MatchedSearch) or bottom.found.all():
        return None
    missing = ~bottom.found
    weak = search.at_rate(rate).echo(counts, missing).only(missing)
    return weak if weak.found.any() else None


def weak_points(places: PointCloud, weak: Echo) -> PointCloud:
    """Return the weak echoes of a frame as candidates for a bottom, class 40 all of them.

    Parameters
    ----------
    places : PointCloud
        One point a pixel, placed by the weak echoes: see `bottom_points`.
    weak : Echo
    """
    wet = places.classification != PointClass.GROUND
    chosen = places.select(weak.found[places.row, places.column] & wet)
    return replace(
        chosen, classification=np.full(len(chosen), PointClass.BATHYMETRIC, dtype=np.uint8)
    )

"""Mission time as the GPS time that LAS files carry."""

from __future__ import annotations

from datetime import UTC, date, datetime

import numpy as np
from numpy.typing import NDArray

GPS_EPOCH = datetime(1980, 1, 6, tzinfo=UTC)
ADJUSTED_STANDARD_OFFSET_S = 1_000_000_000
"""Subtracted by the LAS 1.4 specification, R15, table 4, GPS time type."""

LEAP_DAYS = tuple(
    date.fromisoformat(day)
    for day in (
        *("1981-07-01", "1982-07-01", "1983-07-01", "1985-07-01", "1988-01-01", "1990-01-01"),
        *("1991-01-01", "1992-07-01", "1993-07-01", "1994-07-01", "1996-01-01", "1997-07-01"),
        *("1999-01-01", "2006-01-01", "2009-01-01", "2012-07-01", "2015-07-01", "2017-01-01"),
    )
)
"""First days after a leap second since the GPS epoch (IERS Bulletin C): 18 s since 2017."""


def adjusted_gps_time(start_utc: datetime, seconds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return adjusted standard GPS time, GPS seconds less 1e9 [s].

    Parameters
    ----------
    start_utc : datetime
        Start of the mission, with its time zone.
    seconds : array (n,)
        Time since then [s].

    Raises
    ------
    ValueError
        If ``start_utc`` has no time zone or lies before the GPS epoch.

    Examples
    --------
    >>> start = datetime(2020, 1, 1, tzinfo=UTC)
    >>> adjusted_gps_time(start, np.array([0.0, 0.5]))
    array([2.61872018e+08, 2.61872018e+08])
    """
    if start_utc.tzinfo is None:
        raise ValueError("start_utc: no time zone. Give the time as UTC, for example with a Z")
    if start_utc < GPS_EPOCH:
        raise ValueError("start_utc: before the GPS epoch, 1980-01-06. Give a later date")
    day = start_utc.astimezone(UTC).date()
    leap_seconds = sum(day >= leap_day for leap_day in LEAP_DAYS)
    start = (start_utc - GPS_EPOCH).total_seconds() + leap_seconds - ADJUSTED_STANDARD_OFFSET_S
    return np.asarray(start + seconds, dtype=np.float64)

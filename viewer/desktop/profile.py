"""A profile across two picked points: what was measured near the line, and the true seabed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from survey.products.report.curves import BLUE, ORANGE
from terrain.seabed import Seabed
from viewer.desktop.pictures import Picture, framed, picture_of
from viewer.desktop.state import Place

FloatArray = NDArray[np.float64]
WIDEST_POINTS = 1.5
"""Half the width of the strip in typical distances of points."""

TRUE_PLACES = 600
SIZE = (7.2, 3.4)


@dataclass(frozen=True, kw_only=True)
class Profile:
    """Heights along a line.

    Parameters
    ----------
    along, elevation : array (n,)
        Of the points in the strip: distance from the first end, and measured elevation [m].
    number : array (n,)
        Of these points in the cloud.
    half_width : float
        Of the strip [m].
    true_along, true_elevation : array (m,)
        The true seabed along the line [m]; empty without one.
    """

    along: FloatArray
    elevation: FloatArray
    number: NDArray[np.intp]
    half_width: float
    true_along: FloatArray
    true_elevation: FloatArray


def profile(
    cloud: PointCloud, ends: tuple[Place, Place], *, spacing: float, seabed: Seabed | None
) -> Profile:
    """Return the profile of a cloud between two places.

    Parameters
    ----------
    cloud : PointCloud
    ends : two of (x, y, z)
        [m, local]
    spacing : float
        Typical distance of the cloud's points [m].
    seabed : Seabed, optional
    """
    start, end = (np.array(place[:2]) for place in ends)
    length = max(float(np.hypot(*(end - start))), 1e-6)
    axis = (end - start) / length
    off = cloud.position[:, :2] - start
    along, across = off @ axis, off @ np.array([-axis[1], axis[0]])
    half_width = WIDEST_POINTS * spacing
    inside = np.flatnonzero((np.abs(across) <= half_width) & (along >= 0.0) & (along <= length))
    true_along = np.linspace(0.0, length, TRUE_PLACES) if seabed else np.zeros(0)
    places = start + true_along[:, None] * axis
    return Profile(
        along=along[inside],
        elevation=cloud.position[inside, 2],
        number=inside,
        half_width=half_width,
        true_along=true_along,
        true_elevation=seabed.elevation_at(*places.T) if seabed else true_along,
    )


def draw_profile(found: Profile, *, water_level: float) -> Picture:
    """Return the profile as depth below the water level."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    axes = figure.subplots()
    axes.plot(
        found.true_along,
        water_level - found.true_elevation,
        color=ORANGE,
        lw=1.4,
        label="true seabed",
        zorder=3.0,
    )
    axes.plot(
        found.along,
        water_level - found.elevation,
        ".",
        color=BLUE,
        ms=4,
        label=f"{len(found.along):,} points within {found.half_width:.1f} m of the line",
    )
    axes.invert_yaxis()
    axes.set_xlabel("distance from the first end [m]")
    axes.set_ylabel("depth below the water level [m]")
    axes.legend(fontsize="small")
    framed(axes)
    return picture_of(figure)

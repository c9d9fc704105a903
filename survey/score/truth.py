"""What is truly at the places of a cloud's points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]

NEAR_SURFACE = 0.75
"""Assumed: as far from the mean level a point may lie to be one of the water surface [m]."""
TRUE_CLASSES = (
    *("ground", "bathymetric_point", "submerged_object", "water_surface"),
    *("within_the_water", "below_the_bottom", "in_the_air", "unknown"),
)
GROUND, SEABED, OBJECT, SURFACE, WITHIN, BELOW, AIR, UNKNOWN = range(len(TRUE_CLASSES))


@dataclass(frozen=True, kw_only=True)
class Truth:
    """Truth at each point of a cloud (n,).

    Parameters
    ----------
    error : array
        Measured less true elevation of seabed, object or land [m]; nan off the known seabed.
    depth : array
        True depth there under mean level, negative on land [m].
    true_class : array
        Index of `TRUE_CLASSES`: what the point lies on, within 1 m of the solid or 0.75 m of the
        water, whichever is nearer; otherwise where it hangs.
    """

    error: FloatArray
    depth: FloatArray
    true_class: NDArray[np.intp]


def truth_at(
    position: FloatArray, seabed: Seabed, *, water_level: float, reach: float = NEAR_SURFACE
) -> Truth:
    """Return the truth at places (n, 3) in the local frame [m].

    Parameters
    ----------
    position : array (n, 3)
    seabed : Seabed
    water_level : float
        True mean level [m].
    reach : float
        How far from it the water may be [m].
    """
    elevation, face = seabed.topmost_at(position[:, 0], position[:, 1])
    error, depth = position[:, 2] - elevation, water_level - elevation
    above_level = np.abs(position[:, 2] - water_level)
    is_object = seabed.is_object[np.maximum(face, 0)]
    on_solid = np.abs(error) <= FALSE_BOTTOM_ERROR
    on_water = (depth > 0.0) & (above_level <= reach) & (above_level < np.abs(error))
    rules = (
        (np.isnan(elevation), UNKNOWN),
        (on_water, SURFACE),
        (on_solid & (depth <= 0.0), GROUND),
        (on_solid & is_object, OBJECT),
        (on_solid, SEABED),
        (error < 0.0, BELOW),
        (position[:, 2] > np.maximum(water_level, elevation), AIR),
    )
    true_class = np.select([rule for rule, _ in rules], [name for _, name in rules], WITHIN)
    return Truth(error=error, depth=depth, true_class=true_class)


def class_name(number: int) -> str:
    """Return the name of a LAS class.

    Examples
    --------
    >>> class_name(40), class_name(3)
    ('40 bathymetric', '3')
    """
    known = {int(known): known.name.lower().replace("_", " ") for known in PointClass}
    return f"{number} {known[number]}" if number in known else str(number)

"""How a movie flies: the pictures between the flashes, and from where each is taken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viewer.desktop.orbit import Orbit
from viewer.desktop.stage import Flash
from viewer.flashes import Flashes

FloatArray = NDArray[np.float64]
PICTURES_A_FLASH = 12
ASIDE = np.radians(35.0)
"""Of the line the eye looks along, beside that of the flight."""

ELEVATION = np.radians(28.0)
HEIGHT_SHARE = 0.5
"""Of the picture's height, for the aircraft above the water."""

LOOK_UP = 0.3
"""The middle of the picture lies so far up from the lit ground to the aircraft."""

SMOOTHED_S = 0.8


@dataclass(frozen=True, kw_only=True)
class Moment:
    """One picture: the flash last made, where the aircraft is, and from where it is seen."""

    place: int
    flash: Flash
    orbit: Orbit


def moments(
    flashes: Flashes,
    *,
    water_level: float,
    exaggeration: float,
    height: int,
    rate: float,
    shortest: float,
    longest: float,
) -> list[Moment]:
    """Return the pictures of a fly-over, in their order.

    Parameters
    ----------
    flashes : Flashes
    water_level : float
        [m, local]
    exaggeration : float
        Of heights about the water level.
    height : int
        Of the picture [pixels].
    rate : float
        Pictures a second [Hz].
    shortest, longest : float
        Of the movie [s].
    """
    count = int(np.clip(PICTURES_A_FLASH * len(flashes), shortest * rate, longest * rate))
    at = np.linspace(0.0, len(flashes) - 1.0, count)
    position = _between(at, flashes.position)
    heading = _between(at, np.unwrap(flashes.heading))
    lit = flashes.corners.mean(axis=1)
    lit[:, 2] = water_level + exaggeration * (lit[:, 2] - water_level)
    aircraft, ground = _smoothed(position, rate), _smoothed(_between(at, lit), rate)
    centre = ground + LOOK_UP * (aircraft - ground)
    facing = _smoothed(heading, rate)
    above = float(np.median(flashes.position[:, 2])) - water_level
    scale = max(above, 1.0) * float(np.cos(ELEVATION)) / (HEIGHT_SHARE * height)
    return [
        Moment(
            place=int(at[i]),
            flash=Flash(
                position=position[i], heading=float(heading[i]), corners=_corners(flashes, at[i])
            ),
            orbit=Orbit(
                centre=(float(centre[i, 0]), float(centre[i, 1]), float(centre[i, 2])),
                azimuth=float(-0.5 * np.pi - facing[i] + ASIDE),
                elevation=float(ELEVATION),
                metres_per_pixel=scale,
            ),
        )
        for i in range(count)
    ]


def _between(at: FloatArray, values: FloatArray) -> FloatArray:
    """Return values (n, ...) between their places, on straight lines."""
    before = np.floor(at).astype(np.intp)
    after = np.minimum(before + 1, len(values) - 1)
    share = (at - before).reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray((1.0 - share) * values[before] + share * values[after])


def _smoothed(values: FloatArray, rate: float) -> FloatArray:
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(values, SMOOTHED_S * rate, axis=0, mode="nearest"))


def _corners(flashes: Flashes, at: float) -> FloatArray:
    """Return the footprint between two flashes of a line; from one line to the next the last."""
    before = int(at)
    after = min(before + 1, len(flashes) - 1)
    if flashes.line[before] != flashes.line[after]:
        return np.asarray(flashes.corners[before])
    return np.asarray(_between(np.array([at]), flashes.corners)[0])

"""Power at the receiver: lidar equation, pulse shape, surface spike; per area of the aperture.

Depth is half of the path in the water; the laser's pulse, a Gaussian in time, is one in depth too.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light
from scipy.special import erf

from survey.optics.interface import fresnel_reflectance
from survey.paper import instrument
from survey.transport.response_walks import Footprint
from survey.transport.scene import kernel_sea
from survey.transport.surface import glint_per_steradian
from terrain.sea_surface import SeaSurface

FloatArray = NDArray[np.float64]

SPEED = 0.5 * speed_of_light / instrument.INDEX  # of depth in time [m/s]
PULSE_SIGMA = instrument.LASER.pulse_sigma * SPEED  # of the pulse in depth [m]
PIXEL_ENERGY = instrument.LASER.pulse_energy / instrument.PIXELS  # launched into a pixel [J]
FOOTPRINT = Footprint(
    side=instrument.PIXEL_ANGLE * instrument.HEIGHT,
    growth=instrument.PIXEL_ANGLE / instrument.INDEX,
)
"""A pixel of 8 mrad at the surface, 200 m below, and refracted: 1.6 m, and 1.9 m at 50 m."""


def energy_at(depth: FloatArray) -> FloatArray:
    """Energy at the receiver for each unit of radiance over irradiance [J/m2].

    E T^2 / (n H + z)^2: a pixel's energy, through the surface twice at normal incidence, the
    radiance law on the way out, and the cone that widens with range. No atmosphere.

    Parameters
    ----------
    depth : array
        z [m].

    Examples
    --------
    >>> f"{energy_at(np.array([50.0]))[0]:.2e}"
    '4.70e-09'
    """
    transmittance = 1.0 - fresnel_reflectance(1.0, 1.0 / instrument.INDEX)
    return PIXEL_ENERGY * transmittance**2 / (instrument.INDEX * instrument.HEIGHT + depth) ** 2


def surface_energy() -> float:
    """Energy of the surface's own echo in a pixel at nadir [J/m2], facets after Cox and Munk."""
    sea = SeaSurface.from_wind(level=0.0, wind_speed=instrument.WIND_SPEED, wind_from=0.0)
    glint = glint_per_steradian(kernel_sea(sea), instrument.INDEX, 0.0, 0.0, -1.0)
    return PIXEL_ENERGY * glint / instrument.HEIGHT**2


def blurred(*, energy: FloatArray, edges: FloatArray, depth: FloatArray) -> FloatArray:
    """Return the power of light that a pulse of no length would send bin by bin.

    Parameters
    ----------
    energy : array (..., bins)
        At the receiver, spread evenly over each bin [J/m2].
    edges : array (bins + 1,)
        Of half the path, growing [m].
    depth : array (depths,)
        Where the power is wanted [m].

    Returns
    -------
    array (..., depths)
        [W/m2].

    Examples
    --------
    >>> at_once = blurred(energy=np.array([1.0]), edges=np.array([-1e-6, 1e-6]),
    ...                   depth=np.array([0.0]))
    >>> f"{at_once[0] * 10e-9:.3f}"  # of a Gaussian: 2 sqrt(ln 2 / pi) over its width
    '0.939'
    """
    reached = 0.5 * erf((depth[:, None] - edges) / (math.sqrt(2.0) * PULSE_SIGMA))
    share = -np.diff(reached, axis=1) / np.diff(edges)
    return np.asarray(energy @ share.T) * SPEED

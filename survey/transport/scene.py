"""What light meets, as named tuples of numbers and arrays that kernels can take."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.water import Water
from terrain.raycast import SeabedGrid
from terrain.sea_surface import SeaSurface
from terrain.waves.lattice import WaveLattice

FloatArray = NDArray[np.float64]

LEAST_DEVIATION = 0.01
WIDER = 1.5
"""Variance of the facets that are tried on waves over that of all slopes of the sea [1]."""


class Medium(NamedTuple):
    """Water as one walk sees it: what attenuates it, what turns it, how fast it runs."""

    attenuation: float
    scattering: float
    sampler: FloatArray
    sampler_share: float
    speed: float
    refractive_index: float


class Sea(NamedTuple):
    """Mean level, standard deviation of the facet slopes on it, and what part is white."""

    level: float
    upwind_deviation: float
    crosswind_deviation: float
    wind_east: float
    wind_north: float
    white: float


class Bounds(NamedTuple):
    """Box in which walks are followed, the seabed's range and mean depth in it, the latest time."""

    west: float
    east: float
    south: float
    north: float
    lowest: float
    highest: float
    depth: float
    latest: float


class Scene(NamedTuple):
    """Everything that stands still during one flash.

    The facets of ``sea`` stand on ``waves``: a level sheet, and not ``wavy``, where none are
    resolved. ``drawn`` has the facets that tracks of light are tried through: `drawn_sea`.
    """

    sea: Sea
    drawn: Sea
    wavy: bool
    waves: WaveLattice
    grid: SeabedGrid
    reflectance: FloatArray
    bounds: Bounds


def forward_medium(water: Water) -> Medium:
    """Return the water for walks of every scattering order: absorbed along, scattered in full."""
    return Medium(
        attenuation=water.absorption,
        scattering=water.scattering,
        sampler=water.phase_function.sampler_table(),
        sampler_share=1.0,
        speed=speed_of_light / water.group_index,
        refractive_index=water.refractive_index,
    )


def restricted_medium(water: Water, *, split_angle: float) -> Medium:
    """Return the water for walks after the last turn.

    Only scatterings by at most ``split_angle`` [rad] are followed; all others attenuate. With F
    the share of the phase function within that angle, the walk scatters by b F and its weight
    decays by a + b (1 - F): together the full beam attenuation c, the phase function restricted
    and not renormalised.
    """
    share = water.phase_function.fraction_within(split_angle)
    return Medium(
        attenuation=water.absorption + water.scattering * (1.0 - share),
        scattering=water.scattering * share,
        sampler=water.phase_function.sampler_table(),
        sampler_share=share,
        speed=speed_of_light / water.group_index,
        refractive_index=water.refractive_index,
    )


def kernel_sea(surface: SeaSurface) -> Sea:
    """Return a sea surface as kernels take it, all its slopes on the mean level."""
    return _sea(surface, surface.upwind_slope_variance, surface.crosswind_slope_variance)


def facet_sea(surface: SeaSurface) -> Sea:
    """Return the facets on the resolved waves.

    Departure: on waves they have a r.m.s. slope of at least `LEAST_DEVIATION`, so that every place
    can be lit through each of them.
    """
    if surface.waves is None:
        return kernel_sea(surface)
    return _sea(surface, *(max(v, LEAST_DEVIATION**2) for v in surface.remaining_slope_variance))


def drawn_sea(surface: SeaSurface) -> Sea:
    """Return the facets that tracks of light are tried through on waves, wherever they enter.

    Their slopes spread wider than those of waves and facets together, so that no facet is much more
    likely at a place than it is tried there.
    """
    if surface.waves is None:
        return kernel_sea(surface)
    facets = facet_sea(surface)
    along, across = surface.along_and_across(surface.waves.slope_covariance)
    return facets._replace(
        upwind_deviation=(WIDER * (facets.upwind_deviation**2 + along)) ** 0.5,
        crosswind_deviation=(WIDER * (facets.crosswind_deviation**2 + across)) ** 0.5,
    )


def _sea(surface: SeaSurface, upwind_variance: float, crosswind_variance: float) -> Sea:
    return Sea(
        level=surface.level,
        upwind_deviation=upwind_variance**0.5,
        crosswind_deviation=crosswind_variance**0.5,
        wind_east=float(np.sin(surface.wind_from)),
        wind_north=float(np.cos(surface.wind_from)),
        white=surface.whitecap_coverage,
    )

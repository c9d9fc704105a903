"""Light at depths of an even layer under a flat surface, as model comparisons tabulate it.

The setting of Mobley et al., Applied Optics 32, 7484 (1993); the walk is `profile_walk`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.optics.phase import PhaseFunction
from survey.transport.profile_walk import (
    DOWNWARD,
    UPWARD_RADIANCE,
    UPWARD_SCALAR,
    Layer,
    walk_batch,
)

FloatArray = NDArray[np.float64]

CONE_ENTRIES = 1025


@dataclass(frozen=True, kw_only=True)
class LightProfile:
    """Light at each depth with standard errors from independent batches, arrays (levels,).

    Parameters
    ----------
    depth : array
        Optical depth below the surface [1].
    downward : array
        Plane irradiance from above, E_d [W/m2].
    upward_scalar : array
        Scalar irradiance from below, E_ou [W/m2].
    upward_radiance : array
        Radiance from straight below, L_u, mean over a narrow cone [W/(m2 sr)].
    downward_error, upward_scalar_error, upward_radiance_error : array
        Their standard errors.
    """

    depth: FloatArray
    downward: FloatArray
    downward_error: FloatArray
    upward_scalar: FloatArray
    upward_scalar_error: FloatArray
    upward_radiance: FloatArray
    upward_radiance_error: FloatArray

    @property
    def diffuse_attenuation(self) -> FloatArray:
        """Attenuation of E_d between neighbouring levels over c: K_d / c, (levels - 1,) [1]."""
        return np.asarray(-np.diff(np.log(self.downward)) / np.diff(self.depth))


def cone_average(*, phase_function: PhaseFunction, half_angle: float) -> FloatArray:
    """Return the phase function averaged over a cone, by the angle to the cone's axis.

    A ring of scattering angles is in the cone for azimuths up to
    acos[(cos cone - cos angle cos axis) / (sin angle sin axis)]; the rings are summed.

    Returns
    -------
    average : array (1025,)
        At axis angles even from 0 to pi [1/sr].

    Raises
    ------
    ValueError
        When the half angle does not lie between 0 and pi / 2.
    """
    if not 0.0 < half_angle < 0.5 * math.pi:
        raise ValueError(f"half_angle = {half_angle:g}: must lie between 0 and pi / 2")
    edges = np.concatenate([[0.0], phase_function.angle])
    light = np.diff(np.concatenate([[0.0], phase_function.cumulative_on_grid]))
    ring = 0.5 * (edges[1:] + edges[:-1])
    cosine, sine = np.cos(ring), np.maximum(np.sin(ring), 1e-300)
    average = np.empty(CONE_ENTRIES)
    for i, axis in enumerate(np.linspace(0.0, np.pi, CONE_ENTRIES)):
        ahead = math.cos(half_angle) - cosine * math.cos(axis)
        within = ahead / (sine * max(math.sin(axis), 1e-15))
        average[i] = np.sum(light * np.arccos(np.clip(within, -1.0, 1.0))) / np.pi
    return average / (2.0 * np.pi * (1.0 - math.cos(half_angle)))


def light_profile(
    *,
    depths: ArrayLike,
    albedo: float,
    phase_function: PhaseFunction,
    irradiance: float = 1.0,
    index: float = 1.34,
    cos_incidence: float = 1.0,
    bottom_depth: float = math.inf,
    bottom_reflectance: float = 0.0,
    cone: float = math.radians(3.0),
    walks: int = 1_000_000,
    batches: int = 64,
    seed: int = 1,
) -> LightProfile:
    """Return the light under a flat surface, lit from a black sky by a parallel beam.

    Parameters
    ----------
    depths : array (levels,)
        Optical depths c z, above 0, none below the bottom [1].
    albedo : float
        Scattering over attenuation, above 0 to 1, below 1 where there is no bottom [1].
    phase_function : PhaseFunction
    irradiance : float
        Of the beam in air on the level surface [W/m2].
    index : float
        Refractive index of the water over that of the air; the surface reflects inside too [1].
    cos_incidence : float
        Cosine of the beam's zenith angle in air, above 0 to 1 [1].
    bottom_depth, bottom_reflectance : float
        Optical depth and reflectance of a Lambertian bottom; infinite depth is none [1].
    cone : float
        Half angle of the cone about the vertical that the radiance is averaged over [rad].
    walks, batches, seed : int
        Photons in all, independent batches for the errors, seed.

    Raises
    ------
    ValueError
        When arguments lie outside their range.

    Examples
    --------
    >>> from survey.optics.phase import molecular
    >>> profile = light_profile(depths=[1.0], albedo=1e-9, phase_function=molecular(), walks=640)
    >>> round(float(profile.downward[0]), 4)
    0.3601
    """
    levels = np.atleast_1d(np.asarray(depths, dtype=np.float64))
    layer = Layer(
        levels=levels,
        albedo=albedo,
        sampler=phase_function.sampler_table(),
        cone=cone_average(phase_function=phase_function, half_angle=cone),
        refractive_index=index,
        cos_incidence=cos_incidence,
        bottom=bottom_depth,
        bottom_reflectance=bottom_reflectance,
    )
    _require(layer=layer, walks=walks, batches=batches)
    tally = np.zeros((batches, 3, len(levels)))
    for batch in range(batches):
        walk_batch(tally[batch], layer, seed, batch, walks // batches)
    share = tally * irradiance / (walks // batches)
    mean, error = share.mean(axis=0), share.std(axis=0, ddof=1) / math.sqrt(batches)
    return LightProfile(
        depth=levels,
        downward=mean[DOWNWARD],
        downward_error=error[DOWNWARD],
        upward_scalar=mean[UPWARD_SCALAR],
        upward_scalar_error=error[UPWARD_SCALAR],
        upward_radiance=mean[UPWARD_RADIANCE],
        upward_radiance_error=error[UPWARD_RADIANCE],
    )


def _require(*, layer: Layer, walks: int, batches: int) -> None:
    endless = math.isinf(layer.bottom)
    faults = [
        message
        for good, message in (
            (layer.levels.size and np.all(layer.levels > 0.0), "depths must be above 0"),
            (np.all(layer.levels <= layer.bottom), "depths must not lie below bottom_depth"),
            (0.0 < layer.albedo <= 1.0, "albedo must lie in 0 to 1, 0 excluded"),
            (layer.albedo < 1.0 or not endless, "albedo must be below 1 where there is no bottom"),
            (layer.refractive_index >= 1.0, "index must be at least 1"),
            (0.0 < layer.cos_incidence <= 1.0, "cos_incidence must lie in 0 to 1, 0 excluded"),
            (layer.bottom > 0.0, "bottom_depth must be above 0"),
            (0.0 <= layer.bottom_reflectance <= 1.0, "bottom_reflectance must lie in 0 to 1"),
            (2 <= batches <= walks, "batches must be 2 or more and walks no fewer"),
        )
        if not good
    ]
    if faults:
        raise ValueError("profile: " + "; ".join(faults))

"""A slab of scattering matter, as published benchmarks have it: reflectance, transmittance, R(t).

Plain analogue walk: free paths by the full attenuation, absorption as the albedo at each
collision. It shares the phase function and the random numbers with the engines, nothing else.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.interface import fresnel_reflectance, refracted
from survey.optics.phase import PhaseFunction
from survey.transport.directions import drawn, lambert_direction, turned
from survey.transport.random import REFERENCE, exponential, start_stream, uniform
from terrain.kernels import kernel, leaf_kernel

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class SlabResult:
    """What a slab sends back and lets through, each with its standard error.

    Parameters
    ----------
    reflectance, transmittance : float
        Shares of the incident light [1]; the mirror reflection of the top is part of the first.
    reflectance_error, transmittance_error : float
        Standard errors from independent batches [1].
    time_resolved, time_resolved_error : array (bins,)
        R(t): the reflectance by path length inside, in bins of ``path_bin`` mean free paths, the
        mirror reflection in the first and all that comes late in the last, and its errors [1].
    path_bin : float
        Width of a bin [mean free paths].
    """

    reflectance: float
    reflectance_error: float
    transmittance: float
    transmittance_error: float
    time_resolved: FloatArray
    time_resolved_error: FloatArray
    path_bin: float

    def arrival_times(self, *, attenuation: float, group_index: float) -> FloatArray:
        """Return the edges of the bins of R(t) after the light went in, (bins + 1,) [s].

        Parameters
        ----------
        attenuation : float
            Beam attenuation c inside, inverse of the mean free path [1/m].
        group_index : float
            Light travels at the vacuum's speed over this [1].
        """
        edges = self.path_bin * np.arange(len(self.time_resolved) + 1.0)
        edges[-1] = np.inf
        return np.asarray(edges * group_index / (attenuation * speed_of_light))


@leaf_kernel
def _slab_walk(
    sent: FloatArray,
    tau: float,
    albedo: float,
    sampler: FloatArray,
    index: float,
    cos_incidence: float,
    bottom: float,
    path_bin: float,
    state: NDArray[np.uint64],
) -> None:
    """Follow one photon from the top (tau 0) to where it ends: sent[0] back, sent[1] through."""
    specular = fresnel_reflectance(cos_incidence, 1.0 / index) if index != 1.0 else 0.0
    sent[0] += specular
    sent[2] += specular
    weight = 1.0 - specular
    sine = math.sqrt(1.0 - cos_incidence * cos_incidence)
    dx, dy, dz = refracted(sine, 0.0, -cos_incidence, 0.0, 0.0, 1.0, 1.0 / index)
    t, path = 0.0, 0.0
    while weight > 0.0:
        free = exponential(state)
        wall = t / dz if dz > 0.0 else (tau - t) / -dz if dz < 0.0 else math.inf
        path += min(free, wall)
        if free < wall:
            t -= dz * free
            if weight < 1e-4:
                weight = weight * 10.0 if uniform(state) < 0.1 else 0.0
            weight *= albedo
            azimuth = 2.0 * math.pi * uniform(state)
            dx, dy, dz = turned(dx, dy, dz, drawn(sampler, 1.0, state), azimuth)
        elif dz > 0.0:
            t = 0.0
            if index != 1.0 and uniform(state) < fresnel_reflectance(dz, index):
                dz = -dz
                continue
            sent[0] += weight
            sent[2 + min(int(path / path_bin), sent.shape[0] - 3)] += weight
            return
        else:
            t = tau
            sent[1] += weight * (1.0 - bottom)
            weight *= bottom
            dx, dy, dz = lambert_direction(0.0, 0.0, 1.0, state)


@kernel
def _slab_batch(
    sent: FloatArray,
    tau: float,
    albedo: float,
    sampler: FloatArray,
    index: float,
    cos_incidence: float,
    bottom: float,
    path_bin: float,
    seed: int,
    batch: int,
    walks: int,
) -> None:
    state = np.empty(2, np.uint64)
    for i in range(walks):
        start_stream(state, seed, REFERENCE, 1, batch, i)
        _slab_walk(sent, tau, albedo, sampler, index, cos_incidence, bottom, path_bin, state)


def slab(
    *,
    optical_thickness: float,
    albedo: float,
    phase_function: PhaseFunction,
    index: float = 1.0,
    cos_incidence: float = 1.0,
    bottom_reflectance: float = 0.0,
    walks: int = 1_000_000,
    batches: int = 64,
    path_bin: float = 0.25,
    path_bins: int = 200,
    seed: int = 1,
) -> SlabResult:
    """Return reflectance and transmittance of a plane slab under a parallel beam.

    Parameters
    ----------
    optical_thickness : float
        Attenuation coefficient times thickness, above 0; may be infinite [1].
    albedo : float
        Scattering over attenuation, 0 to 1 [1].
    phase_function : PhaseFunction
    index : float
        Refractive index of the slab over that above it; the lower side is matched [1].
    cos_incidence : float
        Cosine of the angle of incidence above the slab, above 0 to 1 [1].
    bottom_reflectance : float
        Lambertian reflectance under the slab [1]; what it absorbs counts as transmitted.
    walks, batches, seed : int
        Photons in all, independent batches for the error, seed.
    path_bin, path_bins
        Width [mean free paths] and number of bins of the time-resolved reflectance; the last bin
        takes all that comes later.

    Raises
    ------
    ValueError
        When an argument lies outside its range, all of them named at once.

    Examples
    --------
    >>> from survey.optics.phase import henyey_greenstein
    >>> thin = slab(optical_thickness=1e-9, albedo=0.9, phase_function=henyey_greenstein(0.0),
    ...             walks=640)
    >>> thin.reflectance, thin.transmittance
    (0.0, 1.0)
    """
    faults = [
        message
        for bad, message in (
            (not optical_thickness > 0.0, "optical_thickness must be above 0"),
            (not 0.0 <= albedo <= 1.0, "albedo must lie in 0 to 1"),
            (not 0.0 <= bottom_reflectance <= 1.0, "bottom_reflectance must lie in 0 to 1"),
            (not 0.0 < cos_incidence <= 1.0, "cos_incidence must lie in 0 to 1, 0 excluded"),
            (not index >= 1.0, "index must be at least 1"),
            (
                albedo == 1.0 and math.isinf(optical_thickness),
                "albedo must be below 1 where the thickness has no end",
            ),
            (not path_bin > 0.0 or path_bins < 1, "path_bin and path_bins must be above 0"),
            (batches < 2 or walks < batches, "batches must be 2 or more and walks no fewer"),
        )
        if bad
    ]
    if faults:
        raise ValueError("slab: " + "; ".join(faults))
    sent = np.zeros((batches, 2 + path_bins))
    per_batch = walks // batches
    sampler = phase_function.sampler_table()
    for batch in range(batches):
        _slab_batch(
            sent[batch], optical_thickness, albedo, sampler, index, cos_incidence,
            bottom_reflectance, path_bin, seed, batch, per_batch,
        )  # fmt: skip
    share = sent / per_batch
    mean, error = share.mean(axis=0), share.std(axis=0, ddof=1) / np.sqrt(batches)
    return SlabResult(
        reflectance=float(mean[0]),
        reflectance_error=float(error[0]),
        transmittance=float(mean[1]),
        transmittance_error=float(error[1]),
        time_resolved=mean[2:],
        time_resolved_error=error[2:],
        path_bin=path_bin,
    )

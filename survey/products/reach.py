"""To which depth a mission found the bottom, in metres and in optical depths."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from survey.optics.water import Water
from survey.optics.water.apparent import lee_diffuse_attenuation

DEPTHS = ("found_depth", "half_found_depth", "detection_depth")


@dataclass(frozen=True, kw_only=True)
class WaterClarity:
    """What turns a depth z into the optical depths c z and K_d z.

    Parameters
    ----------
    attenuation : float
        Beam attenuation c [1/m].
    diffuse_attenuation : float
        K_d [1/m].
    """

    attenuation: float
    diffuse_attenuation: float

    @classmethod
    def of(cls, water: Water) -> WaterClarity:
        """Return that of a water, K_d by Lee et al. (2005) under a sun at the zenith.

        Examples
        --------
        >>> from survey.optics.water import petzold_water
        >>> water = petzold_water("coastal", refractive_index=1.33, group_index=1.33)
        >>> f"{WaterClarity.of(water).diffuse_attenuation:.3f} 1/m"
        '0.190 1/m'
        """
        return cls(
            attenuation=water.attenuation,
            diffuse_attenuation=lee_diffuse_attenuation(
                absorption=water.absorption,
                backscattering=water.scattering * water.phase_function.backscatter_fraction,
                sun_zenith=0.0,
            ),
        )


def optical_depths(metrics: Mapping[str, Any], clarity: WaterClarity) -> dict[str, float | None]:
    """Return c, K_d and, for each value named ``*_depth_m``, c z and K_d z; None where it is None.

    Examples
    --------
    >>> found = {"found_depth_m": 4.5, "half_found_depth_m": 8.0, "detection_depth_m": None}
    >>> deep = optical_depths(found, WaterClarity(attenuation=0.4, diffuse_attenuation=0.2))
    >>> deep["found_depth_c_z"], deep["half_found_depth_k_d_z"], deep["detection_depth_c_z"]
    (1.8, 1.6, None)
    """
    c, kd = clarity.attenuation, clarity.diffuse_attenuation
    values: dict[str, float | None] = {"attenuation_per_m": c, "diffuse_attenuation_per_m": kd}
    for name in (key.removesuffix("_m") for key in metrics if key.endswith("_depth_m")):
        depth = metrics[f"{name}_m"]
        values[f"{name}_c_z"] = None if depth is None else c * depth
        values[f"{name}_k_d_z"] = None if depth is None else kd * depth
    return values


def reach_sentence(metrics: Mapping[str, Any]) -> str:
    """Return in one sentence how deep the bottom was found and how deep it should be.

    Examples
    --------
    >>> reach_sentence({
    ...     "found_depth_m": 24.5, "found_depth_c_z": 9.75, "found_depth_k_d_z": 4.66,
    ...     "half_found_depth_m": 26.0, "half_found_depth_c_z": 10.31,
    ...     "half_found_depth_k_d_z": 4.94, "detection_depth_m": None})
    'Of the depths flown, nine pixels in ten found the bottom down to 24.5 m (c z 9.8, K_d z 4.7)
    and one in two down to 26.0 m (c z 10.3, K_d z 4.9); by the detection model nine in ten should
    at no depth.'
    """
    nine, half, expected = (_depth(metrics, name) for name in DEPTHS)
    return (
        f"Of the depths flown, nine pixels in ten found the bottom {nine} and one in two {half}; "
        f"by the detection model nine in ten should {expected}."
    )


def _depth(metrics: Mapping[str, Any], name: str) -> str:
    if metrics[f"{name}_m"] is None:
        return "at no depth"
    depth, attenuated, diffuse = (metrics[f"{name}_{unit}"] for unit in ("m", "c_z", "k_d_z"))
    return f"down to {depth:.1f} m (c z {attenuated:.1f}, K_d z {diffuse:.1f})"

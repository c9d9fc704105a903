"""To which depth a mission found the bottom, in metres and in optical depths."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from survey.optics.water import WaterColumn
from survey.optics.water.apparent import diffuse_attenuation, secchi_depth_of

DEPTHS = ("found_depth", "half_found_depth", "detection_depth")


def optical_depths(metrics: Mapping[str, Any], water: WaterColumn) -> dict[str, float | None]:
    """Return each ``*_depth_m`` as c z, K_d z and Secchi depths; c and K_d under the surface.

    c z and K_d z are integrals over the water's layers, None where the depth is None. K_d is that
    of `diffuse_attenuation`, the Secchi depth that of `secchi_depth_of`.

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> water = WaterColumn.uniform(
    ...     petzold_water("coastal", refractive_index=1.33, group_index=1.33))
    >>> found = {"found_depth_m": 4.5, "half_found_depth_m": 8.0, "detection_depth_m": None}
    >>> deep = optical_depths(found, water)
    >>> round(deep["found_depth_c_z"], 2), round(deep["half_found_depth_k_d_z"], 2)
    (1.79, 1.52)
    >>> deep["detection_depth_c_z"] is None, round(deep["found_depth_secchi"], 2)
    (True, 0.3)
    """
    secchi = secchi_depth_of(water)
    values: dict[str, float | None] = {
        "secchi_depth_m": secchi,
        "attenuation_per_m": water.surface.attenuation,
        "diffuse_attenuation_per_m": diffuse_attenuation(water.surface),
    }
    for name in (key.removesuffix("_m") for key in metrics if key.endswith("_depth_m")):
        depth = metrics[f"{name}_m"]
        known = depth is not None
        values[f"{name}_c_z"] = float(water.attenuated(depth)) if known else None
        values[f"{name}_k_d_z"] = (
            float(water.integral(depth, diffuse_attenuation)) if known else None
        )
        values[f"{name}_secchi"] = depth / secchi if known else None
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

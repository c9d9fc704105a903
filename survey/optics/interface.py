"""Light at the boundary of two media: Snell and Fresnel, as kernels of scalars."""

from __future__ import annotations

import math

from terrain.kernels import leaf_kernel


@leaf_kernel
def transmitted_cosine(cos_in: float, index_ratio: float) -> float:
    """Cosine of refraction by Snell's law; -1 says total internal reflection.

    ``index_ratio`` is the index on the incident side over that on the far side.

    Examples
    --------
    >>> round(transmitted_cosine(1.0, 1 / 1.34), 6), transmitted_cosine(0.5, 1.34)
    (1.0, -1.0)
    """
    squared = 1.0 - index_ratio * index_ratio * (1.0 - cos_in * cos_in)
    if squared <= 0.0:
        return -1.0
    return math.sqrt(squared)


@leaf_kernel
def fresnel_reflectance(cos_in: float, index_ratio: float) -> float:
    """Reflectance of unpolarised light, Fresnel; 1 beyond the critical angle.

    Examples
    --------
    >>> round(fresnel_reflectance(1.0, 1 / 1.34), 4)
    0.0211
    """
    cos_out = transmitted_cosine(cos_in, index_ratio)
    if cos_out < 0.0:
        return 1.0
    across = (index_ratio * cos_in - cos_out) / (index_ratio * cos_in + cos_out)
    within = (cos_in - index_ratio * cos_out) / (cos_in + index_ratio * cos_out)
    return 0.5 * (across * across + within * within)


@leaf_kernel
def refracted(
    dx: float, dy: float, dz: float, mx: float, my: float, mz: float, index_ratio: float
) -> tuple[float, float, float]:
    """Direction after refraction at a facet of unit normal m against the ray (d . m < 0).

    Call it only where `transmitted_cosine` is positive.

    Examples
    --------
    >>> refracted(0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 1 / 1.34)
    (0.0, 0.0, -1.0)
    """
    cos_in = -(dx * mx + dy * my + dz * mz)
    along = index_ratio * cos_in - transmitted_cosine(cos_in, index_ratio)
    return (
        index_ratio * dx + along * mx,
        index_ratio * dy + along * my,
        index_ratio * dz + along * mz,
    )


@leaf_kernel
def reflected(
    dx: float, dy: float, dz: float, mx: float, my: float, mz: float
) -> tuple[float, float, float]:
    """Direction after mirror reflection at a facet of unit normal m.

    Examples
    --------
    >>> reflected(0.6, 0.0, 0.8, 0.0, 0.0, -1.0)
    (0.6, 0.0, -0.8)
    """
    twice = 2.0 * (dx * mx + dy * my + dz * mz)
    return dx - twice * mx, dy - twice * my, dz - twice * mz

"""The wavy surface as kernels take it: a smooth sheet over a lattice, and rays that meet it.

The sheet is the biquadratic B-spline through the elevations at the nodes; its slopes have no steps.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import inlined_kernel, leaf_kernel

CLOSE = 1e-3  # [m]: the step that starts from there leaves 1e-7 m
MOST_STEPS = 60


class WaveLattice(NamedTuple):
    """The sheet over one rectangle at one time.

    ``x0, y0`` of the first node, ``per_cell`` inverse of the spacing, ``nx, ny`` count of nodes.
    ``level`` mean elevation, ``lowest, highest`` bounds of the elevation [m], ``steepest`` of the
    slope. ``coefficients`` (ny, nx) of the spline [m].
    """

    x0: float
    y0: float
    per_cell: float
    nx: int
    ny: int
    level: float
    lowest: float
    highest: float
    steepest: float
    coefficients: NDArray[np.float64]


def build_lattice(
    *, x0: float, y0: float, spacing: float, level: float, coefficients: NDArray[np.float64]
) -> WaveLattice:
    """Return the lattice of spline coefficients (ny, nx) [m], with the bounds they imply.

    Parameters
    ----------
    x0, y0 : float
        Place of the first node [m].
    spacing : float
        Of the nodes [m].
    level : float
        Mean elevation [m].
    coefficients : array (ny, nx)
        At least 3 x 3 [m].
    """
    steps = [np.abs(np.diff(coefficients, axis=axis)).max() / spacing for axis in (0, 1)]
    return WaveLattice(
        x0=x0,
        y0=y0,
        per_cell=1.0 / spacing,
        nx=coefficients.shape[1],
        ny=coefficients.shape[0],
        level=level,
        lowest=float(coefficients.min()),
        highest=float(coefficients.max()),
        steepest=float(np.hypot(*steps)),
        coefficients=np.ascontiguousarray(coefficients),
    )


@leaf_kernel
def elevation_and_slopes(waves: WaveLattice, x: float, y: float) -> tuple[float, float, float]:
    """Return the elevation [m] and the slopes towards east and north at a place.

    Outside the lattice the nearest edge goes on.
    """
    u, v = (x - waves.x0) * waves.per_cell, (y - waves.y0) * waves.per_cell
    i = int(min(max(u + 0.5, 1.0), waves.nx - 2.0))
    j = int(min(max(v + 0.5, 1.0), waves.ny - 2.0))
    u, v = min(max(u - i, -0.5), 0.5), min(max(v - j, -0.5), 0.5)
    a0, a1, a2 = 0.5 * (0.5 - u) * (0.5 - u), 0.75 - u * u, 0.5 * (0.5 + u) * (0.5 + u)
    b0, b1, b2 = u - 0.5, -2.0 * u, u + 0.5
    c = waves.coefficients
    below = a0 * c[j - 1, i - 1] + a1 * c[j - 1, i] + a2 * c[j - 1, i + 1]
    level = a0 * c[j, i - 1] + a1 * c[j, i] + a2 * c[j, i + 1]
    above = a0 * c[j + 1, i - 1] + a1 * c[j + 1, i] + a2 * c[j + 1, i + 1]
    d_below = b0 * c[j - 1, i - 1] + b1 * c[j - 1, i] + b2 * c[j - 1, i + 1]
    d_level = b0 * c[j, i - 1] + b1 * c[j, i] + b2 * c[j, i + 1]
    d_above = b0 * c[j + 1, i - 1] + b1 * c[j + 1, i] + b2 * c[j + 1, i + 1]
    e0, e1, e2 = 0.5 * (0.5 - v) * (0.5 - v), 0.75 - v * v, 0.5 * (0.5 + v) * (0.5 + v)
    return (
        e0 * below + e1 * level + e2 * above,
        (e0 * d_below + e1 * d_level + e2 * d_above) * waves.per_cell,
        ((v - 0.5) * below - 2.0 * v * level + (v + 0.5) * above) * waves.per_cell,
    )


@leaf_kernel
def meets_surface(
    waves: WaveLattice,
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    t_max: float,
) -> tuple[float, float, float]:
    """Return the distance [m] at which a ray first meets the surface, and the slopes there.

    From above or from below; (inf, 0, 0) when it does not within 0 < t <= t_max, which is finite.
    The direction has length one. A ray that starts on the surface may meet it there again: start
    it some micrometres off. Departure: a ray within some degrees of the level may pass unseen
    through a crest that it cuts less than a cell wide.
    """
    across = math.sqrt(dx * dx + dy * dy)
    if abs(dz) > waves.steepest * across:  # steeper than any wave: the line meets it once
        t_high, t_low = (waves.highest - oz) / dz, (waves.lowest - oz) / dz
        first, last = min(t_high, t_low), max(t_high, t_low)
        if last <= 0.0 or first > t_max:
            return np.inf, 0.0, 0.0
        t, slope_x, slope_y = _crossing(waves, ox, oy, oz, dx, dy, dz, first, last, dz < 0.0)
        if 0.0 < t <= t_max:
            return t, slope_x, slope_y
        return np.inf, 0.0, 0.0
    return _search(waves, ox, oy, oz, dx, dy, dz, t_max, 1.0 / (waves.per_cell * across))


@leaf_kernel
def _search(
    waves: WaveLattice,
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    t_max: float,
    stride: float,
) -> tuple[float, float, float]:
    """Step along a flat ray, between trough and crest, until it has changed sides."""
    first, last = 0.0, t_max
    if dz != 0.0:
        t_high, t_low = (waves.highest - oz) / dz, (waves.lowest - oz) / dz
        first, last = max(first, min(t_high, t_low)), min(last, max(t_high, t_low))
    elif oz > waves.highest or oz < waves.lowest:
        return np.inf, 0.0, 0.0
    gap, _, _ = _gap(waves, ox, oy, oz, dx, dy, dz, first)
    above = gap > 0.0 or (gap == 0.0 and dz < 0.0)
    while first < last:
        end = min(first + stride, last)
        gap, _, _ = _gap(waves, ox, oy, oz, dx, dy, dz, end)
        if (gap > 0.0) != above:
            return _crossing(waves, ox, oy, oz, dx, dy, dz, first, end, above)
        first = end
    return np.inf, 0.0, 0.0


@leaf_kernel
def _crossing(
    waves: WaveLattice,
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    first: float,
    last: float,
    above: bool,
) -> tuple[float, float, float]:
    """Return where a ray, at ``first`` above the surface or not, changes sides before ``last``.

    Newton's method from where the mean level is met; a step that leaves the bracket halves it.
    """
    t = 0.5 * (first + last) if dz == 0.0 else min(max((waves.level - oz) / dz, first), last)
    slope_x = slope_y = 0.0
    for _ in range(MOST_STEPS):
        gap, slope_x, slope_y = _gap(waves, ox, oy, oz, dx, dy, dz, t)
        if (gap > 0.0) == above:
            first = t
        else:
            last = t
        step = gap / (dx * slope_x + dy * slope_y - dz)
        if first <= t + step <= last:
            t += step
            if abs(step) < CLOSE:
                break
        else:
            t = 0.5 * (first + last)
    return t, slope_x, slope_y


@inlined_kernel
def _gap(
    waves: WaveLattice, ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, t: float
) -> tuple[float, float, float]:
    """Return how far a point of a ray is above the surface [m], and the slopes there."""
    z, slope_x, slope_y = elevation_and_slopes(waves, ox + dx * t, oy + dy * t)
    return oz + dz * t - z, slope_x, slope_y

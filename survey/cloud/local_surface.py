"""The water's surface from the first echoes of a frame: planes fitted to each neighbourhood."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

REACH = 3.0  # standard deviations to which a neighbourhood's weights are taken
FEWEST = 3.0  # weight that a plane needs


@dataclass(frozen=True, kw_only=True)
class LocalSurface:
    """Planes at the pixels; arrays (rows, columns), nan where too few echoes are near.

    Parameters
    ----------
    elevation : array
        Where the pixel meets the water [m].
    slope : array (rows, columns, 2)
        Towards east and north [1].
    roughness : array
        How far the echoes of a neighbourhood lie about their planes, root mean square; 0 where
        there are no planes [m].
    """

    elevation: FloatArray
    slope: FloatArray
    roughness: FloatArray


def fitted_planes(*, places: FloatArray, used: BoolArray, width: float) -> LocalSurface:
    """Fit a plane to the neighbourhood of each pixel, weighted by a Gaussian of pixels' distance.

    Parameters
    ----------
    places : array (rows, columns, 3)
        Of the first echoes [m].
    used : array (rows, columns)
        Which of them lie on water.
    width : float
        Standard deviation of the weights [pixels].

    Examples
    --------
    >>> row, column = np.mgrid[0:8.0, 0:8.0]
    >>> plane = np.stack([column, row, 0.1 * column - 0.2 * row], axis=-1)
    >>> fit = fitted_planes(places=plane, used=np.ones((8, 8), bool), width=2.0)
    >>> fit.slope[0, 0].round(6).tolist(), bool(np.allclose(fit.elevation, plane[..., 2]))
    ([0.1, -0.2], True)
    """
    from scipy.ndimage import gaussian_filter

    def near(values: FloatArray) -> FloatArray:
        sums = gaussian_filter(values, width, mode="constant", truncate=REACH)
        return np.asarray(sums * 2.0 * np.pi * width**2)

    origin = places[used].mean(axis=0) if used.any() else np.zeros(3)
    x, y, z = np.moveaxis(np.where(used[..., None], places - origin, 0.0), -1, 0)
    one = used.astype(np.float64)
    weight, wx, wy, wz = near(one), near(x), near(y), near(z)
    enough = weight >= FEWEST
    safe = np.where(enough, weight, 1.0)
    mx, my, mz = wx / safe, wy / safe, wz / safe
    xx, xy, yy = (near(a * b) / safe - p * q for a, b, p, q in
                  ((x, x, mx, mx), (x, y, mx, my), (y, y, my, my)))  # fmt: skip
    xz, yz = near(x * z) / safe - mx * mz, near(y * z) / safe - my * mz
    determinant = xx * yy - xy**2
    enough &= determinant > 1e-6 * (xx + yy) ** 2
    determinant = np.where(enough, determinant, np.nan)
    slope = np.stack([yy * xz - xy * yz, xx * yz - xy * xz], axis=-1) / determinant[..., None]
    here = np.where(used[..., None], places - origin, np.nan)
    offset = slope[..., 0] * (here[..., 0] - mx) + slope[..., 1] * (here[..., 1] - my)
    elevation = origin[2] + mz + offset
    about = np.nan_to_num(np.where(used, places[..., 2], np.nan) - elevation)
    roughness = np.sqrt(near(about**2) / safe)
    return LocalSurface(elevation=elevation, slope=slope, roughness=roughness)

"""One colour scale of depth for meshes, maps and pictures."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
COLOURS: Final = "viridis_r"
"""Yellow where shallow, violet where deep; even in lightness, so told apart by the colour-blind."""

LAND = "#c4b28e"
LAND_RGBA = (196, 178, 142, 255)
STEP = 0.5
PERCENTILES = (0.5, 99.5)


def depth_range(depth: FloatArray) -> tuple[float, float]:
    """Return shallow and deep end of the colour scale [m], whole multiples of 0.5 m.

    Nearly all depths above 0 lie between. The scale begins at the water level unless all is
    deeper than half of the deepest, when a scale from 0 would hide the shape.

    Parameters
    ----------
    depth : array (n,)
        Depth, positive down [m]; land (negative) and nan are left out.

    Examples
    --------
    >>> depth_range(np.array([-2.0, 0.2, 7.8])), depth_range(np.array([22.1, 25.3]))
    ((0.0, 8.0), (22.0, 25.5))
    """
    wet = depth[depth > 0.0]
    if wet.size == 0:
        return 0.0, STEP
    low, high = np.percentile(wet, PERCENTILES)
    deep = max(float(np.ceil(high / STEP)) * STEP, STEP)
    dry = bool((depth <= 0.0).any())
    shallow = 0.0 if dry or low < 0.5 * deep else float(np.floor(low / STEP)) * STEP
    return shallow, deep


def depth_colours(depth: FloatArray) -> NDArray[np.uint8]:
    """Return RGBA (n, 4) on the scale of `depth_range`; land is sand-coloured."""
    from matplotlib import colormaps

    shallow, deep = depth_range(depth)
    share = np.clip((depth - shallow) / (deep - shallow), 0.0, 1.0)
    colours = colormaps[COLOURS](share, bytes=True)
    colours[depth <= 0.0] = LAND_RGBA
    return np.asarray(colours, dtype=np.uint8)

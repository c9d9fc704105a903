"""From where a survey is looked at: a parallel view whose pixels are known by arithmetic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
AZIMUTH = np.radians(32.0)
ELEVATION = np.radians(30.0)
RELIEF_SHARE = 0.13
EXAGGERATIONS = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0)


@dataclass(frozen=True, kw_only=True)
class View:
    """A parallel projection onto a picture.

    Parameters
    ----------
    right, up, towards : array (3,)
        Unit vectors of the picture and towards the eye.
    centre : array (3,)
        Place in the middle of the picture [m].
    metres_per_pixel : float
        Scale.
    size : (width, height)
        Picture [pixels].
    """

    right: FloatArray
    up: FloatArray
    towards: FloatArray
    centre: FloatArray
    metres_per_pixel: float
    size: tuple[int, int]

    def pixels(self, places: FloatArray) -> FloatArray:
        """Return the pixels (n, 2), from the lower left corner, of places (n, 3)."""
        from_centre = np.atleast_2d(places) - self.centre
        on_picture = np.stack([from_centre @ self.right, from_centre @ self.up], axis=1)
        return np.asarray(on_picture / self.metres_per_pixel + 0.5 * np.array(self.size))


def long_axis(positions: FloatArray, elevation: FloatArray) -> FloatArray:
    """Return the unit vector (2,) along the longest side of a cloud, towards its deep end."""
    from_mean = positions - positions.mean(axis=0)
    _, vectors = np.linalg.eigh(from_mean.T @ from_mean)
    axis = vectors[:, -1]
    rising = float((from_mean @ axis) @ (elevation - elevation.mean()))
    if rising == 0.0:
        return np.asarray(axis * np.sign(axis[np.argmax(np.abs(axis))]))
    return np.asarray(-axis if rising > 0.0 else axis)


def exaggeration(relief: float, length: float) -> float:
    """Return the factor for heights that makes the relief an eighth of the length, roughly.

    Examples
    --------
    >>> exaggeration(12.0, 800.0)
    8.0
    """
    wanted = RELIEF_SHARE * length / max(relief, 1e-9)
    return min(EXAGGERATIONS, key=lambda factor: abs(np.log(factor / wanted)))


def oblique_view(
    contents: FloatArray,
    *,
    axis: FloatArray,
    size: tuple[int, int],
    margins: tuple[int, int, int, int],
) -> View:
    """Return the view from the deep end's side, 30 degrees high, that just holds the contents.

    Parameters
    ----------
    contents : array (n, 3)
        Places that must be seen [m].
    axis : array (2,)
        From `long_axis`.
    size : (width, height)
        Picture [pixels].
    margins : (left, right, bottom, top)
        Kept free [pixels].
    """
    side = np.array([axis[1], -axis[0]])
    level = np.append(np.cos(AZIMUTH) * side + np.sin(AZIMUTH) * axis, 0.0)
    towards = np.cos(ELEVATION) * level + [0.0, 0.0, np.sin(ELEVATION)]
    right = np.cross([0.0, 0.0, 1.0], level)
    up = np.cross(towards, right)
    on_picture = np.stack([contents @ right, contents @ up], axis=1)
    low, high = on_picture.min(axis=0), on_picture.max(axis=0)
    left, right_margin, bottom, top = margins
    room = np.array([size[0] - left - right_margin, size[1] - bottom - top])
    scale = float(np.max((high - low) / room))
    offset = 0.5 * np.array([right_margin - left, top - bottom]) * scale
    middle = 0.5 * (low + high) + offset
    depth = float(np.mean(contents @ towards))
    return View(
        right=right,
        up=up,
        towards=towards,
        centre=middle[0] * right + middle[1] * up + depth * towards,
        metres_per_pixel=scale,
        size=size,
    )

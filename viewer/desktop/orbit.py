"""Where the eye of the window is: it orbits a place, and never tilts its head."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from viewer.view import View

FloatArray = NDArray[np.float64]
STEEPEST = np.radians(89.9)
SCALES = (1e-3, 1e3)


@dataclass(frozen=True, kw_only=True)
class Orbit:
    """A parallel view from an orbit.

    Parameters
    ----------
    centre : (x, y, z)
        Place in the middle of the picture [m, local, heights stretched].
    azimuth : float
        Of the eye seen from the centre, from east to north [rad].
    elevation : float
        Of the eye above the centre's level [rad].
    metres_per_pixel : float
        Scale.
    """

    centre: tuple[float, float, float]
    azimuth: float
    elevation: float
    metres_per_pixel: float

    @classmethod
    def of(cls, view: View) -> Orbit:
        """Return the orbit that a view is taken from.

        Examples
        --------
        >>> orbit = Orbit(centre=(1., 2., 3.), azimuth=0.5, elevation=0.4, metres_per_pixel=2.0)
        >>> again = Orbit.of(orbit.view((800, 600)))
        >>> round(again.azimuth, 6), round(again.elevation, 6), again.centre == orbit.centre
        (0.5, 0.4, True)
        """
        return cls(
            centre=_triple(view.centre),
            azimuth=float(np.arctan2(view.towards[1], view.towards[0])),
            elevation=float(np.arcsin(view.towards[2])),
            metres_per_pixel=view.metres_per_pixel,
        )

    def view(self, size: tuple[int, int]) -> View:
        """Return the view for a picture of a size (width, height) [pixels]."""
        level = np.array([np.cos(self.azimuth), np.sin(self.azimuth), 0.0])
        towards = np.cos(self.elevation) * level + [0.0, 0.0, np.sin(self.elevation)]
        right = np.cross([0.0, 0.0, 1.0], level)
        return View(
            right=right,
            up=np.cross(towards, right),
            towards=towards,
            centre=np.array(self.centre),
            metres_per_pixel=self.metres_per_pixel,
            size=size,
        )

    def turned(self, around: float, upwards: float) -> Orbit:
        """Return it further around and higher [rad]; it stays above the level of the centre."""
        elevation = float(np.clip(self.elevation + upwards, 0.0, STEEPEST))
        return replace(self, azimuth=self.azimuth + around, elevation=elevation)

    def moved(self, right: float, up: float) -> Orbit:
        """Return it with what is seen moved by so many pixels."""
        view = self.view((1, 1))
        shift = (right * view.right + up * view.up) * self.metres_per_pixel
        return replace(self, centre=_triple(view.centre - shift))

    def nearer(self, factor: float) -> Orbit:
        """Return it with everything drawn so many times larger."""
        scale = float(np.clip(self.metres_per_pixel / factor, *SCALES))
        return replace(self, metres_per_pixel=scale)

    def from_above(self) -> Orbit:
        """Return it looking straight down, north up."""
        return replace(self, azimuth=-0.5 * np.pi, elevation=STEEPEST)


def _triple(place: FloatArray) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in place)
    return x, y, z

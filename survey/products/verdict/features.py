"""Whether the cubes of the feature tests stand out of a cloud."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import BOTTOM_CLASSES, PointCloud
from survey.products.accuracy import ElevationAt

FloatArray = NDArray[np.float64]

ENOUGH_POINTS = 3
"""Assumed: fewer points that stand out are taken for noise, and cleaned away."""
STANDS_OUT = 0.5
"""Assumed: share of its height that a point must lie above the bed to speak of the cube [1]."""
RING = 1.5  # radius of the ring on which the bed is looked up, in sides


@dataclass(frozen=True, kw_only=True)
class Cube:
    """A cube on the bottom: side [m], centre in the local frame [m], heading [rad]."""

    side: float
    east: float
    north: float
    heading: float = 0.0

    def holds(self, places: FloatArray) -> NDArray[np.bool_]:
        """Tell which places (n, 2) lie within its outline.

        Examples
        --------
        >>> cube = Cube(side=2.0, east=0.0, north=0.0, heading=np.pi / 4.0)
        >>> cube.holds(np.array([[0.0, 1.3], [0.9, 0.9]])).tolist()
        [True, False]
        """
        east, north = (places - [self.east, self.north]).T
        sine, cosine = np.sin(self.heading), np.cos(self.heading)
        along, across = east * sine + north * cosine, east * cosine - north * sine
        return np.asarray(np.maximum(np.abs(along), np.abs(across)) <= 0.5 * self.side)


@dataclass(frozen=True, kw_only=True)
class FoundCube:
    """What a cloud holds of a cube.

    Parameters
    ----------
    cube : Cube
    top, bed : float
        True elevation of its middle, and of the seabed around it [m].
    points : int
        Bottom points in its outline that stand out of the bed.
    highest : float or None
        Highest of them [m].
    """

    cube: Cube
    top: float
    bed: float
    points: int
    highest: float | None

    @property
    def found(self) -> bool:
        """Whether enough points stand out."""
        return self.points >= ENOUGH_POINTS


@dataclass(kw_only=True)
class CubeTally:
    """Points that stand out on each cube, counted cloud by cloud.

    Parameters
    ----------
    cubes : sequence of Cube
    elevation_at : callable
        True elevation at local x, y: ``Seabed.elevation_at``.
    """

    cubes: Sequence[Cube]
    elevation_at: ElevationAt
    tops: list[float] = field(init=False)
    beds: list[float] = field(init=False)
    points: list[int] = field(init=False)
    highest: list[float] = field(init=False)

    def __post_init__(self) -> None:
        self.tops = [float(self.elevation_at(*_at(cube))[0]) for cube in self.cubes]
        self.beds = [float(np.nanmedian(self.elevation_at(*_ring(cube)))) for cube in self.cubes]
        self.points = [0] * len(self.cubes)
        self.highest = [-np.inf] * len(self.cubes)

    def add(self, cloud: PointCloud) -> None:
        """Count the points of a cloud in the local frame."""
        places = cloud.position[np.isin(cloud.classification, BOTTOM_CLASSES)]
        for number, cube in enumerate(self.cubes):
            bed, top = self.beds[number], self.tops[number]
            height = places[cube.holds(places[:, :2]), 2]
            out = height[height >= bed + STANDS_OUT * (top - bed)]
            self.points[number] += len(out)
            self.highest[number] = max(self.highest[number], out.max(initial=-np.inf))

    def found(self) -> list[FoundCube]:
        """Return what was counted."""
        return [
            FoundCube(
                cube=cube,
                top=top,
                bed=bed,
                points=points,
                highest=float(highest) if points else None,
            )
            for cube, top, bed, points, highest in zip(
                self.cubes, self.tops, self.beds, self.points, self.highest, strict=True
            )
        ]


def _at(cube: Cube) -> tuple[FloatArray, FloatArray]:
    return np.array([cube.east]), np.array([cube.north])


def _ring(cube: Cube) -> tuple[FloatArray, FloatArray]:
    angle = np.arange(16) * np.pi / 8.0
    radius = RING * cube.side
    return cube.east + radius * np.cos(angle), cube.north + radius * np.sin(angle)

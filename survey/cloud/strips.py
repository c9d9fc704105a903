"""The points of one survey line, thinned to what strip adjustment needs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud
from survey.cloud.sights import Sights, placed, sights_of
from survey.cloud.stitch import stitched
from survey.flight.navigation import Mounting
from survey.flight.pose import Frame

FloatArray = NDArray[np.float64]

MOST_POINTS = 20_000
GROWTH = 1.25
SOLID_GROUND = (PointClass.BATHYMETRIC, PointClass.GROUND)
"""Bottom and dry land; objects are left out, since pixels blur their edges."""


@dataclass(frozen=True, kw_only=True)
class Strip:
    """Points of one line.

    Parameters
    ----------
    line : int
        Number of the line.
    frame : array (n,)
        Frame of each point.
    position : array (n, 3)
        Where the points were placed [m].
    sights : Sights
        How they came to be.
    refractive_index, group_index : float
        Of the water [1].
    """

    line: int
    frame: NDArray[np.uint32]
    position: FloatArray
    sights: Sights
    refractive_index: float
    group_index: float

    def __len__(self) -> int:
        return len(self.frame)

    def placed(self, mounting: Mounting) -> FloatArray:
        """Return the points (n, 3) of a sensor that sits otherwise [m]."""
        return self.position + self._model(mounting) - self._model(Mounting())

    def _model(self, mounting: Mounting) -> FloatArray:
        return placed(
            self.sights,
            mounting=mounting,
            refractive_index=self.refractive_index,
            group_index=self.group_index,
        ).position


def strips_of(
    clouds: Iterable[PointCloud],
    frames: Mapping[int, Frame],
    *,
    cell_size: float,
    refractive_index: float,
    group_index: float,
    most: int = MOST_POINTS,
) -> list[Strip]:
    """Return a strip for every line, in the order of lines.

    Of bottom and land the best point a cell stays, cells growing until a strip has at most so
    many points; so memory does not grow with the points of a frame.

    Parameters
    ----------
    clouds : iterable of PointCloud
        Bottom clouds of the frames, read one after the other.
    frames : mapping
        Frames by number.
    cell_size : float
        Side of the cells [m].
    refractive_index, group_index : float
        Of the water [1].
    most : int
        Points that a strip may have.
    """
    by_line: dict[int, PointCloud] = {}
    for cloud in clouds:
        solid = cloud.select(np.isin(cloud.classification, SOLID_GROUND))
        for line in np.unique(solid.line).tolist():
            parts = [solid.select(solid.line == line)]
            parts += [by_line[line]] if line in by_line else []
            by_line[line] = stitched(parts, cell_size=cell_size)
    return [
        _strip(
            line, _at_most(by_line[line], most, cell_size), frames, refractive_index, group_index
        )
        for line in sorted(by_line)
    ]


def _at_most(cloud: PointCloud, most: int, cell_size: float) -> PointCloud:
    while len(cloud) > most:
        cell_size *= GROWTH
        cloud = stitched([cloud], cell_size=cell_size)
    return cloud


def _strip(
    line: int,
    cloud: PointCloud,
    frames: Mapping[int, Frame],
    refractive_index: float,
    group_index: float,
) -> Strip:
    return Strip(
        line=line,
        frame=cloud.frame,
        position=cloud.position,
        sights=sights_of(cloud, frames),
        refractive_index=refractive_index,
        group_index=group_index,
    )

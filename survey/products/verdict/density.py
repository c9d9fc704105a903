"""Points a square metre, by the cells of the Norwegian rules."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud
from survey.products.cells import CellGrid
from survey.products.verdict.features import ElevationAt

FloatArray = NDArray[np.float64]
GROUND_AND_SEABED = (PointClass.GROUND, PointClass.BATHYMETRIC)


@dataclass(kw_only=True)
class DensityTally:
    """Points of classes 2 and 40 by cells, counted cloud by cloud.

    Parameters
    ----------
    cells : CellGrid
        In the local frame.
    inside : array (rows, columns) of bool
        Cells of the survey area.
    """

    cells: CellGrid
    inside: NDArray[np.bool_]
    points: NDArray[np.int64] = field(init=False)

    def __post_init__(self) -> None:
        self.points = np.zeros(self.cells.rows * self.cells.columns, dtype=np.int64)

    def add(self, cloud: PointCloud) -> None:
        """Count the points of a cloud in the local frame."""
        places = cloud.position[np.isin(cloud.classification, GROUND_AND_SEABED)]
        here = self.cells.index_of(places[self.cells.contains(places)])
        self.points += np.bincount(here, minlength=self.points.size)

    def depths(self, elevation_at: ElevationAt, *, water_level: float) -> FloatArray:
        """Return the true depth of the cells' centres (rows, columns) [m]; nan outside the area."""
        depth = np.full(self.cells.shape, np.nan)
        x, y = self.cells.centres()[self.inside].T
        depth[self.inside] = water_level - elevation_at(x, y)
        return depth

    def density(self) -> FloatArray:
        """Return points a square metre (rows, columns) [1/m2]."""
        return self.points.reshape(self.cells.shape) / self.cells.cell_size**2

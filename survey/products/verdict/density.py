"""Points a square metre, by the cells of the Norwegian rules."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud
from survey.products.cells import CellGrid

FloatArray = NDArray[np.float64]
GROUND_AND_SEABED = (PointClass.GROUND, PointClass.BATHYMETRIC)


@dataclass(kw_only=True)
class DensityTally:
    """Points of classes 2 and 40 by cells in the local frame, counted cloud by cloud."""

    cells: CellGrid
    points: NDArray[np.uint32] = field(init=False)

    def __post_init__(self) -> None:
        self.points = np.zeros(self.cells.rows * self.cells.columns, dtype=np.uint32)

    def add(self, cloud: PointCloud) -> None:
        """Count the points of a cloud in the local frame."""
        places = cloud.position[np.isin(cloud.classification, GROUND_AND_SEABED)]
        np.add.at(self.points, self.cells.index_of(places[self.cells.contains(places)]), 1)

    def density(self) -> FloatArray:
        """Return points a square metre (rows, columns) [1/m2]."""
        return self.points.reshape(self.cells.shape) / self.cells.cell_size**2

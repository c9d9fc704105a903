"""What all frames hold together, found by reading them once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Outcome, PointClass
from survey.products.cells import CellGrid
from survey.products.coverage import SurveyedHull, looked_at
from survey.products.frame_file import FrameResult
from survey.products.grids import solid_places
from survey.products.pixels import PixelTally
from survey.products.substrates import SubstrateTally
from survey.products.writing import ProductError
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]
NOWHERE = (np.inf, np.inf, -np.inf, -np.inf)


class FirstLook:
    """What must be known of all frames before the first product is begun.

    Parameters
    ----------
    map_frame : MapFrame
        Where the frames' points lie on the map.
    """

    def __init__(self, map_frame: MapFrame) -> None:
        self.pixels, self.substrates, self.hull = PixelTally(), SubstrateTally(), SurveyedHull()
        self.surface_points = self.ground_points = 0
        self._map_frame = map_frame
        self._extents: list[FloatArray] = []
        self._points: list[int] = []
        self._solid = np.array(NOWHERE)

    def add(self, result: FrameResult) -> None:
        """Add a frame."""
        self.pixels.add(result.record)
        self.substrates.add_frame(result)
        self.hull.add(result.record)
        self.surface_points += len(result.surface)
        ground = result.bottom.classification == PointClass.GROUND
        self.ground_points += int(ground.sum())
        solid = extent(solid_places(result.bottom, self._map_frame))
        self._solid = joined(self._solid, solid)
        self._extents.append(self._extent_of(result))
        self._points.append(len(result.bottom) + len(result.surface))

    def _extent_of(self, result: FrameResult) -> FloatArray:
        places = looked_at(result.record)[0] + self._map_frame.origin[:2]
        clouds = (result.bottom, result.surface)
        on_map = (self._map_frame.to_map(cloud.position) for cloud in clouds)
        return joined(extent(places), *(extent(places) for places in on_map))

    @property
    def extents(self) -> FloatArray:
        """West, south, east, north of what each frame holds (frames, 4) [m, map]; or not finite."""
        return np.array(self._extents)

    @property
    def points(self) -> NDArray[np.int64]:
        """How many points each frame holds (frames,)."""
        return np.array(self._points, np.int64)

    def raster(self, *, cell_size: float) -> CellGrid:
        """Return the smallest raster over all seabed, objects and ground."""
        return CellGrid.covering(self._solid.reshape(2, 2), cell_size=cell_size)

    def require_bottom(self) -> None:
        """Raise unless some bottom or land was truly found: a false echo alone is no seabed.

        Raises
        ------
        ProductError
            That says why.
        """
        dry = self.pixels.dry and self.ground_points
        if not dry and not self.pixels.outcomes[Outcome.FOUND]:
            raise ProductError(self.pixels.explain_empty())


def extent(places: FloatArray) -> FloatArray:
    """Return west, south, east, north of places (n, 2 or 3)."""
    if len(places) == 0:
        return np.array(NOWHERE)
    return np.concatenate([places[:, :2].min(axis=0), places[:, :2].max(axis=0)])


def joined(*extents: FloatArray) -> FloatArray:
    """Return the extent of several."""
    west, south, east, north = np.array(extents).T
    return np.array([west.min(), south.min(), east.max(), north.max()])

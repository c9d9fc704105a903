"""What all frames hold together, found by reading them once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Outcome, PixelRecord, PointClass, PointCloud
from survey.products.cells import CellGrid
from survey.products.coverage import SurveyedHull, looked_at
from survey.products.depth_profile import StrengthProfile
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
        self.strengths = StrengthProfile()
        self.surface_points = self.ground_points = self.helped = 0
        self._map_frame = map_frame
        self._extents: list[FloatArray] = []
        self._points: list[int] = []
        self._solid = np.array(NOWHERE)

    def add(self, results: Sequence[FrameResult]) -> None:
        """Add some frames: several at once take less time."""
        record = PixelRecord.concatenate([result.record for result in results])
        bottom = PointCloud.concatenate([result.bottom for result in results])
        self.pixels.add(record, frames=len(results))
        self.strengths.add(record)
        self.substrates.add_pixels(record, bottom.substrate)
        self.hull.add(looked_at(record)[0])
        self.surface_points += sum(len(result.surface) for result in results)
        self.ground_points += int((bottom.classification == PointClass.GROUND).sum())
        self.helped += sum(result.helped for result in results)
        self._solid = joined(self._solid, extent(solid_places(bottom, self._map_frame)))
        self._extents += [self._extent_of(result) for result in results]
        self._points += [len(result.bottom) + len(result.surface) for result in results]

    def _extent_of(self, result: FrameResult) -> FloatArray:
        places = result.record.true_position.reshape(-1, 3)
        looked = extent(places[np.isfinite(places[:, 0])])
        clouds = (extent(cloud.position) for cloud in (result.bottom, result.surface))
        return joined(looked, *clouds) + np.tile(self._map_frame.origin[:2], 2)

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

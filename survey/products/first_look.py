"""What all frames hold together, found by reading them once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Outcome, PixelRecord, PointClass
from survey.products.cells import CellGrid
from survey.products.coverage import SurveyedHull, looked_at
from survey.products.depth_profile import StrengthProfile
from survey.products.frame_file import FrameResult
from survey.products.grids import SOLID_CLASSES
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
        substrate, kind, position = (
            np.concatenate([getattr(result.bottom, name) for result in results])
            for name in ("substrate", "classification", "position")
        )
        solid = position.take(np.flatnonzero(np.isin(kind, SOLID_CLASSES)), axis=0)
        self.pixels.add(record, frames=len(results))
        self.strengths.add(record)
        self.substrates.add_pixels(record, substrate)
        self.hull.add(looked_at(record)[0])
        self.surface_points += sum(len(result.surface) for result in results)
        self.ground_points += int((kind == PointClass.GROUND).sum())
        self.helped += sum(result.helped for result in results)
        self._solid = joined(self._solid, extent(self._map_frame.to_map(solid)))
        self._extents += [self._extent_of(result) for result in results]
        self._points += [len(result.bottom) + len(result.surface) for result in results]

    def _extent_of(self, result: FrameResult) -> FloatArray:
        looked = extent(looked_at(result.record)[0])
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
    x, y = places[:, 0], places[:, 1]
    return np.array([x.min(), y.min(), x.max(), y.max()])


def joined(*extents: FloatArray) -> FloatArray:
    """Return the extent of several."""
    west, south, east, north = np.array(extents).T
    return np.array([west.min(), south.min(), east.max(), north.max()])

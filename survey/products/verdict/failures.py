"""Where a survey does not meet an order, and why there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import BOTTOM_CLASSES, Outcome, PointCloud
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.products.cells import CellGrid
from survey.products.coverage import SHADOW, cell_polygons, hole_cause, map_feature
from survey.products.feature_file import write_features
from survey.products.lon_lat import lon_lat
from survey.products.standards import Order
from survey.products.standards.orders import WITHIN
from survey.products.verdict.features import FoundCube
from survey.products.verdict.passes import Passes
from survey.products.verdict.tally import errors_of
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]
MEETS, OUTSIDE = 0, -1
CAUSES = (
    "",
    "depth error over the limit",
    "false bottom",
    "place error over the limit",
    "seen too few times",
)
DEPTH_ERROR, FALSE_BOTTOM, PLACE_ERROR, TOO_FEW_TIMES = range(1, len(CAUSES))
FIRST_HOLE = len(CAUSES)
"""From here on a state is that of a hole: `HOLE` + the state of the coverage map."""

HOLE = FIRST_HOLE - SHADOW


@dataclass(kw_only=True)
class FailureCells:
    """Cells of the survey area in which points lie outside an order's limits.

    Parameters
    ----------
    cells : CellGrid
    order : Order
    origin : array (3,)
        Of the clouds' local frame on the map [m].
    water_level : float
        [m].
    """

    cells: CellGrid
    order: Order
    origin: FloatArray
    water_level: float
    wrong: NDArray[np.uint8] = field(init=False)

    def __post_init__(self) -> None:
        self.wrong = np.zeros(self.cells.shape, dtype=np.uint8)

    def add(self, cloud: PointCloud, cells: CellGrid | None = None) -> None:
        """Decide on some cells, by default all, with all points in them."""
        window = self.cells.window(cells or self.cells)
        part = self.cells.part(window)
        on_map = cloud.position + self.origin
        here = np.isin(cloud.classification, BOTTOM_CLASSES) & np.isfinite(cloud.true_elevation)
        here &= part.contains(on_map)
        cell = part.index_of(on_map[here])
        error, aside = (of_points[here] for of_points in errors_of(cloud))
        depth = np.maximum(self.water_level - cloud.true_elevation[here], 0.0)

        def counted(which: NDArray[np.bool_]) -> NDArray[np.intp]:
            return np.bincount(cell[which], minlength=part.rows * part.columns)

        allowed = (1.0 - WITHIN) * counted(np.ones(len(cell), dtype=np.bool_))
        tvu = counted(np.abs(error) > self.order.tvu(depth))
        thu = counted(aside > self.order.thu(depth))
        false = counted(np.abs(error) > FALSE_BOTTOM_ERROR)
        wrong = np.select(
            [(tvu > allowed) & (2 * false >= tvu), tvu > allowed, thu > allowed],
            [FALSE_BOTTOM, DEPTH_ERROR, PLACE_ERROR],
            MEETS,
        )
        self.wrong[window] = wrong.reshape(part.shape)

    def state(
        self, passes: Passes, missing: NDArray[np.bool_], hole_state: NDArray[np.int16]
    ) -> NDArray[np.int16]:
        """Return what is wrong in each cell (rows, columns): an index of `CAUSES` or a hole.

        Parameters
        ----------
        passes : Passes
        missing : array of bool
            Cells that were not seen as often as asked.
        hole_state : array of int16
            State of the coverage map.
        """
        seen_once = missing & (passes.frames > 0)
        rules = (
            (~passes.wet, np.int16(OUTSIDE)),
            (missing & (hole_state == Outcome.FALSE_BOTTOM), np.int16(FALSE_BOTTOM)),
            (missing & ~seen_once, hole_state + np.int16(HOLE)),
            (self.wrong != MEETS, self.wrong.astype(np.int16)),
            (seen_once, np.int16(TOO_FEW_TIMES)),
        )
        state = np.select([rule for rule, _ in rules], [name for _, name in rules], MEETS)
        return state.astype(np.int16)


@dataclass(frozen=True, kw_only=True)
class FailureMap:
    """Where an order is not met.

    Parameters
    ----------
    title : str
        Of the order.
    passes : Passes
        Whose cells they are.
    state : array (rows, columns)
        From `FailureCells.state`.
    lost : sequence of FoundCube
        Cubes that were not found.
    origin : array (3,)
        Of the cubes' local frame on the map [m].
    """

    title: str
    passes: Passes
    state: NDArray[np.int16]
    lost: Sequence[FoundCube]
    origin: NDArray[np.float64]

    def cause(self, state: int) -> str:
        """Return the name of what is wrong."""
        if state < FIRST_HOLE:
            return CAUSES[state]
        return hole_cause(state - HOLE)

    def write(self, path: Path, map_frame: MapFrame) -> None:
        """Write the failing areas, and lost cubes as points, as GeoJSON (RFC 7946: WGS 84).

        Features have ``order``, ``cause`` and, if they are areas, ``area_m2``.
        """
        write_features(path, self._features(map_frame))

    def _features(self, map_frame: MapFrame) -> Iterator[dict[str, Any]]:
        wrong = self.state > MEETS
        for rings, state in cell_polygons(self.state, wrong, self.passes.cells):
            yield map_feature(rings, map_frame, {"order": self.title, "cause": self.cause(state)})
        for cube in self.lost:
            yield _lost(cube, self.title, map_frame)


def _lost(cube: FoundCube, title: str, map_frame: MapFrame) -> dict[str, Any]:
    place = map_frame.to_map(np.array([[cube.cube.east, cube.cube.north, 0.0]]))
    (coordinates,) = lon_lat(place, epsg=map_frame.epsg).tolist()
    cause = f"cube of {cube.cube.side:g} m not found"
    return {
        "type": "Feature",
        "properties": {"order": title, "cause": cause, "points": cube.points},
        "geometry": {"type": "Point", "coordinates": coordinates},
    }

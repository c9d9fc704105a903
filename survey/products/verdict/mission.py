"""From the clouds and records of a mission to its verdict and the map of its failures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.products.cells import CellGrid
from survey.products.coverage import OUTSIDE_AREA, CoverageMap
from survey.products.standards import Order, norwegian_rules, orders
from survey.products.tile_points import TilePoints
from survey.products.verdict.density import DensityTally
from survey.products.verdict.failures import FailureCells, FailureMap
from survey.products.verdict.features import Cube, CubeTally
from survey.products.verdict.judge import Evidence, cubes_in_area, judge_norway, judge_s44
from survey.products.verdict.passes import Passes, PassTally
from survey.products.verdict.tally import OrderTally
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]
CELLS_AT_ONCE = 1 << 20


@dataclass(frozen=True, kw_only=True)
class Judged:
    """A mission's verdict.

    Parameters
    ----------
    metrics : mapping
        ``s44`` and ``norwegian_alb``, plain values.
    failures : FailureMap
        Of the order that was asked; without one, of the least strict that fails.
    """

    metrics: dict[str, Any]
    failures: FailureMap


class VerdictTally:
    """Collects what is judged, tile by tile of the map.

    Parameters
    ----------
    cells : CellGrid
        Of the coverage map.
    seabed : Seabed
        The truth.
    water_level : float
        In the vertical datum [m].
    reach : float
        Distance that a pixel answers for [m], as for the coverage map.
    cubes : sequence of Cube
        On the bottom, in the local frame.
    """

    def __init__(
        self,
        *,
        cells: CellGrid,
        seabed: Seabed,
        water_level: float,
        reach: float,
        cubes: Sequence[Cube],
    ) -> None:
        origin = seabed.map_frame.origin
        self._seabed, self._water_level = seabed, water_level
        self._errors = OrderTally(orders=list(orders().values()))
        self._passes = PassTally(cells=cells, reach=reach)
        self._cubes = CubeTally(cubes=cubes, elevation_at=seabed.elevation_at)
        self._density = DensityTally(cells=_local_cells(cells, origin))
        self._failing = {
            key: FailureCells(cells=cells, order=order, origin=origin, water_level=water_level)
            for key, order in orders().items()
        }

    def add(self, part: TilePoints) -> None:
        """Add a tile: its stitched bottom points, and where its pixels looked."""
        cells = part.tile.cells
        self._errors.add(part.bottom, water_level=self._water_level)
        self._cubes.add(part.bottom)
        self._density.add(part.bottom)
        self._passes.add(part.looked_at, part.outcomes, part.flash, cells)
        for failing in self._failing.values():
            failing.add(part.bottom, cells)

    def judged(self, coverage: CoverageMap, *, asked: str | None) -> Judged:
        """Return the verdict by every order of S-44 and by the Norwegian rules.

        Parameters
        ----------
        coverage : CoverageMap
            Of the same cells, finished.
        asked : str or None
            Key of the order that was asked for.
        """
        evidence = self._evidence(coverage)
        s44 = judge_s44(evidence, asked=asked)
        order = orders()[asked or _least_strict_failure(s44)]
        return Judged(
            metrics={"s44": s44, "norwegian_alb": judge_norway(evidence)},
            failures=_failures(self._failing[order.key], order, evidence),
        )

    def _evidence(self, coverage: CoverageMap) -> Evidence:
        origin, level = self._seabed.map_frame.origin, self._water_level
        inside = coverage.state != OUTSIDE_AREA
        depth = self._depths(coverage.cells, inside, origin[:2])
        cells = self._density.cells
        return Evidence(
            errors=self._errors,
            passes=Passes(cells=coverage.cells, wet=depth > 0.0, frames=self._passes.frames),
            coverage=coverage,
            cubes=cubes_in_area(self._cubes.found(), coverage, origin, level),
            density=self._density,
            density_depth=self._depths(cells, _within(cells, coverage, origin), np.zeros(2)),
            water_level=level,
        )

    def _depths(
        self, cells: CellGrid, which: NDArray[np.bool_], origin: FloatArray
    ) -> NDArray[np.float32]:
        """Return true depths of the centres of some cells (rows, columns) [m]; nan elsewhere."""
        depth = np.full(cells.rows * cells.columns, np.nan, dtype=np.float32)
        index = np.flatnonzero(which)
        for start in range(0, len(index), CELLS_AT_ONCE):
            some = index[start : start + CELLS_AT_ONCE]
            x, y = (cells.centres_of(some) - origin).T
            depth[some] = self._water_level - self._seabed.elevation_at(x, y)
        return depth.reshape(cells.shape)


def _local_cells(cells: CellGrid, origin: FloatArray) -> CellGrid:
    """Return cells of the Norwegian rules over a raster, in the local frame."""
    west, east, south, north = cells.extent
    corners = np.array([[west, south], [east - 1e-6, north - 1e-6]]) - origin[:2]
    return CellGrid.covering(corners, cell_size=norwegian_rules().cell)


def _within(cells: CellGrid, coverage: CoverageMap, origin: FloatArray) -> NDArray[np.bool_]:
    """Return the local cells whose centre lies in the survey area."""
    within = np.zeros(cells.rows * cells.columns, dtype=np.bool_)
    for start in range(0, within.size, CELLS_AT_ONCE):
        index = np.arange(start, min(start + CELLS_AT_ONCE, within.size))
        places = cells.centres_of(index) + origin[:2]
        here = coverage.cells.contains(places)
        at = coverage.cells.index_of(places[here])
        within[index[here]] = coverage.state.ravel()[at] != OUTSIDE_AREA
    return within.reshape(cells.shape)


def _least_strict_failure(s44: dict[str, Any]) -> str:
    failed = [key for key in orders() if s44["orders"][key]["result"] == "fail"]
    return failed[-1] if failed else next(iter(orders()))


def _failures(cells: FailureCells, order: Order, evidence: Evidence) -> FailureMap:
    asked = max(order.coverage, order.feature_search or 0.0)
    passes = evidence.passes
    missing = passes.missing(times=max(ceil(asked), 1), hole=order.feature or 0.0)
    sizes = [(cube, order.feature_at(evidence.water_level - cube.bed)) for cube in evidence.cubes]
    return FailureMap(
        title=order.title,
        passes=passes,
        state=cells.state(passes, missing, evidence.coverage.state),
        origin=cells.origin,
        lost=[c for c, size in sizes if size and c.cube.side >= size - 1e-9 and not c.found],
    )

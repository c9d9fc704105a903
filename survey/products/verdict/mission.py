"""From the clouds and records of a mission to its verdict and the map of its failures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PixelRecord, PointCloud
from survey.products.cells import CellGrid
from survey.products.coverage import OUTSIDE_AREA, CoverageMap
from survey.products.standards import Order, norwegian_rules, orders
from survey.products.verdict.density import DensityTally
from survey.products.verdict.failures import FailureCells, FailureMap
from survey.products.verdict.features import Cube, CubeTally
from survey.products.verdict.judge import Evidence, cubes_in_area, judge_norway, judge_s44
from survey.products.verdict.passes import Passes, count_passes
from survey.products.verdict.tally import ErrorTally
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]


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


def judge_mission(
    clouds: Iterable[PointCloud],
    records: Iterable[PixelRecord],
    coverage: CoverageMap,
    seabed: Seabed,
    *,
    water_level: float,
    reach: float,
    cubes: Sequence[Cube],
    asked: str | None,
) -> Judged:
    """Judge a mission by every order of S-44 and by the Norwegian rules.

    Parameters
    ----------
    clouds : iterable of PointCloud
        The stitched bottom cloud, in parts that are seen one at a time.
    records : iterable of PixelRecord
        One a frame, seen one at a time.
    coverage : CoverageMap
        Of the survey area.
    seabed : Seabed
        The truth.
    water_level : float
        In the vertical datum [m].
    reach : float
        Distance that a pixel answers for [m], as for the coverage map.
    cubes : sequence of Cube
        On the bottom, in the local frame.
    asked : str or None
        Key of the order that was asked for.
    """
    origin = seabed.map_frame.origin
    passes = Passes(
        cells=coverage.cells,
        wet=_wet(coverage, seabed, water_level),
        frames=count_passes(records, coverage.cells, origin=origin, reach=reach),
    )
    errors = ErrorTally(orders=list(orders().values()))
    features = CubeTally(cubes=cubes, elevation_at=seabed.elevation_at)
    density = _density(coverage, origin)
    failing = {
        key: FailureCells(passes=passes, order=order, origin=origin, water_level=water_level)
        for key, order in orders().items()
    }
    for cloud in clouds:
        errors.add(cloud, water_level=water_level)
        features.add(cloud)
        density.add(cloud)
        for cells in failing.values():
            cells.add(cloud)
    evidence = Evidence(
        errors=errors,
        passes=passes,
        coverage=coverage,
        cubes=cubes_in_area(features.found(), coverage, origin, water_level),
        density=density,
        elevation_at=seabed.elevation_at,
        water_level=water_level,
    )
    s44 = judge_s44(evidence, asked=asked)
    order = orders()[asked or _least_strict_failure(s44)]
    return Judged(
        metrics={"s44": s44, "norwegian_alb": judge_norway(evidence)},
        failures=_failures(failing[order.key], order, evidence),
    )


def _wet(coverage: CoverageMap, seabed: Seabed, water_level: float) -> NDArray[np.bool_]:
    wet = np.array(coverage.state != OUTSIDE_AREA, dtype=np.bool_)
    places = coverage.cells.centres()[wet] - seabed.map_frame.origin[:2]
    wet[wet] = seabed.elevation_at(places[:, 0], places[:, 1]) < water_level
    return wet


def _density(coverage: CoverageMap, origin: FloatArray) -> DensityTally:
    """Return empty cells of the Norwegian rules over the survey area, in the local frame."""
    west, east, south, north = coverage.cells.extent
    corners = np.array([[west, south], [east - 1e-6, north - 1e-6]]) - origin[:2]
    cells = CellGrid.covering(corners, cell_size=norwegian_rules().cell)
    places = cells.centres().reshape(-1, 2) + origin[:2]
    inside = coverage.cells.contains(places)
    at = coverage.cells.index_of(places[inside])
    inside[inside] = coverage.state.ravel()[at] != OUTSIDE_AREA
    return DensityTally(cells=cells, inside=inside.reshape(cells.shape))


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
        state=cells.state(missing, evidence.coverage.state),
        origin=cells.origin,
        lost=[c for c, size in sizes if size and c.cube.side >= size - 1e-9 and not c.found],
    )

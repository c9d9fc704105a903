"""Where the survey saw the bottom, where it did not, and why."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Outcome, PixelRecord
from survey.products.cells import CellGrid, inside_ring
from survey.products.feature_file import write_features
from survey.products.lon_lat import lon_lat
from survey.products.pixels import SEEN
from survey.products.writing import ProductError
from terrain.map_frame import MapFrame
from terrain.nearness import count_near

FloatArray = NDArray[np.float64]
OUTSIDE_AREA = -2
GAP = -1
SHADOW = -3
CAUSES = {GAP: "gap between frames", SHADOW: "shadow"}
"""Of cells that no pixel looked at."""

SEEN_RANK = np.uint32(10**9)
"""Lifts a single pixel that saw the ground above any number that did not."""

PLACES_AT_ONCE = 1 << 18
MIN_HOLE_AREA = 50.0


@dataclass(frozen=True, kw_only=True)
class CoverageMap:
    """What became of the bottom, by cells, row 0 in the north.

    Parameters
    ----------
    cells : CellGrid
        Where the cells lie on the map.
    state : array (rows, columns) of int16
        `OUTSIDE_AREA`, `GAP` or `SHADOW` where no pixel looked, else an `Outcome`: FOUND or DRY in
        covered cells, the commonest failure in the others.
    """

    cells: CellGrid
    state: NDArray[np.int16]

    @property
    def covered(self) -> NDArray[np.bool_]:
        """Cells (rows, columns) where seabed or land was seen."""
        return np.isin(self.state, SEEN)

    def cause(self, state: int) -> str:
        """Return the name of a hole's cause."""
        return hole_cause(state)


def hole_cause(state: int) -> str:
    """Return the name of the cause of a hole by its state in a `CoverageMap`."""
    return CAUSES.get(state) or Outcome(state).name.lower().replace("_", " ")


class SurveyedHull:
    """The convex hull of where all pixels look, frame by frame."""

    def __init__(self) -> None:
        self._corners, self._waiting = np.zeros((0, 2)), [np.zeros((0, 2))]

    def add(self, places: FloatArray) -> None:
        """Add the places of a frame (n, 2) [m]."""
        self._waiting.append(places)
        if sum(len(places) for places in self._waiting) > PLACES_AT_ONCE:
            self._corners, self._waiting = self._merged(), []

    def ring(self) -> FloatArray:
        """Return its corners (n, 2), counter-clockwise [m, local].

        Raises
        ------
        ProductError
            If fewer than three pixels look at a seabed.
        """
        corners = self._merged()
        if len(corners) < 3:
            raise ProductError(
                "coverage: fewer than three pixels look at the seabed. Check the flight"
            )
        return corners

    def _merged(self) -> FloatArray:
        from scipy.spatial import ConvexHull

        places = np.concatenate([self._corners, *self._waiting])
        return places if len(places) < 3 else np.asarray(places[ConvexHull(places).vertices])


def hull_of(records: Iterable[PixelRecord]) -> FloatArray:
    """Return the ring of `SurveyedHull` around all that several frames look at."""
    hull = SurveyedHull()
    for record in records:
        hull.add(looked_at(record)[0])
    return hull.ring()


class CoverageTally:
    """Sorts the cells of the survey area by what the pixels near their centres found.

    A cell is covered when a pixel within ``reach`` of its centre found the bottom or saw land.
    Otherwise its state is the commonest outcome of these pixels; with no such pixel it is a gap.

    Parameters
    ----------
    survey_area : array (n, 2)
        Ring around the area that should be covered [m, map], say of `SurveyedHull`.
    cell_size : float
        Side of a cell [m].
    reach : float
        How far one pixel answers for the bottom around it [m].
    """

    def __init__(self, *, survey_area: FloatArray, cell_size: float, reach: float) -> None:
        self.cells = CellGrid.covering(survey_area, cell_size=cell_size)
        self._area, self._reach = survey_area, reach
        self._state = np.full(self.cells.shape, GAP, dtype=np.int16)

    def add(
        self, places: FloatArray, outcomes: NDArray[np.uint8], cells: CellGrid | None = None
    ) -> None:
        """Decide on some cells, by default all, with all pixels in reach of them.

        Parameters
        ----------
        places : array (n, 2)
            Where pixels look [m, map].
        outcomes : array (n,)
        cells : CellGrid, optional
            Cells of the same lattice.
        """
        window = self.cells.window(cells or self.cells)
        part = self.cells.part(window)
        near = count_near(
            places,
            outcomes,
            number_of_kinds=len(Outcome),
            shape=part.shape,
            west=part.west,
            north=part.north,
            cell_size=part.cell_size,
            reach=self._reach,
        )
        for outcome in SEEN:
            near[outcome][near[outcome] > 0] += SEEN_RANK
        commonest = near.argmax(axis=0).astype(np.int16)
        self._state[window] = np.where(near.any(axis=0), commonest, GAP)

    def map(self) -> CoverageMap:
        """Return the map, cells outside the survey area left out."""
        inside = inside_ring(self.cells, self._area)
        return CoverageMap(cells=self.cells, state=np.where(inside, self._state, OUTSIDE_AREA))


def write_coverage_geojson(
    path: Path,
    coverage: CoverageMap,
    map_frame: MapFrame,
    *,
    min_hole_area: float = MIN_HOLE_AREA,
) -> None:
    """Write covered ground, and holes with their cause, as GeoJSON (RFC 7946: WGS 84).

    Features have ``kind`` ("covered" or "hole"), ``area_m2`` (on the map) and, for holes,
    ``cause``: "gap between frames", "shadow", or the commonest `Outcome` there in words.

    Parameters
    ----------
    path : Path
        File to write.
    coverage : CoverageMap
        Cells and what was seen in them.
    map_frame : MapFrame
        For the CRS.
    min_hole_area : float
        Holes smaller than this are left out [m2].
    """
    covered, holes = _covered(coverage, map_frame), _holes(coverage, map_frame, min_hole_area)
    write_features(path, chain(covered, holes))


def _covered(coverage: CoverageMap, map_frame: MapFrame) -> Iterator[dict[str, Any]]:
    covered = coverage.covered
    for rings, _ in cell_polygons(covered.astype(np.int16), covered, coverage.cells):
        yield map_feature(rings, map_frame, {"kind": "covered"})


def _holes(coverage: CoverageMap, map_frame: MapFrame, min_area: float) -> Iterator[dict[str, Any]]:
    missing = ~coverage.covered & (coverage.state != OUTSIDE_AREA)
    for rings, state in cell_polygons(coverage.state, missing, coverage.cells):
        if _area(rings) > min_area:
            yield map_feature(rings, map_frame, {"kind": "hole", "cause": coverage.cause(state)})


def cell_polygons(
    values: NDArray[np.int16], mask: NDArray[np.bool_], cells: CellGrid
) -> Iterator[tuple[list[FloatArray], int]]:
    """Yield the rings on the map around the cells of a mask that have one value, and the value."""
    from rasterio.features import shapes

    found = shapes(values, mask=mask, connectivity=4, transform=cells.transform)
    for shape, value in found:
        yield [np.array(ring) for ring in shape["coordinates"]], int(value)


def map_feature(
    rings: list[FloatArray], map_frame: MapFrame, properties: dict[str, str]
) -> dict[str, Any]:
    """Return rings on the map as a GeoJSON polygon with its properties and its area."""
    coordinates = []
    for number, ring in enumerate(rings):
        counter_clockwise = _signed_area(ring) > 0.0
        right_handed = ring if counter_clockwise == (number == 0) else ring[::-1]
        coordinates.append(lon_lat(right_handed, epsg=map_frame.epsg).tolist())
    return {
        "type": "Feature",
        "properties": {**properties, "area_m2": round(_area(rings), 3)},
        "geometry": {"type": "Polygon", "coordinates": coordinates},
    }


def _area(rings: list[FloatArray]) -> float:
    outer, *inner = (abs(_signed_area(ring)) for ring in rings)
    return outer - sum(inner)


def _signed_area(ring: FloatArray) -> float:
    x, y = (ring - ring[0]).T
    return float(0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))


def looked_at(record: PixelRecord) -> tuple[FloatArray, NDArray[np.uint8]]:
    """Return places (n, 2) [m, local] and outcomes (n,) of the pixels that look at the seabed."""
    places = record.true_position[..., :2].reshape(-1, 2)
    known = np.flatnonzero(np.isfinite(places[:, 0]) & np.isfinite(places[:, 1]))
    return places.take(known, axis=0), record.outcome.ravel()[known]

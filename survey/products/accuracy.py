"""The measured clouds against the truth beside them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import BOTTOM_CLASSES, NOISE_CLASSES, PointClass, PointCloud
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.optics.water import WaterColumn
from survey.products.cells import CellGrid, inside_ring
from survey.products.pixels import DETECTABLE, HALF, PixelTally
from survey.products.reach import optical_depths
from survey.products.tally import DepthBins, ErrorTally

FloatArray = NDArray[np.float64]
ElevationAt = Callable[[FloatArray, FloatArray], FloatArray]
DECIMALS = 6
CELLS_AT_ONCE = 1 << 20


class Accuracy:
    """Compares stitched clouds with the truth, part by part.

    Parameters
    ----------
    water_level : float
        True mean water level in the vertical datum [m].
    survey_area : array (n, 2)
        Ring around the area that should be covered [m, local].
    cell_size : float
        Side of the cells of coverage [m]: that of the thinning, and not below the pixels'
        spacing on the bottom, or full coverage is out of reach.

    Raises
    ------
    ProductError
        If the survey area is empty or too large for such cells.
    """

    def __init__(self, *, water_level: float, survey_area: FloatArray, cell_size: float) -> None:
        self.bottom, self.surface, self.ground = (PointErrors() for _ in range(3))
        self.false_bottoms = self.no_bottom_found = self.noise = 0
        self.depths = StitchedDepths(water_level=water_level)
        self._held = HeldCells(survey_area=survey_area, cell_size=cell_size)
        self._water_level = water_level

    def add(self, bottom: PointCloud, surface: PointCloud) -> None:
        """Add stitched points in the scene's local frame."""
        solid = bottom.select(np.isin(bottom.classification, BOTTOM_CLASSES))
        self.bottom.add(solid)
        self.ground.add(bottom.select(bottom.classification == PointClass.GROUND))
        self.surface.add(surface.select(surface.classification == PointClass.WATER_SURFACE))
        self.false_bottoms += int((np.abs(elevation_errors(solid)) > FALSE_BOTTOM_ERROR).sum())
        self.no_bottom_found += int((bottom.classification == PointClass.NO_BOTTOM_FOUND).sum())
        for cloud in (bottom, surface):
            self.noise += int(np.isin(cloud.classification, NOISE_CLASSES).sum())
        self.depths.add(bottom)
        self._held.add(solid)

    def metrics(
        self, *, pixels: PixelTally, elevation_at: ElevationAt, water: WaterColumn
    ) -> dict[str, Any]:
        """Return what a mission achieved, as plain values; None where nothing was measured.

        An error is measured less true elevation at the measured place [m]; points off the known
        seabed have none and are left out of the errors. "Bottom" is classes 40 and 43.

        ================================  ======================================================
        frames                            frames flown
        points_bottom, _surface, _ground  points of classes 40 and 43; 41; 2
        points_no_bottom_found            points of class 45
        points_noise                      of classes 7 and 18, in both clouds; in no other figure
        bias_m, rmse_m, p95_abs_error_m   mean, root mean square, 95th percentile of the absolute
                                          errors of bottom points, false bottoms included
        bias_standard_error_m             from the scatter of the frames' mean errors, weighted
                                          by points; frames are taken as independent
        surface_*, ground_*               the same for surface points and for dry ground
        false_bottoms                     bottom points with an absolute error above 1 m
        coverage_fraction                 cells that hold a bottom point, over the cells whose
                                          centre lies in the survey area and truly under water
        density_per_m2                    bottom points over the area of these wet cells
        ================================  ======================================================

        followed by what `PixelTally` counts, by `StitchedDepths`, and by what `optical_depths`
        makes of all depths.

        Parameters
        ----------
        pixels : PixelTally
            Of all frames.
        elevation_at : callable
            True elevation of seabed or land at local x, y, nan outside: ``Seabed.elevation_at``.
        water : WaterColumn
            Makes optical depths of depths.
        """
        seen = pixels.metrics() | self.depths.metrics()
        values = {
            "frames": pixels.frames,
            "points_bottom": self.bottom.points,
            "points_surface": self.surface.points,
            "points_ground": self.ground.points,
            "points_no_bottom_found": self.no_bottom_found,
            "points_noise": self.noise,
            **self.bottom.metrics(""),
            **self.surface.metrics("surface_"),
            **self.ground.metrics("ground_"),
            "false_bottoms": self.false_bottoms,
            **self._held.metrics(elevation_at, self._water_level, points=self.bottom.points),
            **seen,
            **optical_depths(seen, water),
        }
        return {name: _rounded(value) for name, value in values.items()}


class StitchedDepths:
    """Tells how deep a stitched cloud holds the true bottom.

    Parameters
    ----------
    water_level : float
        [m].
    """

    def __init__(self, *, water_level: float) -> None:
        self._water_level, self._bins = water_level, DepthBins(("right",))

    def add(self, bottom: PointCloud) -> None:
        """Add stitched points, also those where no bottom was found."""
        depth = self._water_level - bottom.truth[:, 2]
        right = np.isin(bottom.classification, BOTTOM_CLASSES)
        right &= np.abs(bottom.position[:, 2] - bottom.true_elevation) <= FALSE_BOTTOM_ERROR
        wet = depth > 0.0
        self._bins.add(depth[wet], right=right[wet])

    def metrics(self) -> dict[str, float | None]:
        """Return ``stitched_depth_m`` and ``half_stitched_depth_m``.

        The first is the deep edge of the deepest 0.5 m bin of true depth, or the deepest place,
        where nine points in ten are bottom points within 1 m of the true seabed; the other where
        half of them are. None where that is nowhere so.
        """
        return {
            "stitched_depth_m": self._bins.deepest("right", DETECTABLE),
            "half_stitched_depth_m": self._bins.deepest("right", HALF),
        }


class PointErrors:
    """Elevation errors of points, and how they scatter from frame to frame."""

    def __init__(self) -> None:
        self.points, self.errors = 0, ErrorTally()
        self._sums, self._counts = np.zeros(0), np.zeros(0)

    def add(self, cloud: PointCloud) -> None:
        """Add points; those off the known seabed count, without an error."""
        known = cloud.select(np.isfinite(cloud.true_elevation))
        errors = elevation_errors(known)
        self.points += len(cloud)
        self.errors.add(errors)
        self._sums = _grown(self._sums, np.bincount(known.frame, errors))
        self._counts = _grown(self._counts, np.bincount(known.frame))

    def metrics(self, prefix: str) -> dict[str, float | None]:
        """Return bias, r.m.s., 95 % and standard error of the bias, None where there is none."""
        names = ("bias_m", "rmse_m", "p95_abs_error_m", "bias_standard_error_m")
        values: tuple[float | None, ...] = (None,) * len(names)
        if self.errors.count:
            values = (
                self.errors.mean,
                self.errors.root_mean_square,
                self.errors.quantile_of_absolute(0.95),
                self._standard_error(),
            )
        return {f"{prefix}{name}": value for name, value in zip(names, values, strict=True)}

    def _standard_error(self) -> float | None:
        """Return the standard error of the mean, with frames as the independent units."""
        frames = int((self._counts > 0).sum())
        if frames < 2:
            return None
        departures = self._sums - self._counts * self.errors.mean
        share = frames / (frames - 1)
        return float(np.sqrt(share * np.sum(departures**2)) / self.errors.count)


class HeldCells:
    """Cells of the survey area that hold a bottom point; parameters as in `Accuracy`."""

    def __init__(self, *, survey_area: FloatArray, cell_size: float) -> None:
        self._cells = CellGrid.covering(survey_area, cell_size=cell_size)
        self._area = survey_area
        self._held = np.zeros(self._cells.rows * self._cells.columns, dtype=np.bool_)

    def add(self, solid: PointCloud) -> None:
        """Add bottom points."""
        inside = self._cells.contains(solid.position)
        self._held[self._cells.index_of(solid.position[inside])] = True

    def metrics(
        self, elevation_at: ElevationAt, water_level: float, *, points: int
    ) -> dict[str, float | None]:
        """Return the share of wet cells that are held, and so many points over their area."""
        inside = np.flatnonzero(inside_ring(self._cells, self._area))
        wet = held = 0
        for start in range(0, inside.size, CELLS_AT_ONCE):
            some = inside[start : start + CELLS_AT_ONCE]
            under_water = elevation_at(*self._cells.centres_of(some).T) < water_level
            wet += int(under_water.sum())
            held += int(self._held[some][under_water].sum())
        if wet == 0:
            return {"coverage_fraction": None, "density_per_m2": None}
        return {
            "coverage_fraction": held / wet,
            "density_per_m2": points / (wet * self._cells.cell_size**2),
        }


def elevation_errors(cloud: PointCloud) -> FloatArray:
    """Return measured less true elevation of the points that have a true one (m,) [m]."""
    errors = cloud.position[:, 2] - cloud.true_elevation
    return np.asarray(errors[np.isfinite(errors)])


def _grown(sums: FloatArray, more: NDArray[Any]) -> FloatArray:
    """Return the sums of two arrays, the shorter one filled up with 0."""
    short, long = sorted((sums, more), key=len)
    total = long.astype(np.float64)
    total[: short.size] += short
    return total


def _rounded(value: Any) -> Any:
    return round(value, DECIMALS) if isinstance(value, float) else value

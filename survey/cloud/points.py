"""The point cloud of a mission: measurement with truth beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray


class PointClass(IntEnum):
    """LAS 1.4 classes in use (ASPRS topo-bathy profile)."""

    GROUND = 2
    LOW_NOISE = 7
    HIGH_NOISE = 18
    BATHYMETRIC = 40
    WATER_SURFACE = 41
    DERIVED_SURFACE = 42
    SUBMERGED_OBJECT = 43
    NO_BOTTOM_FOUND = 45


BOTTOM_CLASSES = (PointClass.BATHYMETRIC, PointClass.SUBMERGED_OBJECT)
NOISE_CLASSES = (PointClass.LOW_NOISE, PointClass.HIGH_NOISE)


class Outcome(IntEnum):
    """What became of the bottom in one pixel of one frame, see `survey.cloud.truth.outcomes`.

    The causes of weak echoes are those of `survey.cloud.error_causes`. NOISE is a bottom that was
    found, true or false, and sorted out because it stood alone.
    """

    FOUND = 0
    DRY = 1
    FALSE_BOTTOM = 2
    TOO_DEEP = 3
    MERGED_WITH_SURFACE = 4
    OUTSIDE_GATE = 5
    SATURATED = 6
    CHANCE = 7
    LOW_REFLECTANCE = 8
    TOO_TURBID = 9
    GLINT = 10
    NOISE = 11


class Cause(IntEnum):
    """Which effect truly moved a point most; NONE where no echo was placed."""

    NONE = 0
    FALSE_ECHO = 1
    RANGE_NOISE = 2
    SCATTERING = 3
    WAVES = 4
    NAVIGATION = 5
    WATER_LEVEL = 6
    RELIEF = 7
    """In budgets alone: the truth does not tell relief from light that came from elsewhere."""


@dataclass(frozen=True, kw_only=True)
class PointCloud:
    """Points as columns of equal length n.

    Parameters
    ----------
    position : array (n, 3)
        Easting, northing, up in the scene's local frame [m], corrected for refraction.
    uncorrected : array (n, 3)
        The same echo placed along a straight ray at the speed of light in air [m].
    truth : array (n, 3)
        Where the unscattered ray of the pixel centre truly meets what the point claims [m].
    classification : array (n,)
        `PointClass`.
    true_classification : array (n,)
        `PointClass` of what is truly there.
    substrate : array (n,)
        Code of what is truly there, see `terrain.substrate`; 0 for water and what has no label.
    true_elevation : array (n,)
        True elevation of seabed or sea surface at the measured place [m].
    true_surface, true_normal : array (n, 3)
        Where that ray truly meets the water [m], and the unit normal of the water there; on land
        the land itself, and nan.
    water_path : array (n,)
        True one-way path of that ray in water [m]; 0 on land and for surface points.
    tvu, thu : array (n,)
        Total vertical and horizontal uncertainty, 95 % [m], see `survey.cloud.uncertainty`; nan
        where no echo was placed.
    cause : array (n,)
        `Cause` of its error, see `survey.cloud.error_causes`.
    surface_elevation : array (n,)
        Of the water where the point's ray was taken to enter it [m, local]; nan on land.
    reflectance : array (n,)
        Of a diffuse target there that would send back the counts, see `survey.cloud.reflectance`
        [1]; nan where there is no echo.
    true_reflectance : array (n,)
        Of the seabed or land that the ray of the pixel centre truly meets [1]; nan for water.
    time : array (n,)
        Seconds since the start of the mission [s].
    depth : array (n,)
        Depth under the estimated water surface, positive down [m]; 0 for surface points.
    counts : array (n,)
        Photo-electrons of the echo above the expected noise [1].
    snr : array (n,)
        Those counts over the square root of all counts in the gate [1].
    frame, line, row, column : array (n,)
        Address of the pixel that saw the point.
    """

    position: NDArray[np.float64]
    uncorrected: NDArray[np.float64]
    truth: NDArray[np.float64]
    classification: NDArray[np.uint8]
    true_classification: NDArray[np.uint8]
    substrate: NDArray[np.uint8]
    true_elevation: NDArray[np.float64]
    true_surface: NDArray[np.float64]
    true_normal: NDArray[np.float32]
    water_path: NDArray[np.float32]
    tvu: NDArray[np.float32]
    thu: NDArray[np.float32]
    cause: NDArray[np.uint8]
    surface_elevation: NDArray[np.float64]
    reflectance: NDArray[np.float32]
    true_reflectance: NDArray[np.float32]
    time: NDArray[np.float64]
    depth: NDArray[np.float64]
    counts: NDArray[np.float32]
    snr: NDArray[np.float32]
    frame: NDArray[np.uint32]
    line: NDArray[np.uint16]
    row: NDArray[np.uint16]
    column: NDArray[np.uint16]

    def __len__(self) -> int:
        return int(self.position.shape[0])

    def select(self, which: NDArray[Any] | slice) -> PointCloud:
        """Return the points that a mask, an index array or a slice names, in its order."""
        columns = self.columns()
        if isinstance(which, slice):
            return PointCloud(**{name: column[which] for name, column in columns.items()})
        index = np.flatnonzero(which) if which.dtype == np.bool_ else which
        return PointCloud(**{name: column.take(index, axis=0) for name, column in columns.items()})

    def columns(self) -> dict[str, NDArray[Any]]:
        """Return the columns by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @staticmethod
    def concatenate(clouds: Sequence[PointCloud]) -> PointCloud:
        """Return all points of several clouds, in their order."""
        names = [field.name for field in fields(PointCloud)]
        return PointCloud(
            **{name: np.concatenate([getattr(cloud, name) for cloud in clouds]) for name in names}
        )


@dataclass(frozen=True, kw_only=True)
class PixelRecord:
    """Per-pixel truth and outcome of one frame, each array of the camera's shape.

    Parameters
    ----------
    true_position : array (rows, columns, 3)
        Where the pixel centre's unscattered ray meets the seabed or land [m, local frame].
    true_depth : array
        Depth of that place below the water level, negative on land [m].
    detection_probability : array
        Probability that the scenario's ranging finds the bottom echo: by eq. (11) of [Lisenko2017]
        with the threshold; with the matched filter alone or with its neighbours, as normal sums.
    outcome : array
        `Outcome` of the pixel.
    bottom_counts : array
        Expected photo-electrons of the bottom echo in its best gate [1].
    monte_carlo_relative_error : array
        Standard error of `bottom_counts` over itself [1].
    """

    true_position: NDArray[np.float64]
    true_depth: NDArray[np.float64]
    detection_probability: NDArray[np.float64]
    outcome: NDArray[np.uint8]
    bottom_counts: NDArray[np.float64]
    monte_carlo_relative_error: NDArray[np.float64]

    @staticmethod
    def concatenate(records: Sequence[PixelRecord]) -> PixelRecord:
        """Return the records of several frames of one camera, one under the other."""
        names = [field.name for field in fields(PixelRecord)]
        return PixelRecord(
            **{
                name: np.concatenate([getattr(record, name) for record in records])
                for name in names
            }
        )

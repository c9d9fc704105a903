"""The points of a cloud as records of LAS 1.4, point format 6, with our extra bytes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud
from survey.flight.pose import Frame, measured_positions
from survey.products.gps_time import adjusted_gps_time
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    import laspy

FloatArray = NDArray[np.float64]
SCAN_ANGLE_STEP_DEG = 0.006
MAX_INTENSITY = 65535
INTENSITY_STEPS = 10_000
"""Of intensity for a reflectance of 1."""

STANDARD_BYTES = 30  # of point format 6
SYNTHETIC = 1  # the lowest of its flags
POINTS_IN_CACHE = 8192
EXTRA_STEPS_PER_METRE = 1024
"""Extra places are kept to 1/1024 m: single precision holds such elevations below 16 km exactly."""

EXTRA_BYTES: tuple[tuple[str, type[np.generic], str], ...] = (
    ("frame", np.uint32, "flash number from 0"),
    ("pixel_row", np.uint16, "camera row from 0"),
    ("pixel_column", np.uint16, "camera column from 0"),
    ("depth_m", np.float32, "depth, positive down, m"),
    ("snr", np.float32, "echo over noise deviation"),
    ("counts", np.float32, "photo-electrons of the echo"),
    *((f"uncorrected_{axis}", np.int32, "without refraction, m") for axis in "xy"),
    ("uncorrected_z", np.float32, "without refraction, m"),
    *((f"true_{axis}", np.float64, "true place of the pixel, m") for axis in "xy"),
    ("true_z", np.float32, "true place of the pixel, m"),
    ("true_elevation", np.float32, "true z at measured x, y, m"),
    *((f"true_surface_{axis}", np.int32, "true crossing of the water, m") for axis in "xy"),
    ("true_surface_z", np.float32, "true crossing of the water, m"),
    *((f"true_normal_{axis}", np.float32, "true normal of the water") for axis in "xyz"),
    ("true_water_path", np.float32, "true one-way path in water, m"),
    ("total_thu", np.float32, "horizontal uncertainty 95 %, m"),
    ("total_tvu", np.float32, "vertical uncertainty 95 %, m"),
    ("surface_z", np.float32, "water where the ray enters, m"),
    ("reflectance", np.float32, "of a diffuse target as bright"),
    ("true_reflectance", np.float32, "of what is truly there"),
    ("true_class", np.uint8, "class of what is truly there"),
    ("substrate", np.uint8, "true bottom, see metrics.json"),
    ("cause", np.uint8, "of error: docs/uncertainty.md"),
)
"""Names, types and descriptions; what is int32 is scaled, hence always finite."""

RETURNS = {
    PointClass.WATER_SURFACE: (1, 2),
    PointClass.BATHYMETRIC: (2, 2),
    PointClass.SUBMERGED_OBJECT: (2, 2),
}
"""Return number and number of returns in water; (1, 1) for the other classes."""


def extra_dimensions(header: laspy.LasHeader) -> list[laspy.ExtraBytesParams]:
    """Return what a header must know of `EXTRA_BYTES`; scaled ones have its offsets."""
    import laspy

    def scaling(name: str, kind: type[np.generic]) -> dict[str, list[float]]:
        if kind is not np.int32:
            return {}
        offset = header.x_offset if name.endswith("_x") else header.y_offset
        return {"scales": [1.0 / EXTRA_STEPS_PER_METRE], "offsets": [offset]}

    return [
        laspy.ExtraBytesParams(name, kind, description, **scaling(name, kind))
        for name, kind, description in EXTRA_BYTES
    ]


@dataclass(frozen=True, kw_only=True)
class Views:
    """Where each flash was measured to be, by its number.

    Parameters
    ----------
    position : array (flashes, 3)
        [m, local].
    right : array (flashes, 2)
        Unit vector to the right of the heading: east, north.
    """

    position: FloatArray
    right: FloatArray

    @classmethod
    def of(cls, frames: Sequence[Frame]) -> Views:
        """Return the views of some frames; nan for numbers between that no frame has."""
        position = measured_positions(frames)
        heading = np.full(len(position), np.nan)
        heading[[frame.index for frame in frames]] = [frame.measured.heading for frame in frames]
        return cls(position=position, right=np.column_stack([np.cos(heading), -np.sin(heading)]))

    def scan_angle_deg(self, cloud: PointCloud) -> FloatArray:
        """Return the angle off nadir across the track, positive to the right (n,) [deg].

        Taken to the uncorrected point, hence the direction in air.
        """
        ray = cloud.uncorrected - self.position.take(cloud.frame, axis=0)
        right = self.right.take(cloud.frame, axis=0)
        across = ray[:, 0] * right[:, 0] + ray[:, 1] * right[:, 1]
        return np.asarray(np.degrees(np.arctan2(across, -ray[:, 2])))


def las_records(
    header: laspy.LasHeader,
    cloud: PointCloud,
    map_frame: MapFrame,
    *,
    start_utc: datetime,
    views: Views,
) -> laspy.ScaleAwarePointRecord:
    """Return the points in the format of a header that has our `extra_dimensions`.

    Parameters
    ----------
    header : laspy.LasHeader
    cloud : PointCloud
        Points in the scene's local frame.
    map_frame : MapFrame
        Where that frame lies on the map.
    start_utc : datetime
        Start of the mission.
    views : Views
        Of the flashes that the points name.
    """
    import laspy

    points = laspy.ScaleAwarePointRecord.zeros(len(cloud), header=header)
    for start in range(0, len(cloud), POINTS_IN_CACHE):
        some = slice(start, start + POINTS_IN_CACHE)
        part, records = cloud.select(some), points.array[some]
        columns = _standard_columns(part, header, map_frame, views)
        columns["gps_time"] = adjusted_gps_time(start_utc, part.time)
        for name, values in (columns | _extra_columns(part, header, map_frame)).items():
            records[name] = values
    return points


def _standard_columns(
    cloud: PointCloud, header: laspy.LasHeader, map_frame: MapFrame, views: Views
) -> dict[str, NDArray[Any]]:
    steps = np.rint((map_frame.to_map(cloud.position) - header.offsets) / header.scales)
    intensity = np.nan_to_num(np.rint(cloud.reflectance * INTENSITY_STEPS))
    return {
        **dict(zip("XYZ", steps.T, strict=True)),
        "intensity": np.clip(intensity, 0, MAX_INTENSITY),
        "bit_fields": RETURN_BITS[cloud.classification],
        "classification_flags": np.uint8(SYNTHETIC),
        "classification": cloud.classification,
        "scan_angle": np.rint(views.scan_angle_deg(cloud) / SCAN_ANGLE_STEP_DEG),
        "point_source_id": cloud.line + np.uint16(1),
    }


def _return_bits() -> NDArray[np.uint8]:
    """Return number and number of returns by class, as they share a byte."""
    bits = np.full(1 << 8, 1 | 1 << 4, np.uint8)
    for point_class, (number, total) in RETURNS.items():
        bits[point_class] = number | total << 4
    return bits


RETURN_BITS = _return_bits()


def _extra_columns(
    cloud: PointCloud, header: laspy.LasHeader, map_frame: MapFrame
) -> dict[str, NDArray[Any]]:
    place = {
        "uncorrected": _steps(cloud.uncorrected, header, map_frame),
        "true_surface": _steps(cloud.true_surface, header, map_frame),
    }
    columns: dict[str, NDArray[Any]] = {}
    for prefix, steps in place.items():
        columns[f"{prefix}_x"], columns[f"{prefix}_y"] = steps[:, 0], steps[:, 1]
        columns[f"{prefix}_z"] = steps[:, 2] / EXTRA_STEPS_PER_METRE
    truth = _rounded(map_frame.to_map(cloud.truth))
    columns |= {f"true_{axis}": truth[:, index] for index, axis in enumerate("xyz")}
    columns |= {
        f"true_normal_{axis}": cloud.true_normal[:, index] for index, axis in enumerate("xyz")
    }
    return columns | {
        "true_water_path": cloud.water_path,
        "total_thu": cloud.thu,
        "total_tvu": cloud.tvu,
        "surface_z": _rounded(cloud.surface_elevation),
        "reflectance": cloud.reflectance,
        "true_reflectance": cloud.true_reflectance,
        "frame": cloud.frame,
        "pixel_row": cloud.row,
        "pixel_column": cloud.column,
        "depth_m": cloud.depth,
        "snr": cloud.snr,
        "counts": cloud.counts,
        "true_elevation": _rounded(cloud.true_elevation),
        "true_class": cloud.true_classification,
        "substrate": cloud.substrate,
        "cause": cloud.cause,
    }


def _steps(local: FloatArray, header: laspy.LasHeader, map_frame: MapFrame) -> FloatArray:
    """Return places in whole steps, east and north from the header's offsets."""
    shift = header.offsets * [1.0, 1.0, 0.0]
    return np.asarray(np.rint((map_frame.to_map(local) - shift) * EXTRA_STEPS_PER_METRE))


def _rounded(metres: FloatArray) -> FloatArray:
    return np.asarray(np.rint(metres * EXTRA_STEPS_PER_METRE) / EXTRA_STEPS_PER_METRE)

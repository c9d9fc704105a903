"""Point clouds as LAS 1.4 files, point format 6, compressed as LAZ."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from survey.flight.pose import Frame
from survey.products.gps_time import adjusted_gps_time
from survey.products.las_records import STANDARD_BYTES, Views, extra_dimensions, las_records
from survey.products.ply_file import require_finite, require_points
from survey.products.writing import ProductError, require_read_back, whole_file
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    import laspy
    from pyproj import CRS

COORDINATE_STEP = 0.001
POINTS_AT_ONCE = 1_000_000


def write_laz(
    path: Path,
    cloud: PointCloud,
    map_frame: MapFrame,
    *,
    start_utc: datetime,
    frames: Sequence[Frame],
    strip_adjustment: str = "none",
) -> None:
    """Write a cloud as LAZ (or LAS, by the suffix), every point flagged synthetic.

    Coordinates have steps of 1 mm. GPS time is adjusted standard. Intensity is the
    reflectance of the target, see `survey.cloud.reflectance`, in steps of 0.0001, clipped to 0 and
    65535, and 0 where there is no echo; the extra bytes ``reflectance`` have it unclipped, and
    ``counts`` the echo's photo-electrons. The scan angle lies across the track, positive to the
    right. The point source is the survey line plus one. Surface is return 1 of 2, bottom 2 of 2,
    all else 1 of 1.

    Parameters
    ----------
    path : Path
        File to write, ending in ``.laz`` or ``.las``.
    cloud : PointCloud
        Points in the scene's local frame.
    map_frame : MapFrame
        Where that frame lies on the map, with its compound CRS, written as OGC WKT.
    start_utc : datetime
        Start of the mission; the file's creation date as well.
    frames : sequence of Frame
        Flashes that the cloud's points name, for the scan angle.
    strip_adjustment : str
        How lines were brought together; unless "none" the header's generating software says it.

    Raises
    ------
    ProductError
        If the cloud is empty or a position is not finite.
    ReadBackError
        If the file does not read back as written.
    """
    with laz_file(
        path, map_frame, start_utc=start_utc, frames=frames, strip_adjustment=strip_adjustment
    ) as add:
        add(cloud)


@contextmanager
def laz_file(
    path: Path,
    map_frame: MapFrame,
    *,
    start_utc: datetime,
    frames: Sequence[Frame],
    strip_adjustment: str = "none",
) -> Iterator[Callable[[PointCloud], None]]:
    """Give a function that adds points to a LAZ file; see `write_laz`."""
    import laspy

    header = _header(map_frame, start_utc)
    if strip_adjustment != "none":
        header.generating_software = f"bathyflash adjust {strip_adjustment}"
    views = Views.of(frames)
    count = checksum = 0
    with whole_file(path) as partial:
        with laspy.open(str(partial), mode="w", header=header) as file:

            def add(cloud: PointCloud) -> None:
                nonlocal count, checksum
                if len(cloud) == 0:
                    return
                require_finite(path, cloud, ("position", "uncorrected", "true_surface"))
                points = las_records(header, cloud, map_frame, start_utc=start_utc, views=views)
                file.write_points(points)
                count, checksum = count + len(cloud), _checksum(points, checksum)

            yield add
            require_points(path, count)
        require_read_back(path, "points", _count_and_checksum(partial) == (count, checksum))


def _count_and_checksum(path: Path) -> tuple[int, int]:
    """Read the standard fields of all points back; others are read by nobody but for their size."""
    import laspy

    wanted = laspy.DecompressionSelection.all() & ~laspy.DecompressionSelection.ALL_EXTRA_BYTES
    count = checksum = 0
    with laspy.open(str(path), decompression_selection=wanted) as file:
        for points in file.chunk_iterator(POINTS_AT_ONCE):
            count, checksum = count + len(points), _checksum(points, checksum)
    return count, checksum


def _checksum(points: Any, before: int) -> int:
    """Return the CRC-32 of the standard fields of records, after that of the records before."""
    records = points.array
    standard = records.view(np.uint8).reshape(records.size, -1)[:, :STANDARD_BYTES]
    return crc32(standard.tobytes(), before)


def read_laz(path: Path, map_frame: MapFrame, *, start_utc: datetime) -> PointCloud:
    """Read a cloud that `write_laz` wrote, in the local frame of ``map_frame``.

    Raises
    ------
    ProductError
        If the file has another CRS.
    """
    import laspy

    las = laspy.read(str(path))
    _require_crs(path, las.header.parse_crs(), map_frame)

    def place(prefix: str) -> NDArray[np.float64]:
        on_map = np.stack([np.asarray(las[f"{prefix}{axis}"]) for axis in "xyz"], axis=1)
        return map_frame.to_local(on_map)

    return PointCloud(
        position=map_frame.to_local(np.asarray(las.xyz)),
        uncorrected=place("uncorrected_"),
        truth=place("true_"),
        classification=np.array(las.classification, dtype=np.uint8),
        true_classification=np.array(las.true_class),
        substrate=np.array(las.substrate),
        true_elevation=np.array(las.true_elevation, dtype=np.float64),
        true_surface=place("true_surface_"),
        true_normal=np.stack([np.array(las[f"true_normal_{axis}"]) for axis in "xyz"], axis=1),
        water_path=np.array(las.true_water_path),
        tvu=np.array(las.total_tvu),
        thu=np.array(las.total_thu),
        surface_elevation=np.array(las.surface_z, dtype=np.float64),
        reflectance=np.array(las.reflectance),
        true_reflectance=np.array(las.true_reflectance),
        cause=np.array(las.cause),
        time=np.asarray(las.gps_time) - adjusted_gps_time(start_utc, np.zeros(1)),
        depth=np.array(las.depth_m, dtype=np.float64),
        counts=np.array(las.counts),
        snr=np.array(las.snr),
        frame=np.array(las.frame),
        line=np.asarray(las.point_source_id) - np.uint16(1),
        row=np.array(las.pixel_row),
        column=np.array(las.pixel_column),
    )


def _require_crs(path: Path, found: CRS | None, map_frame: MapFrame) -> None:
    parts = [] if found is None else [part.to_epsg() for part in found.sub_crs_list]
    if parts != [map_frame.epsg, map_frame.vertical_epsg]:
        raise ProductError(
            f"{path}: CRS: {found.name if found else 'none'} instead of {map_frame.crs.name}. "
            "Transform the cloud first"
        )


def _header(map_frame: MapFrame, start_utc: datetime) -> laspy.LasHeader:
    import laspy
    from laspy.header import GpsTimeType
    from laspy.vlrs.known import WktCoordinateSystemVlr

    header = laspy.LasHeader(version="1.4", point_format=6)
    header.scales = np.full(3, COORDINATE_STEP)
    header.offsets = np.floor(map_frame.origin)
    header.creation_date = start_utc.astimezone(UTC).date()
    header.system_identifier = "bathyflash simulation"
    header.generating_software = "bathyflash"
    header.global_encoding.gps_time_type = GpsTimeType.STANDARD
    header.global_encoding.wkt = True
    header.vlrs.append(WktCoordinateSystemVlr(map_frame.crs.to_wkt("WKT1_GDAL")))
    header.add_extra_dims(extra_dimensions(header))
    for about in header.vlrs.get("ExtraBytesVlr")[0].extra_bytes_structs:
        about.options &= ~(about.MIN_BIT_MASK | about.MAX_BIT_MASK)
    return header

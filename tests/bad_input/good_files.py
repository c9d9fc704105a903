"""Sound inputs of every kind, small, for tests that break them."""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import laspy
import numpy as np
import trimesh
from pyproj import CRS
from rasterio.io import MemoryFile
from rasterio.transform import Affine

from survey.flight.files.cblue_file import cblue_text
from survey.flight.files.sbet_file import sbet_bytes
from survey.flight.track import Track
from survey.scenario.scenario import with_changes
from survey.scenario.toml_text import to_toml
from tests.small_scenario import small_tables

EPSG = 25832
EAST, NORTH = 500250.0, 6000750.0
BASE = small_tables(**{"seabed.margin_m": 20.0})
STATED_WATER = {"absorption_per_m": 0.1, "scattering_per_m": 0.3}


@dataclass(frozen=True, kw_only=True)
class Good:
    """A sound file, and what a scenario says to use it.

    Parameters
    ----------
    file : str
        Its name.
    make : callable
        Its content.
    used_by : mapping
        Changes of `BASE` by dotted key; empty where the file is no scenario's.
    """

    file: str
    make: Callable[..., bytes]
    used_by: Mapping[str, Any] = field(default_factory=dict)

    def scenario(self, file: str) -> str:
        """Return a scenario that uses a file of this kind."""
        text = to_toml(with_changes(BASE, self.used_by, name="a test"))
        return text.replace(json.dumps(FILE), json.dumps(file))


FILE = "the file"
"""Stands for the name of the file in the changes of a scenario."""


def scenario_text() -> bytes:
    """A scenario with some of everything."""
    return (Path(__file__).parent / "reef.toml").read_bytes()


def bed_mesh() -> trimesh.Trimesh:
    """A bed of 9 x 5 vertices from 12 to 8 m depth, about the flight's start."""
    x, y = np.meshgrid(np.linspace(-100.0, 300.0, 9), np.linspace(-100.0, 100.0, 5))
    z = -12.0 + 0.01 * (x + 100.0)
    corner = (np.arange(4)[:, None] * 9 + np.arange(8)).ravel()
    faces = np.concatenate(
        [
            np.column_stack([corner, corner + 1, corner + 10]),
            np.column_stack([corner, corner + 10, corner + 9]),
        ]
    )
    return trimesh.Trimesh(np.column_stack([x.ravel(), y.ravel(), z.ravel()]), faces, process=False)


def mesh(kind: str, **how: Any) -> Callable[[], bytes]:
    """Return a maker of the bed in a mesh format."""

    def make() -> bytes:
        content = bed_mesh().export(file_type=kind, **how)
        return content if isinstance(content, bytes) else str(content).encode()

    return make


def raster(*, rows: int = 40, value: float | None = None, **about: Any) -> bytes:
    """A GeoTIFF of cells of 4 m, 10 m deep and shallower."""
    values = -10.0 + 0.02 * np.indices((rows, 80)).sum(axis=0)
    return _geotiff(values.astype("float32"), value, **({"nodata": -9999.0} | about))


def cover(*, value: float | None = None, **about: Any) -> bytes:
    """A map of two materials."""
    values = 1 + (np.indices((40, 80))[1] > 40)
    return _geotiff(values.astype("uint8"), value, **({"nodata": 0} | about))


def _geotiff(values: Any, value: float | None, **about: Any) -> bytes:
    """A GeoTIFF, all cells of one value if it is given, with what is said about it."""
    cell, west = about.pop("cell", 4.0), about.pop("west", EAST - 120.0)
    unit, scale = about.pop("unit", ""), about.pop("scale", 1.0)
    profile: dict[str, Any] = {
        "driver": "GTiff",
        "height": values.shape[0],
        "width": values.shape[1],
        "count": 1,
        "dtype": values.dtype,
        "crs": f"EPSG:{EPSG}",
        "transform": Affine(cell, 0.0, west, 0.0, -cell, NORTH + 80.0),
    }
    if value is not None:
        values[:] = value
    said = {key: None if given is False else given for key, given in about.items()}
    with MemoryFile() as memory:
        with memory.open(**(profile | said)) as sink:
            sink.write(values, 1)
            sink.units, sink.scales = (unit,), (scale,)
        return bytes(memory.read())


def las(*, compressed: bool = False, epsg: int = EPSG) -> bytes:
    """Points of class 40 every 8 m; without a coordinate system where ``epsg`` is 0."""
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales, header.offsets = np.full(3, 0.001), np.array([EAST, NORTH, 0.0])
    if epsg:
        header.add_crs(CRS.from_epsg(epsg))
    data = laspy.LasData(header)
    east, north = np.meshgrid(np.arange(-120.0, 200.0, 8.0), np.arange(-80.0, 80.0, 8.0))
    data.x, data.y = EAST + east.ravel(), NORTH + north.ravel()
    data.z = -10.0 + 0.01 * east.ravel()
    data.classification = np.full(east.size, 40)
    sink = io.BytesIO()
    data.write(sink, do_compress=compressed)
    return sink.getvalue()


def laz(*, chunk_table: int | None = None, noise: bool = False, epsg: int = EPSG) -> bytes:
    """The same compressed; its chunk table said to be elsewhere, or its points random bytes."""
    content = bytearray(las(compressed=True, epsg=epsg))
    first = struct.unpack_from("<I", content, 96)[0]
    if chunk_table is not None:
        content[first : first + 8] = struct.pack("<q", chunk_table)
    if noise:
        content[first:] = np.random.default_rng(1).bytes(len(content) - first)
    return bytes(content)


def track() -> Track:
    """Five seconds east at 100 m/s."""
    time = np.arange(0.0, 5.5, 0.5)
    return Track(
        time=time,
        position=np.column_stack(
            [EAST + 100.0 * time, np.full(len(time), NORTH), 200.0 + 0.1 * time]
        ),
        roll=0.01 * np.sin(time),
        pitch=np.full(len(time), 0.01),
        heading=np.full(len(time), 0.5 * np.pi),
    )


def track_csv() -> bytes:
    """The track as named columns."""
    flown = track()
    angles = np.degrees(np.column_stack([flown.roll, flown.pitch, flown.heading]))
    rows = np.column_stack([flown.time, flown.position, angles])
    head = "time_s,easting_m,northing_m,up_m,roll_deg,pitch_deg,heading_deg"
    return "\n".join([head, *(",".join(f"{v:.6g}" if v < 1e5 else f"{v:.3f}" for v in row)
                              for row in rows), ""]).encode()  # fmt: skip


def track_cblue() -> bytes:
    """The track as cBLUE's text."""
    deviations = (0.02, 0.02, 0.03, 1e-4, 1e-4, 2e-4)
    return cblue_text(track(), epsg=EPSG, deviations=deviations).encode()


def track_sbet(*, order: str = "<") -> bytes:
    """The track as SBET, of either byte order."""
    content = sbet_bytes(track(), epsg=EPSG)
    return np.frombuffer(content, "<f8").astype(f"{order}f8").tobytes()


def phase_table() -> bytes:
    """A peaked phase function."""
    angles = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0)
    rows = [f"{angle:g},{(angle + 0.5) ** -1.3:.6g}" for angle in angles]
    return "\n".join(["angle_deg,value", *rows, ""]).encode()


def area() -> bytes:
    """A field of 300 x 120 m on the map."""
    ring = [[EAST, NORTH], [EAST + 300.0, NORTH], [EAST + 300.0, NORTH + 120.0],
            [EAST, NORTH + 120.0], [EAST, NORTH]]  # fmt: skip
    return json.dumps(
        {
            "type": "FeatureCollection",
            "crs": {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{EPSG}"}},
            "features": [
                {
                    "type": "Feature",
                    "properties": {"name": "field"},
                    "geometry": {"type": "Polygon", "coordinates": [ring]},
                }
            ],
        },
        indent=1,
    ).encode()


def cast() -> bytes:
    """A cast of four depths."""
    rows = ("0,0.2,0.6,0.018", "2,0.15,0.4,0.018", "6,0.1,0.3,0.015", "12,0.1,0.25,0.015")
    head = "depth_m,absorption_per_m,scattering_per_m,backscatter_fraction"
    return "\n".join([head, *rows, ""]).encode()


def cloud_csv() -> bytes:
    """Points on the bed of the scored run."""
    rows = [
        f"{EAST + x:.3f},{NORTH + y:.3f},{-3.5 - 0.05 * x:.3f},40"
        for x in range(-20, 24, 4)
        for y in (-8, 0, 8)
    ]
    return "\n".join(["easting_m,northing_m,elevation_m,classification", *rows, ""]).encode()


def cloud_ply() -> bytes:
    """The same points as a binary PLY file."""
    rows = [row.split(",") for row in cloud_csv().decode().splitlines()[1:]]
    names = "".join(f"property double {axis}\n" for axis in "xyz")
    head = f"ply\nformat binary_little_endian 1.0\ncomment epsg {EPSG}\n"
    head += f"element vertex {len(rows)}\n{names}property uchar classification\nend_header\n"
    body = b"".join(struct.pack("<dddB", *map(float, row[:3]), int(row[3])) for row in rows)
    return head.encode() + body


IN_METRES = {"seabed.kind": "mesh", "seabed.depth_m": None, "seabed.file": FILE}
IN_METRES |= {"seabed.offset_easting_m": EAST, "seabed.offset_northing_m": NORTH}
RASTER = {"seabed.kind": "raster", "seabed.depth_m": None, "seabed.file": FILE}
POINTS = {"seabed.kind": "points", "seabed.depth_m": None, "seabed.file": FILE}
POINTS |= {"seabed.cell_m": 8.0}
CLASSES = [{"value": 1, "substrate": "sand"}, {"value": 2, "substrate": "rock"}]
RECORDED = {"flight": {"file": FILE}}
TABLE = {**STATED_WATER, "phase_function": {"kind": "table", "file": FILE}}

GOOD_FILES: dict[str, Good] = {
    "scenario": Good(file="reef.toml", make=scenario_text),
    "mesh_ply": Good(file="bed.ply", make=mesh("ply", encoding="ascii"), used_by=IN_METRES),
    "mesh_ply_binary": Good(file="bed-binary.ply", make=mesh("ply"), used_by=IN_METRES),
    "mesh_obj": Good(file="bed.obj", make=mesh("obj"), used_by=IN_METRES),
    "mesh_stl": Good(file="bed.stl", make=mesh("stl"), used_by=IN_METRES),
    "mesh_off": Good(file="bed.off", make=mesh("off"), used_by=IN_METRES),
    "mesh_glb": Good(file="bed.glb", make=mesh("glb"), used_by=IN_METRES),
    "raster": Good(file="bed.tif", make=raster, used_by=RASTER),
    "cover": Good(
        file="cover.tif", make=cover, used_by={"seabed.map": {"file": FILE, "classes": CLASSES}}
    ),
    "las": Good(file="bed.las", make=las, used_by=POINTS),
    "laz": Good(file="bed.laz", make=laz, used_by=POINTS),
    "track_csv": Good(file="track.csv", make=track_csv, used_by=RECORDED),
    "track_cblue": Good(file="track.txt", make=track_cblue, used_by=RECORDED),
    "track_sbet": Good(file="track.sbet", make=track_sbet, used_by=RECORDED),
    "phase": Good(file="phase.csv", make=phase_table, used_by={"water": TABLE}),
    "area": Good(
        file="area.geojson", make=area, used_by={"flight": {"file": FILE, "heading_deg": 90.0}}
    ),
    "cast": Good(file="cast.csv", make=cast, used_by={"water": {"profile": FILE}}),
    "cloud_csv": Good(file="cloud.csv", make=cloud_csv),
    "cloud_ply": Good(file="cloud.ply", make=cloud_ply),
    "cloud_laz": Good(file="cloud.laz", make=laz),
}

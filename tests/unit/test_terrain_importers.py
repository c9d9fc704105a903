"""Files become seabeds where they say, gaps stay gaps, and unusable files say why."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import laspy
import numpy as np
import pytest
import rasterio
from pyproj import CRS
from rasterio.transform import Affine

from terrain.importers import SeabedFileError, from_las, from_mesh_file, from_raster, read_mesh
from terrain.roughness import Roughness

DUCK = Path(__file__).resolve().parents[2] / "scenarios" / "data" / "duck_5m_epsg32119.tif"
UTM: dict[str, Any] = {"epsg": 25832, "vertical_epsg": 5714, "reflectance": 0.1}


def write_raster(path: Path, z: np.ndarray, **changes: Any) -> Path:
    profile: dict[str, Any] = {
        "driver": "GTiff",
        "height": z.shape[0],
        "width": z.shape[1],
        "count": 1,
        "dtype": "float32",
        "crs": "EPSG:25832",
        "transform": Affine(2.0, 0.0, 500000.0, 0.0, -2.0, 6000100.0),
        "nodata": -9999.0,
    }
    with rasterio.open(path, "w", **(profile | changes)) as sink:
        sink.write(z.astype("float32"), 1)
    return path


def elevation_on_map(seabed: Any, east: Any, north: Any) -> np.ndarray:
    frame = seabed.map_frame
    z: np.ndarray = seabed.elevation_at(
        np.asarray(east) - frame.easting, np.asarray(north) - frame.northing
    )
    return z


def ramp(rows: int = 30, cols: int = 40) -> np.ndarray:
    """Elevation -10 + 0.01 (east - 500000) + 0.02 (6000100 - north) at the cells' centres."""
    row, col = np.mgrid[:rows, :cols]
    return np.asarray(-10.0 + 0.01 * (2 * col + 1) + 0.02 * (2 * row + 1))


def test_a_raster_lies_where_its_cells_are(tmp_path: Path) -> None:
    """Half a cell of shift, or rows upside down, would show in the slope's value."""
    z = ramp()
    z[10, 10] = -9999.0
    seabed = from_raster(write_raster(tmp_path / "a.tif", z), **UTM)
    east, north = np.array([500005.0, 500070.0]), np.array([6000090.0, 6000050.0])
    expected = -10.0 + 0.01 * (east - 500000) + 0.02 * (6000100 - north)
    np.testing.assert_allclose(elevation_on_map(seabed, east, north), expected, atol=1e-5)
    assert np.isnan(elevation_on_map(seabed, 500021.0, 6000079.0))
    assert np.isnan(elevation_on_map(seabed, 500000.5, 6000050.0))  # half a cell at the rim
    assert (seabed.mesh.face_normals[:, 2] > 0).all()
    assert (seabed.map_frame.easting, seabed.map_frame.northing) == (500000.0, 6000100.0)
    assert (seabed.map_frame.epsg, seabed.map_frame.vertical_epsg) == (25832, 5714)


def test_a_turned_raster_is_turned(tmp_path: Path) -> None:
    sine, cosine = 0.5, np.sqrt(0.75)
    turn = Affine(2 * cosine, -3 * sine, 500000.0, 2 * sine, 3 * cosine, 6000000.0)
    path = write_raster(tmp_path / "turned.tif", ramp(), transform=turn)
    seabed = from_raster(path, **UTM)
    east = turn.a * 20.5 + turn.b * 10.5 + turn.c
    north = turn.d * 20.5 + turn.e * 10.5 + turn.f
    assert elevation_on_map(seabed, east + 1e-6, north) == pytest.approx(ramp()[10, 20], abs=1e-4)
    assert (seabed.mesh.face_normals[:, 2] > 0).all()


def test_only_the_cells_about_an_outline_are_meshed(tmp_path: Path) -> None:
    path = write_raster(tmp_path / "a.tif", ramp(200, 300))
    outline = np.array([[500100.0, 5999900.0], [500160.0, 5999900.0], [500130.0, 5999950.0]])
    seabed = from_raster(path, outline=outline, margin=10.0, **UTM)
    low, high = seabed.mesh.bounds[:, :2] + [seabed.map_frame.easting, seabed.map_frame.northing]
    assert (low <= [500090.0, 5999890.0]).all()
    assert (low > [500080.0, 5999880.0]).all()
    assert (high >= [500170.0, 5999960.0]).all()
    whole = from_raster(path, **UTM)
    assert elevation_on_map(seabed, 500131.3, 5999917.7) == pytest.approx(
        float(elevation_on_map(whole, 500131.3, 5999917.7)), abs=1e-9
    )
    with pytest.raises(SeabedFileError, match="does not reach the flight"):
        from_raster(path, outline=outline + 5000.0, **UTM)


def test_refining_is_smooth_and_keeps_holes(tmp_path: Path) -> None:
    row, col = np.mgrid[:40, :40]
    z = -10.0 + np.sin(col / 2.0) * np.cos(row / 3.0)
    z[20:22, 20:22] = -9999.0
    path = write_raster(tmp_path / "wave.tif", z)
    coarse, fine = from_raster(path, **UTM), from_raster(path, spacing=0.5, **UTM)
    east, north = 500000.0 + 2 * 11.0, 6000100.0 - 2 * 7.0
    truth = -10.0 + np.sin(10.5 / 2.0) * np.cos(6.5 / 3.0)
    assert abs(elevation_on_map(fine, east, north) - truth) < 0.003
    assert abs(elevation_on_map(coarse, east, north) - truth) > 0.02
    assert np.isnan(elevation_on_map(fine, 500000.0 + 2 * 21.0, 6000100.0 - 2 * 21.0))


def test_added_roughness_is_stated(tmp_path: Path) -> None:
    path = write_raster(tmp_path / "flat.tif", np.full((50, 50), -8.0))
    relief = Roughness(rms=0.1, spectral_slope=3.0, longest_wavelength=20.0, seed=1)
    seabed = from_raster(path, roughness=relief, **UTM)
    assert seabed.mesh.vertices[:, 2].std() == pytest.approx(0.1, rel=1e-6)
    assert "Synthetic roughness" in seabed.source
    assert "Synthetic" not in from_raster(path, **UTM).source


def test_the_measured_seabed_of_duck() -> None:
    seabed = from_raster(DUCK, epsg=32119, vertical_epsg=5703, reflectance=0.1)
    assert seabed.mesh.bounds[0, 2] == pytest.approx(-9.4, abs=0.05)
    assert seabed.mesh.bounds[1, 2] == pytest.approx(6.9, abs=0.05)
    assert 1.7e6 < (seabed.mesh.area_faces * seabed.mesh.face_normals[:, 2]).sum() < 1.8e6
    assert seabed.map_frame.crs.name == "NAD83 / North Carolina + NAVD88 height"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"crs": "EPSG:25833"}, "crs: ETRS89 / UTM zone 33N, but the scenario says EPSG:25832"),
        ({"crs": "EPSG:4326"}, "crs: WGS 84 is not projected"),
        ({"crs": "EPSG:2264"}, "counts in US survey foot"),
        ({"crs": None}, "crs: none in the file"),
    ],
)
def test_another_crs_is_refused(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    path = write_raster(tmp_path / "a.tif", ramp(), **changes)
    with pytest.raises(SeabedFileError) as refused:
        from_raster(path, **UTM)
    assert words in str(refused.value)
    assert str(refused.value).startswith(str(path))


def test_other_faults_of_a_raster(tmp_path: Path) -> None:
    path = write_raster(tmp_path / "a.tif", ramp())
    with pytest.raises(SeabedFileError, match="band 2: the raster has 1"):
        from_raster(path, band=2, **UTM)
    with pytest.raises(SeabedFileError, match="no three neighbouring"):
        from_raster(write_raster(tmp_path / "void.tif", np.full((9, 9), -9999.0)), **UTM)
    (tmp_path / "words.tif").write_text("not a raster")
    with pytest.raises(SeabedFileError, match="not a readable raster"):
        from_raster(tmp_path / "words.tif", **UTM)
    with pytest.raises(FileNotFoundError, match=r"absent\.tif"):
        from_raster(tmp_path / "absent.tif", **UTM)


def write_las(path: Path, xyz: np.ndarray, classes: np.ndarray, epsg: int = 25832) -> Path:
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales, header.offsets = np.full(3, 0.001), np.array([500000.0, 6000000.0, 0.0])
    header.add_crs(CRS.from_epsg(epsg))
    data = laspy.LasData(header)
    data.x, data.y, data.z = xyz.T
    data.classification = classes
    data.write(path)
    return path


def cloud(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A plane of class 40 over 100 x 60 m with a gap of 20 m, fish above, spikes below."""
    xy = rng.uniform([0, 0], [100, 60], size=(40_000, 2))
    xy = xy[(xy[:, 0] < 40) | (xy[:, 0] > 60)]
    z = -10.0 + 0.02 * xy[:, 0] + 0.02 * rng.standard_normal(len(xy))
    classes = np.full(len(xy), 40)
    z[::50], classes[::50] = -4.0, 45
    z[7::400] = -200.0
    return np.c_[xy + np.array([500000.0, 6000000.0]), z], classes


@pytest.mark.parametrize("name", ["points.las", "points.laz"])
def test_points_of_a_class_become_a_surface_with_its_gap(tmp_path: Path, name: str) -> None:
    path = write_las(tmp_path / name, *cloud(np.random.default_rng(1)))
    seabed = from_las(path, classes=[2, 40], cell=1.0, **UTM)
    east = np.array([500010.0, 500030.0, 500080.0])
    z = elevation_on_map(seabed, east, 6000030.0)
    np.testing.assert_allclose(z, -10.0 + 0.02 * (east - 500000.0), atol=0.06)
    assert seabed.mesh.vertices[:, 2].min() > -11.0  # the median passes no single spike
    assert np.isnan(elevation_on_map(seabed, 500050.0, 6000030.0))
    assert (seabed.mesh.face_normals[:, 2] > 0).all()


def test_points_about_an_outline(tmp_path: Path) -> None:
    path = write_las(tmp_path / "a.las", *cloud(np.random.default_rng(1)))
    outline = np.array([[500010.0, 6000010.0], [500020.0, 6000020.0]])
    seabed = from_las(path, classes=[40], cell=1.0, outline=outline, margin=5.0, **UTM)
    np.testing.assert_allclose(seabed.mesh.extents[:2], 20.0, atol=1.0)


def test_faults_of_a_point_file(tmp_path: Path) -> None:
    points, classes = cloud(np.random.default_rng(1))
    path = write_las(tmp_path / "a.las", points, classes)
    with pytest.raises(SeabedFileError, match="0 points of classes 2"):
        from_las(path, classes=[2], cell=1.0, **UTM)
    other = write_las(tmp_path / "b.las", points, classes, epsg=25833)
    with pytest.raises(SeabedFileError, match="UTM zone 33N, but the scenario says"):
        from_las(other, classes=[40], cell=1.0, **UTM)
    (tmp_path / "c.las").write_bytes(b"LASFjunk" * 60)
    with pytest.raises(SeabedFileError, match="not a readable LAS"):
        from_las(tmp_path / "c.las", classes=[40], cell=1.0, **UTM)
    whole = path.read_bytes()
    (tmp_path / "short.las").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(SeabedFileError, match="cut short"):
        from_las(tmp_path / "short.las", classes=[40], cell=1.0, **UTM)
    row = np.c_[np.arange(5.0) + 500000, np.full(5, 6000000.0), np.zeros(5)]
    line = write_las(tmp_path / "d.las", row, np.full(5, 40))
    with pytest.raises(SeabedFileError, match="too far apart"):
        from_las(line, classes=[40], cell=0.5, **UTM)


def test_a_mesh_file_keeps_its_coordinates(tmp_path: Path) -> None:
    path = tmp_path / "bed.obj"
    path.write_text(
        "v 500000.125 6000000.25 -7.5\nv 500010 6000000 -7.5\nv 500010 6000010 -8.5\n"
        "v 500000 6000010 -8.5\nv 500000 6000010 -8.5\nf 1 2 3\nf 1 3 4\nf 3 4 5\n"
    )
    seabed = from_mesh_file(path, **UTM)
    assert len(seabed.mesh.faces) == 2  # the third has no area
    on_map = seabed.map_frame.to_map(np.asarray(seabed.mesh.vertices))
    np.testing.assert_allclose(on_map[0], [500000.125, 6000000.25, -7.5], atol=1e-9)
    moved = from_mesh_file(path, offset=(1000.0, 0.0, 1.0), **UTM)
    assert elevation_on_map(moved, 501005.0, 6000005.0) == pytest.approx(-7.0, abs=0.05)


PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.ply", PLY + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "face 0: index 7, but there are 3"),
        ("b.ply", PLY + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "vertex 1: a coordinate is not"),
        ("c.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", "v"),
        ("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "d.obj"),
        ("e.stl", "solid nothing\nendsolid nothing\n", "e.stl"),
        ("f.xyz", "nothing", "f.xyz"),
    ],
)
def test_a_broken_mesh_is_refused_with_the_place(
    tmp_path: Path, name: str, text: str, words: str
) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(SeabedFileError) as refused:
        read_mesh(path)
    assert words in str(refused.value)
    assert str(refused.value).startswith(str(path))

"""Finished runs in other formats: read back by others, refused when they are not whole."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.errors import UserError
from survey.export import FORMATS, WAVEFORMS, FinishedRun, export_run, parse_formats
from survey.products.cog_file import write_bathymetry_cog
from survey.products.grids import BANDS, grid_elevation
from survey.products.las_file import write_laz
from survey.products.ply_file import write_ply
from survey.products.tif_file import write_bathymetry_tif
from survey.products.writing import ProductError

CELL = 6.0


@pytest.fixture(scope="session")
def finished(small_survey: Any, tmp_path_factory: pytest.TempPathFactory) -> FinishedRun:
    """A run folder's clouds and grid."""
    folder = tmp_path_factory.mktemp("finished")
    frame, start = small_survey.map_frame, small_survey.start_utc
    for name, cloud in (("bottom", small_survey.bottom), ("water_surface", small_survey.surface)):
        write_ply(folder / f"{name}.ply", cloud, frame)
        frames = small_survey.frames
        write_laz(folder / f"{name}.laz", cloud, frame, start_utc=start, frames=frames)
    grid = grid_elevation(small_survey.bottom, frame, cell_size=CELL)
    write_bathymetry_tif(folder / "bathymetry.tif", grid, frame)
    level = small_survey.water_level
    return FinishedRun(folder=folder, map_frame=frame, water_level=level)


Exporting = Callable[..., list[Path]]


@pytest.fixture
def exported(finished: FinishedRun, tmp_path: Path) -> Exporting:
    """Return a function that exports into a folder of the test."""

    def export(name: str, **options: bool) -> list[Path]:
        return list(export_run(finished, tmp_path, formats=[name], **options))

    return export


@pytest.mark.parametrize("name", ["las", "laz"])
def test_las_holds_the_points_of_the_run(exported: Exporting, finished: Any, name: str) -> None:
    import laspy

    for path in exported(name):
        source = laspy.read(str(finished.folder / f"{path.stem}.laz"))
        copy = laspy.read(str(path))
        assert copy.points.array.tobytes() == source.points.array.tobytes()
        assert copy.header.creation_date == source.header.creation_date
        assert copy.header.parse_crs() == source.header.parse_crs()
        assert copy.header.are_points_compressed == (name == "laz")


@pytest.mark.parametrize("name", ["las", "laz", "copc"])
def test_standard_only_holds_no_truth(exported: Exporting, small_survey: Any, name: str) -> None:
    import laspy

    path = exported(name, standard_only=True)[0]
    las = laspy.read(str(path))
    assert (las.point_format.id, las.point_format.size) == (6, 30)
    assert not las.header.vlrs.get("ExtraBytesVlr")
    assert las.header.parse_crs() is not None
    assert np.all(las.synthetic == 1)
    count = np.bincount(small_survey.bottom.classification)
    assert np.array_equal(np.bincount(las.classification), count)
    assert b"true_" not in path.read_bytes()


def test_copc_is_read_by_level_and_bounds(exported: Exporting, small_survey: Any) -> None:
    import laspy

    path = exported("copc")[0]
    on_map = small_survey.map_frame.to_map(small_survey.bottom.position)
    middle = np.median(on_map, axis=0)
    with laspy.CopcReader.open(str(path)) as reader:
        everything = reader.query()
        coarse = reader.query(level=0)
        bounds = laspy.copc.Bounds(mins=on_map[:, :2].min(axis=0) - 1.0, maxs=middle[:2])
        corner = reader.query(bounds=bounds)
        spacing = reader.copc_info.spacing
        centre, halfsize = reader.copc_info.center, reader.copc_info.halfsize
    places, seen = (np.stack([each.x, each.y, each.z], axis=1) for each in (everything, coarse))
    assert len(places) == len(on_map)
    assert np.all(np.abs(places - centre) <= halfsize + 1e-6)
    inside = (np.round(on_map[:, :2], 3) <= middle[:2]).all(axis=1)
    assert len(corner) == pytest.approx(inside.sum(), abs=2)
    cells = np.unique(np.floor((seen - centre) / spacing + 1e-6), axis=0)
    assert len(coarse) == len(cells) < len(everything)
    assert np.array_equal(np.sort(everything.true_x), np.sort(laspy.read(str(path)).true_x))


def test_every_copc_node_has_its_parent() -> None:
    from survey.products.copc_file import CELLS_PER_NODE, octree

    random = np.random.default_rng(3)
    places = (random.random((20_000, 3)) ** 3 * [60_000, 60_000, 900]).astype(np.int64)
    places[:5] = places[5]
    nodes = octree(places, 1 << 16)
    assert np.array_equal(np.sort(np.concatenate(list(nodes.values()))), np.arange(20_000))
    for (level, *key), points in nodes.items():
        assert level == 0 or (level - 1, *(k // 2 for k in key)) in nodes
        side = (1 << 16) >> level
        assert np.all(places[points] // side == key)
        cells = places[points] // max(side // CELLS_PER_NODE, 1)
        assert level == 20 or len(np.unique(cells, axis=0)) == len(points)


def test_ply_is_the_run_s_own_or_without_truth(exported: Exporting, finished: Any) -> None:
    path = exported("ply")[0]
    own = (finished.folder / "bottom.ply").read_bytes()
    assert path.read_bytes() == own
    bare = exported("ply", standard_only=True)[0].read_bytes()
    text, _, body = bare.partition(b"end_header\n")
    names = [line.split()[2] for line in text.decode().splitlines() if line[:8] == "property"]
    assert names == ["x", "y", "z", "time_s", "line", "classification"]
    columns = np.dtype([("place", "<f8", 3), ("time", "<f8"), ("line", "<u2"), ("class", "u1")])
    points = np.frombuffer(body, columns)
    record = len(own.partition(b"end_header\n")[2]) // len(points)
    assert points["place"].tobytes() == b"".join(
        own[-record * (len(points) - number) :][:24] for number in range(len(points))
    )


@pytest.mark.parametrize("name", ["ply", "obj", "stl"])
def test_meshes_stand_at_their_offset(exported: Exporting, finished: Any, name: str) -> None:
    import trimesh

    path = exported(name)[-1]
    offset = json.loads(path.with_name("bathymetry.offset.json").read_text())
    mesh = trimesh.load_mesh(str(path))
    known = np.isfinite(finished.grid.elevation)
    centres = finished.grid.cells.centres()[known]
    origin = [offset["origin_easting"], offset["origin_northing"]]
    on_map = mesh.vertices[:, :2] + origin
    assert np.all(on_map.min(axis=0) >= centres.min(axis=0) - 1e-3)
    assert np.all(on_map.max(axis=0) <= centres.max(axis=0) + 1e-3)
    assert mesh.vertices[:, 2].min() == pytest.approx(np.nanmin(finished.grid.elevation), abs=1e-3)
    assert np.all(mesh.face_normals[:, 2] > 0.0)
    assert offset["epsg"] == 25832


def test_cog_is_tiled_with_overviews_before_the_data(survey_of: Any, tmp_path: Path) -> None:
    """GDAL's rule: every directory stands before the pixels, the smallest overview's first."""
    import rasterio

    survey = survey_of(lines=2, frames_per_line=4)
    grid = grid_elevation(survey.bottom, survey.map_frame, cell_size=0.5)
    path = tmp_path / "bathymetry.cog.tif"
    write_bathymetry_cog(path, grid, survey.map_frame)
    with rasterio.open(path) as file:
        assert file.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
        assert file.block_shapes == [(256, 256)] * 4
        assert file.overviews(1) == [2, 4]
        assert file.descriptions == tuple(name for name, _ in BANDS)
        assert file.crs.to_wkt().startswith("COMPD_CS")
    directories = _directories(path.read_bytes())
    assert len(directories) == 3
    assert all(place < min(min(tiles) for _, tiles in directories) for place, _ in directories)
    smallest = [min(tiles) for _, tiles in directories]
    assert smallest == sorted(smallest, reverse=True)


def _directories(content: bytes) -> list[tuple[int, list[int]]]:
    """Return place and tile offsets of every directory of a little-endian TIFF."""
    found, place = [], int.from_bytes(content[4:8], "little")
    while place:
        entries = int.from_bytes(content[place : place + 2], "little")
        for number in range(entries):
            entry = content[place + 2 + 12 * number :][:12]
            if int.from_bytes(entry[:2], "little") == 324:
                count, at = (int.from_bytes(entry[k : k + 4], "little") for k in (4, 8))
                tiles = np.frombuffer(content, "<u4", count, at) if count > 1 else np.array([at])
                found.append((place, [int(tile) for tile in tiles if tile]))
        end = place + 2 + 12 * entries
        place = int.from_bytes(content[end : end + 4], "little")
    return found


def test_other_cells_are_gridded_anew(finished: FinishedRun, tmp_path: Path) -> None:
    import rasterio

    coarse = FinishedRun(
        folder=finished.folder,
        map_frame=finished.map_frame,
        water_level=finished.water_level,
        cell_size=12.0,
    )
    (path,) = export_run(coarse, tmp_path, formats=["tif"])
    with rasterio.open(path) as file:
        assert file.transform.a == 12.0
        total = np.nansum(file.read(2)) * 144.0
    assert total == pytest.approx(np.nansum(finished.grid.density) * CELL**2)


@pytest.mark.parametrize("name", sorted(set(FORMATS) - {WAVEFORMS}))
def test_same_bytes_twice(finished: FinishedRun, tmp_path: Path, name: str) -> None:
    first, second = (
        [path.read_bytes() for path in export_run(finished, tmp_path / side, formats=[name])]
        for side in "ab"
    )
    assert first == second


def test_a_file_without_points_is_refused(finished: FinishedRun, tmp_path: Path) -> None:
    """As laspy leaves it when its writer is killed."""
    import laspy

    empty = tmp_path / "run"
    shutil.copytree(finished.folder, empty)
    header = laspy.read(str(empty / "bottom.laz")).header
    laspy.LasData(laspy.LasHeader(version="1.4", point_format=header.point_format)).write(
        str(empty / "bottom.laz")
    )
    (empty / "water_surface.laz").write_bytes(b"no LAS at all")
    run = FinishedRun(
        folder=empty,
        map_frame=finished.map_frame,
        water_level=0.0,
    )
    for name in ("las", "copc"):
        with pytest.raises(ProductError, match=r"bottom\.laz: no points in the file"):
            list(export_run(run, tmp_path / "out", formats=[name]))
    shutil.copy(finished.folder / "bottom.laz", empty)
    with pytest.raises(ProductError, match=r"water_surface\.laz: no whole LAS file"):
        list(export_run(run, tmp_path / "out", formats=["las"]))
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["bottom.las"]


def test_unknown_formats_are_all_named() -> None:
    with pytest.raises(UserError, match="'lass', 'xyz': no such format"):
        parse_formats("las,lass,xyz")


def said(*words: str) -> tuple[int, str]:
    """Return exit status and error text of the command."""
    result = CliRunner().invoke(app, ["export", *words, "--to", "las"])
    return result.exit_code, result.stderr


def test_runs_that_are_not_whole_are_refused(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    assert said(str(folder)) == (3, f"{folder}: no such file or directory.\n")
    folder.mkdir()
    status, text = said(str(folder))
    assert status == 2
    assert "holds no run" in text
    (folder / "manifest.json").write_text('{"scenario_sha256": "0"}')
    status, text = said(str(folder))
    assert status == 2
    assert "not finished: 0 whole frames, no products" in text
    (folder / "bottom.laz").write_bytes(b"")
    (folder / "metrics.json").write_text('{"frames": 3}')
    status, text = said(str(folder))
    assert status == 2
    assert "0 whole frames, but products of 3" in text

"""Gridded bathymetry: GeoTIFF and GLB."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
import trimesh

from survey.cloud.points import PointClass
from survey.products.cells import CellGrid
from survey.products.grids import grid_elevation
from survey.products.mesh_files import grid_surface, write_bathymetry_glb
from survey.products.tif_file import write_bathymetry_tif
from survey.products.writing import ProductError


def test_median_density_and_deviation_of_a_cell(small_survey: Any) -> None:
    height = np.array([-1.0, -2.0, -9.0, -4.0, -5.0, 0.25])
    place = np.array([[1.0, 1.0], [1.5, 1.0], [1.0, 1.5], [3.0, 1.0], [3.5, 1.0], [5.0, 5.0]])
    place -= [0.25, 0.75]
    cloud = small_survey.bottom.select(np.arange(6))
    cloud = replace(
        cloud,
        position=np.column_stack([place, height]),
        classification=np.array([40, 43, 40, 2, 40, 45], dtype=np.uint8),
    )
    grid = grid_elevation(cloud, small_survey.map_frame, cell_size=2.0)
    assert grid.cells.shape == (1, 2)
    assert (grid.cells.west, grid.cells.north) == (500124.0, 6000458.0)
    assert grid.elevation.tolist() == [[-2.0, -4.5]]
    assert grid.density.tolist() == [[0.75, 0.5]]
    np.testing.assert_allclose(grid.deviation, [[np.sqrt(19.0), np.sqrt(0.5)]])


def test_grid_has_the_true_shape_the_right_way_up(small_survey: Any) -> None:
    grid = grid_elevation(small_survey.bottom, small_survey.map_frame, cell_size=10.0)
    local = grid.cells.centres() - small_survey.map_frame.origin[:2]
    true = small_survey.elevation_at(local[..., 0], local[..., 1])
    filled = np.isfinite(grid.elevation)
    assert filled.sum() > 1000
    assert np.sqrt(np.mean((grid.elevation - true)[filled] ** 2)) < 0.25
    upside_down = (grid.elevation[::-1] - true)[filled & filled[::-1]]
    assert np.sqrt(np.mean(upside_down**2)) > 0.5


def test_points_on_the_water_are_not_gridded(small_survey: Any) -> None:
    surface = small_survey.bottom.select(
        small_survey.bottom.classification == PointClass.NO_BOTTOM_FOUND
    )
    assert len(surface) > 0
    with pytest.raises(ProductError, match=r"none of the .* points is seabed"):
        grid_elevation(surface, small_survey.map_frame, cell_size=2.0)


def test_a_raster_beyond_reason_is_refused() -> None:
    with pytest.raises(ProductError, match="Use larger cells"):
        CellGrid.covering(np.array([[0.0, 0.0], [1e9, 1e9]]), cell_size=1.0)


def test_tif_read_back(small_survey: Any, tmp_path: Path) -> None:
    grid = grid_elevation(small_survey.bottom, small_survey.map_frame, cell_size=8.0)
    path = tmp_path / "bathymetry.tif"
    write_bathymetry_tif(path, grid, small_survey.map_frame)
    assert [file.name for file in tmp_path.iterdir()] == ["bathymetry.tif"]
    with rasterio.open(path) as file:
        assert file.descriptions == ("elevation", "density", "standard_deviation")
        assert file.units == ("m", "1/m2", "m")
        assert file.dtypes == ("float32",) * 3
        assert np.isnan(file.nodata)
        assert file.block_shapes == [(256, 256)] * 3
        assert file.transform.e == -8.0
        assert file.transform.c % 8.0 == file.transform.f % 8.0 == 0.0
        crs = file.crs.to_wkt()
        assert '"EPSG","25832"' in crs
        assert '"EPSG","5714"' in crs
        np.testing.assert_array_equal(file.read(1), grid.elevation.astype(np.float32))
        x, y = small_survey.map_frame.to_map(small_survey.bottom.position)[100, :2]
        row, column = file.index(x, y)
        index = grid.cells.index_of(np.array([[x, y]]))[0]
        assert (row, column) == divmod(int(index), grid.cells.columns)


def test_glb_read_back(small_survey: Any, tmp_path: Path) -> None:
    grid = grid_elevation(small_survey.bottom, small_survey.map_frame, cell_size=8.0)
    path = tmp_path / "bathymetry.glb"
    write_bathymetry_glb(path, grid, small_survey.map_frame, water_level=0.25)
    scene = trimesh.load_scene(path)
    mesh = scene.to_geometry()
    _, faces = grid_surface(grid, small_survey.map_frame)
    assert mesh.faces.shape == faces.shape
    x, y, z = mesh.triangles_center.T
    error = y - small_survey.elevation_at(x, -z)
    assert np.sqrt(np.mean(error**2)) < 0.25
    assert np.all(mesh.face_normals[:, 1] > 0.0)
    assert scene.metadata["origin_easting"] == small_survey.map_frame.easting
    assert scene.metadata["epsg"] == 25832
    colours = mesh.visual.vertex_colors
    land = mesh.vertices[:, 1] > 0.25
    assert land.any()
    assert np.all(colours[land] == [196, 178, 142, 255])
    assert not np.any(np.all(colours[~land] == [196, 178, 142, 255], axis=1))


def test_surface_skips_empty_cells(small_survey: Any) -> None:
    cells = CellGrid(west=0.0, north=3.0, cell_size=1.0, rows=3, columns=3)
    elevation = np.zeros((3, 3))
    elevation[0, 0] = np.nan
    grid = grid_elevation(small_survey.bottom, small_survey.map_frame, cell_size=8.0)
    vertices, faces = grid_surface(
        replace(grid, cells=cells, elevation=elevation), small_survey.map_frame
    )
    assert len(vertices) == 8
    assert len(faces) == 2 * 3 + 1
    a, b, c = vertices[faces].transpose(1, 0, 2)
    assert np.all(np.cross(b - a, c - a)[:, 2] == 1.0)


def test_no_mesh_of_lonely_cells(small_survey: Any) -> None:
    grid = grid_elevation(small_survey.bottom, small_survey.map_frame, cell_size=1.0)
    lonely = np.full_like(grid.elevation, np.nan)
    lonely[::3, ::3] = 1.0
    with pytest.raises(ProductError, match="no three neighbouring cells"):
        grid_surface(replace(grid, elevation=lonely), small_survey.map_frame)


def test_same_bytes_twice(small_survey: Any, tmp_path: Path) -> None:
    grid = grid_elevation(small_survey.bottom, small_survey.map_frame, cell_size=8.0)
    for name in ("a", "b"):
        write_bathymetry_tif(tmp_path / f"{name}.tif", grid, small_survey.map_frame)
        write_bathymetry_glb(
            tmp_path / f"{name}.glb", grid, small_survey.map_frame, water_level=0.25
        )
    for suffix in ("tif", "glb"):
        first, second = (tmp_path / f"{name}.{suffix}" for name in "ab")
        assert first.read_bytes() == second.read_bytes()

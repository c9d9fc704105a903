"""A run opened in Python: clouds, meshes and maps for other libraries; clear words otherwise."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import rasterio
import xarray

from survey import open_run
from survey.errors import UserError
from survey.opened.run import Run
from survey.products.ply_file import PLY_RECORD
from tests.unit.conftest import Survey
from tests.unit.scored_run import make_run


@pytest.fixture(scope="module")
def run(small_survey: Survey, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return open_run(make_run(tmp_path_factory.mktemp("opened"), small_survey.bottom))


def test_a_run_says_what_it_is(run: Run) -> None:
    assert repr(run) == f"Run in {run.folder}: a benchmark, 2 frames"
    assert str(run).startswith("240 bottom points, 0 surface points\n")
    assert run.metrics == json.loads((run.folder / "metrics.json").read_text())
    assert run.scenario.mission.seed == 7
    assert run.frames == (0, 1)


def test_the_bottom_is_what_the_metrics_count(run: Run) -> None:
    assert len(run.bottom) == run.metrics["points_bottom"]
    assert run.bottom.error.mean() == pytest.approx(run.metrics["bias_m"], abs=1e-6)
    assert np.abs(run.bottom.error).max() == pytest.approx(2.0, abs=0.2)
    assert run.bottom.names == PLY_RECORD.names
    assert len(run.surface) == run.metrics["points_surface"] == 0


def test_a_part_of_a_cloud_is_a_cloud(run: Run) -> None:
    deep = run.bottom[run.bottom["frame"] == 1]
    assert 0 < len(deep) < len(run.bottom)
    assert set(deep["frame"]) == {1}
    on_map = np.stack([deep["x"], deep["y"], deep["z"]], axis=1)
    assert deep.position + run.map_frame.origin == pytest.approx(on_map, abs=1e-8)


def test_pyvista_has_places_and_columns(run: Run) -> None:
    points = run.bottom.to_pyvista()
    assert np.array_equal(points.points, run.bottom.position)
    assert points.active_scalars_name == "depth_m"
    assert set(points.point_data) == set(run.bottom.names) - set("xyz")
    assert np.array_equal(points["true_elevation"], run.bottom["true_elevation"])


def test_open3d_has_places_colours_and_columns(run: Run) -> None:
    points = run.bottom.to_open3d()
    assert np.array_equal(points.point.positions.numpy(), run.bottom.position)
    assert np.array_equal(points.point["frame"].numpy()[:, 0], run.bottom["frame"])
    plain = points.to_legacy()
    assert len(plain.points) == len(plain.colors) == len(run.bottom)


def test_mesh_and_grid_are_the_measured_bottom(run: Run) -> None:
    grid, mesh = run.grid, run.mesh
    heights = grid.elevation.values[np.isfinite(grid.elevation.values)]
    assert np.sort(mesh.vertices[:, 2]) == pytest.approx(np.sort(heights))
    assert mesh.face_normals[:, 2].min() > 0.0
    x, y = run.bottom["x"], run.bottom["y"]
    with rasterio.open(run.folder / "bathymetry.tif") as raster:
        sampled = np.array([bands[0] for bands in raster.sample(zip(x, y, strict=True))])
    places = {"easting": ("point", x), "northing": ("point", y)}
    nearest = grid.elevation.sel(xarray.Dataset(places), method="nearest")
    assert np.array_equal(nearest, sampled, equal_nan=True)
    assert grid.crs.attrs["grid_mapping_name"] == "transverse_mercator"


def test_the_seabed_is_the_true_one(run: Run) -> None:
    x, y, z = run.bottom.position.T
    known = run.bottom["true_elevation"]
    assert run.seabed.elevation_at(x, y) == pytest.approx(known, abs=1e-6)
    assert run.seabed.mesh.bounds[0][2] < z.min()


def test_words_for_what_is_not_there(run: Run, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"'dept_m': no such column\. Did you mean 'depth_m'"):
        run.bottom["dept_m"]
    with pytest.raises(UserError, match=r"frames 7: not in the run\. It holds 2 frames"):
        run.waveforms(7)
    with pytest.raises(FileNotFoundError):
        open_run(tmp_path / "none")
    with pytest.raises(UserError, match="holds no run"):
        open_run(tmp_path)

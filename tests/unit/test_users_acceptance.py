"""What users' rules and programs ask of our files, written as they would look at them.

The Norwegian generic specification of airborne laser bathymetry (2025.1) asks for LAZ with CRS and
vertical datum, the classes, a raster of density of 2 m, a terrain model of 1 m and polygons of
holes above 50 m2 with their cause. cBLUE, NOAA's estimator of uncertainty (LGPL-2.1), reads LAS by
laspy and a trajectory of 15 columns; the columns are those that its program names.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import Outcome, PointClass
from survey.export import FinishedRun, export_run
from survey.products.coverage import CoverageTally, hull_of, looked_at, write_coverage_geojson
from survey.products.grids import grid_elevation
from survey.products.las_file import write_laz
from survey.products.lines_file import write_lines_geojson
from survey.products.tif_file import write_bathymetry_tif
from survey.products.track_files import write_trajectory_files

CAUSES = {
    *("false bottom", "too deep", "merged with surface", "outside gate", "saturated", "chance"),
    *("low reflectance", "too turbid", "glint", "noise", "gap between frames", "shadow"),
}


def norwegian_faults(path: Path) -> list[str]:
    """Return what the Norwegian rules find wrong with a point file."""
    import laspy

    faults = []
    las = laspy.read(str(path))
    if path.suffix != ".laz" or not las.header.are_points_compressed:
        faults.append("not LAZ")
    crs = las.header.parse_crs()
    if crs is None or not crs.sub_crs_list:
        faults.append("no CRS with a vertical datum")
    elif not (crs.sub_crs_list[0].is_projected and crs.sub_crs_list[1].is_vertical):
        faults.append("no projected CRS with a vertical datum")
    allowed = {int(kind) for kind in PointClass}
    if not set(np.unique(las.classification)) <= allowed:
        faults.append("a class that is none of the topo-bathymetric profile")
    if not np.isin(las.classification, (2, 40)).any():
        faults.append("no ground or bottom")
    return faults


@pytest.fixture(scope="module")
def delivered(small_survey: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run."""
    folder = tmp_path_factory.mktemp("delivered")
    frame = small_survey.map_frame
    options = {"start_utc": small_survey.start_utc, "frames": small_survey.frames}
    write_laz(folder / "bottom.laz", small_survey.bottom, frame, **options)
    grid = grid_elevation(small_survey.bottom, frame, cell_size=6.0)
    write_bathymetry_tif(folder / "bathymetry.tif", grid, frame)
    return folder


def test_the_norwegian_rules_find_no_fault_with_our_points(delivered: Path) -> None:
    assert norwegian_faults(delivered / "bottom.laz") == []


def test_they_find_the_faults_of_others(delivered: Path, tmp_path: Path) -> None:
    import laspy

    las = laspy.read(str(delivered / "bottom.laz"))
    bare = laspy.LasData(laspy.LasHeader(version="1.4", point_format=6))
    bare.x, bare.y, bare.z = las.x, las.y, las.z
    bare.classification = np.full(len(las.points), 26, np.uint8)
    bare.write(str(tmp_path / "bare.las"))
    assert len(norwegian_faults(tmp_path / "bare.las")) == 4


@pytest.mark.parametrize(("cell", "band"), [(2.0, "density"), (1.0, "elevation")])
def test_density_of_2_m_and_terrain_of_1_m(
    delivered: Path, small_survey: Any, tmp_path: Path, cell: float, band: str
) -> None:
    import rasterio

    run = FinishedRun(
        folder=delivered,
        map_frame=small_survey.map_frame,
        water_level=small_survey.water_level,
        cell_size=cell,
    )
    (path,) = export_run(run, tmp_path, formats=["tif"])
    solid = np.isin(small_survey.bottom.classification, (2, 40, 43))
    with rasterio.open(path) as file:
        assert file.res == (cell, cell)
        assert file.bounds.left % cell == file.bounds.top % cell == 0.0
        assert file.crs.to_wkt().startswith("COMPD_CS")
        values = file.read(file.descriptions.index(band) + 1)
    if band == "density":
        assert np.nansum(values) * cell**2 == pytest.approx(solid.sum(), rel=1e-6)
    else:
        heights = small_survey.bottom.position[solid, 2]
        assert heights.min() - 1e-3 <= np.nanmin(values) <= np.nanmax(values)
        assert np.nanmax(values) <= heights.max() + 1e-3


def test_holes_above_50_m2_have_their_cause(small_survey: Any, tmp_path: Path) -> None:
    centre = small_survey.frames[12].pose.position[:2]
    records = []
    for record in small_survey.records:
        away = np.hypot(*np.moveaxis(record.true_position[..., :2] - centre, -1, 0))
        outcome = record.outcome.copy()
        outcome[away < 15.0] = Outcome.LOW_REFLECTANCE
        records.append(replace(record, outcome=outcome))
    origin = small_survey.map_frame.origin[:2]
    tally = CoverageTally(survey_area=hull_of(records) + origin, cell_size=2.0, reach=4.6)
    looks = [looked_at(record) for record in records]
    tally.add(
        np.concatenate([at for at, _ in looks]) + origin, np.concatenate([o for _, o in looks])
    )
    write_coverage_geojson(tmp_path / "coverage.geojson", tally.map(), small_survey.map_frame)
    features = json.loads((tmp_path / "coverage.geojson").read_text())["features"]
    holes = [f["properties"] for f in features if f["properties"]["kind"] == "hole"]
    assert {hole["cause"] for hole in holes} >= {"low reflectance"}
    assert all(hole["cause"] in CAUSES and hole["area_m2"] > 50.0 for hole in holes)
    assert {outcome.name.lower().replace("_", " ") for outcome in Outcome} - CAUSES == {
        "found",
        "dry",
    }


def test_lines_are_wgs_84_with_their_number(small_survey: Any, tmp_path: Path) -> None:
    from pyproj import Transformer

    path = tmp_path / "lines.geojson"
    write_lines_geojson(path, small_survey.frames, small_survey.map_frame)
    features = json.loads(path.read_text())["features"]
    assert [feature["properties"]["line"] for feature in features] == [0, 1, 2, 3]
    assert [feature["properties"]["flashes"] for feature in features] == [8] * 4
    places = np.concatenate([feature["geometry"]["coordinates"] for feature in features])
    x, y = Transformer.from_crs(4326, 25832, always_xy=True).transform(*places.T)
    flown = np.array([frame.measured.position for frame in small_survey.frames])
    on_map = small_survey.map_frame.to_map(flown)
    np.testing.assert_allclose(np.column_stack([x, y]), on_map[:, :2], rtol=0.0, atol=2e-3)
    single = tmp_path / "single.geojson"
    write_lines_geojson(single, small_survey.frames[:1], small_survey.map_frame)
    assert json.loads(single.read_text())["features"][0]["geometry"]["type"] == "Point"


def test_cblue_finds_every_column_of_our_points(delivered: Path, small_survey: Any) -> None:
    """By the names that its `Las` asks for: X, Y, Z, gps_time, classification, pt_src_id."""
    import laspy

    las = laspy.read(str(delivered / "bottom.laz"))
    header, points, bottom = las.header, las.points, small_survey.bottom
    place = np.stack([points[axis] for axis in "XYZ"], axis=1) * header.scales + header.offsets
    on_map = small_survey.map_frame.to_map(bottom.position)
    np.testing.assert_allclose(place, on_map, rtol=0.0, atol=5.1e-4)
    assert "classification" in points.array.dtype.names
    judged = np.isin(points["classification"], (40, 43))
    assert judged.sum() == np.isin(bottom.classification, (40, 43)).sum() > 1000
    assert np.unique(points["pt_src_id"]).tolist() == [1, 2, 3, 4]
    angle = las.scan_angle * 0.006
    assert np.abs(angle).max() < 90.0
    for name in ("total_thu", "total_tvu"):
        assert las[name].dtype == np.float32
        assert np.array_equal(las[name], getattr(bottom, name[-3:]))


def test_cblue_finds_a_pose_for_every_point(
    delivered: Path, small_survey: Any, tmp_path: Path
) -> None:
    """15 columns; it takes for each point the last pose not later, and drops lags above 1 s."""
    import laspy

    frames = small_survey.frames
    write_trajectory_files(
        tmp_path,
        frames,
        small_survey.map_frame,
        formats=["cblue"],
        start_utc=small_survey.start_utc,
        deviations=(0.02, 0.02, 0.04, 1e-4, 1e-4, 2e-4),
    )
    table = np.loadtxt(tmp_path / "20260621_trajectory.txt")
    assert table.shape == (len(frames), 15)
    time, _, _, x, y, z, roll, pitch, heading = table[:, :9].T
    las = laspy.read(str(delivered / "bottom.laz"))
    assert np.all(np.diff(time) > 0.0)
    last = np.searchsorted(time, las.gps_time + 1e-5, side="right") - 1
    assert last.min() >= 0
    assert np.abs(las.gps_time - time[last]).max() < 1.0
    measured = np.array([frame.measured.position for frame in frames])
    on_map = small_survey.map_frame.to_map(measured)
    np.testing.assert_allclose(np.column_stack([x, y, z]), on_map, rtol=0.0, atol=1e-3)
    assert np.abs(np.stack([roll, pitch])).max() == 0.0
    assert np.abs(heading - 70.0).max() < 2.0
    assert np.all(table[:, 9:12] == [0.02, 0.02, 0.04])
    assert np.abs(table[:, 12:] - np.degrees([1e-4, 1e-4, 2e-4])).max() < 1e-6

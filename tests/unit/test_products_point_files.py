"""PLY and LAZ: read back by others, exact, flagged, same bytes every time."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta, timezone
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyproj import CRS

from survey.cloud.points import PointClass
from survey.products.las_file import read_laz, write_laz
from survey.products.ply_file import read_ply, write_ply
from survey.products.writing import ProductError, ReadBackError


def write(path: Path, survey: Any) -> Path:
    """Write the bottom cloud under the path's suffix."""
    if path.suffix == ".ply":
        write_ply(path, survey.bottom, survey.map_frame)
    else:
        frames, start = survey.frames, survey.start_utc
        write_laz(path, survey.bottom, survey.map_frame, start_utc=start, frames=frames)
    return path


def test_ply_is_exact_for_another_reader(small_survey: Any, tmp_path: Path) -> None:
    import open3d

    path = write(tmp_path / "bottom.ply", small_survey)
    points = open3d.t.io.read_point_cloud(str(path)).point
    on_map = small_survey.map_frame.to_map(small_survey.bottom.position)
    assert np.array_equal(points.positions.numpy(), on_map)
    assert np.array_equal(points.true_elevation.numpy()[:, 0], small_survey.bottom.true_elevation)
    assert np.array_equal(points.classification.numpy()[:, 0], small_survey.bottom.classification)


def test_ply_round_trip(small_survey: Any, tmp_path: Path) -> None:
    cloud, map_frame = read_ply(write(tmp_path / "bottom.ply", small_survey))
    assert map_frame == small_survey.map_frame
    for name, column in small_survey.bottom.columns().items():
        again = cloud.columns()[name]
        assert again.dtype == column.dtype, name
        places = ("position", "uncorrected", "truth", "true_surface")
        tolerance = 2e-9 if name in places else 0.0
        np.testing.assert_allclose(again, column, rtol=0.0, atol=tolerance, err_msg=name)


def test_ply_cut_short_is_refused(small_survey: Any, tmp_path: Path) -> None:
    path = write(tmp_path / "bottom.ply", small_survey)
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(ProductError, match=r"bottom\.ply: points: 4096 announced, 4096\.0 there"):
        read_ply(path)


def test_laz_says_what_it_is(small_survey: Any, tmp_path: Path) -> None:
    import laspy

    las = laspy.read(str(write(tmp_path / "bottom.laz", small_survey)))
    header, bottom = las.header, small_survey.bottom
    assert (str(header.version), header.point_format.id) == ("1.4", 6)
    assert len(las.points) == header.point_count == len(bottom)
    assert np.all(las.synthetic == 1)
    assert not np.any(las.withheld)
    assert np.array_equal(las.classification, bottom.classification)
    assert header.global_encoding.wkt
    assert header.global_encoding.gps_time_type == 1
    assert header.creation_date == small_survey.start_utc.date()
    np.testing.assert_allclose(
        las.xyz, small_survey.map_frame.to_map(bottom.position), rtol=0.0, atol=5.1e-4
    )


def test_laz_crs_is_compound_in_wkt_1(small_survey: Any, tmp_path: Path) -> None:
    import laspy

    header = laspy.read(str(write(tmp_path / "bottom.laz", small_survey))).header
    text = header.vlrs.get("WktCoordinateSystemVlr")[0].string
    assert text.startswith("COMPD_CS[")
    assert [part.to_epsg() for part in CRS.from_wkt(text).sub_crs_list] == [25832, 5714]


def test_laz_gps_time_is_adjusted_standard(small_survey: Any, tmp_path: Path) -> None:
    import laspy

    las = laspy.read(str(write(tmp_path / "bottom.laz", small_survey)))
    start = 1_466_071_218.0 - 1e9
    """2026-06-21T10:00:00Z: 2424 weeks of GPS time (Sunday 00:00) and 10 h, 18 leap seconds."""
    assert start == 2424 * 7 * 86400 + 10 * 3600 + 18 - 1e9
    np.testing.assert_allclose(las.gps_time, start + small_survey.bottom.time, rtol=0.0, atol=1e-6)


def test_laz_returns_intensity_and_scan_angle(small_survey: Any, tmp_path: Path) -> None:
    import laspy

    las = laspy.read(str(write(tmp_path / "bottom.laz", small_survey)))
    bottom = small_survey.bottom
    in_water = bottom.classification == PointClass.BATHYMETRIC
    assert np.all(las.return_number[in_water] == 2)
    assert np.all(las.number_of_returns[in_water] == 2)
    assert np.all(las.number_of_returns[~in_water] == 1)
    assert las.intensity.max() == 65535
    steps = np.rint(bottom.reflectance * 10_000)
    assert np.array_equal(las.intensity, np.minimum(steps, 65535))
    angle = las.scan_angle * 0.006
    assert np.all((angle > 0.0) == (bottom.row >= 4))
    assert 5.0 < np.abs(angle).max() < np.degrees(np.arctan(0.128)) + 0.1
    assert np.array_equal(las.point_source_id, bottom.line + 1)


def test_laz_round_trip(small_survey: Any, tmp_path: Path) -> None:
    path = write(tmp_path / "bottom.laz", small_survey)
    cloud = read_laz(path, small_survey.map_frame, start_utc=small_survey.start_utc)
    places = ("uncorrected", "truth", "true_elevation", "true_surface")
    tolerances = dict.fromkeys(places, 5e-4) | {"position": 5.1e-4, "time": 1e-6, "depth": 1e-6}
    for name, column in small_survey.bottom.columns().items():
        again = cloud.columns()[name]
        assert again.dtype == column.dtype, name
        np.testing.assert_allclose(
            again, column, rtol=0.0, atol=tolerances.get(name, 0.0), err_msg=name
        )


def test_a_cloud_of_another_crs_is_refused(small_survey: Any, tmp_path: Path) -> None:
    path = write(tmp_path / "bottom.laz", small_survey)
    elsewhere = replace(small_survey.map_frame, epsg=25833)
    with pytest.raises(ProductError, match=r"CRS: ETRS89 .* zone 32N .* instead of ETRS89 .* 33N"):
        read_laz(path, elsewhere, start_utc=small_survey.start_utc)


def test_extra_bytes_are_described(small_survey: Any, tmp_path: Path) -> None:
    import laspy

    las = laspy.read(str(write(tmp_path / "bottom.laz", small_survey)))
    extra = {dimension.name: dimension for dimension in las.point_format.extra_dimensions}
    wanted = ["frame", "pixel_row", "pixel_column", "depth_m", "snr", "counts"]
    wanted += [f"{kind}_{axis}" for kind in ("uncorrected", "true") for axis in "xyz"]
    wanted += ["true_elevation", *(f"true_surface_{axis}" for axis in "xyz")]
    wanted += [*(f"true_normal_{axis}" for axis in "xyz"), "true_water_path"]
    wanted += ["total_thu", "total_tvu", "surface_z", "reflectance", "true_reflectance"]
    assert list(extra) == [*wanted, "true_class", "substrate", "cause"]
    assert all(4 < len(dimension.description) <= 32 for dimension in extra.values())


def test_extra_places_are_steps_of_which_readers_make_metres(
    small_survey: Any, tmp_path: Path
) -> None:
    import laspy

    las = laspy.read(str(write(tmp_path / "bottom.laz", small_survey)))
    bottom, to_map = small_survey.bottom, small_survey.map_frame.to_map
    scaled = {each.name for each in las.point_format.extra_dimensions if each.is_scaled}
    wanted = {"uncorrected": bottom.uncorrected, "true_surface": bottom.true_surface}
    assert scaled == {f"{name}_{axis}" for name in wanted for axis in "xy"}
    for name, places in (wanted | {"true": bottom.truth}).items():
        steps = np.rint(to_map(places) * 1024)
        for axis, column in zip("xyz", steps.T, strict=True):
            assert np.array_equal(np.asarray(las[f"{name}_{axis}"]) * 1024, column)
    assert las.true_elevation.dtype == np.float32
    assert np.array_equal(las.true_elevation, np.rint(bottom.true_elevation * 1024) / 1024)


def test_no_range_is_told_that_is_not_the_columns(small_survey: Any, tmp_path: Path) -> None:
    """Laspy would write that of the first point."""
    import laspy

    header = laspy.read(str(write(tmp_path / "bottom.laz", small_survey))).header
    about = header.vlrs.get("ExtraBytesVlr")[0].extra_bytes_structs
    assert all(each.min is None and each.max is None for each in about)


@pytest.mark.parametrize("suffix", [".ply", ".laz", ".las"])
def test_same_bytes_twice(small_survey: Any, tmp_path: Path, suffix: str) -> None:
    first = write(tmp_path / f"a{suffix}", small_survey).read_bytes()
    second = write(tmp_path / f"b{suffix}", small_survey).read_bytes()
    assert first == second


def test_laz_bytes_do_not_depend_on_the_time_zone(small_survey: Any, tmp_path: Path) -> None:
    first = write(tmp_path / "a.laz", small_survey).read_bytes()
    elsewhere = small_survey.start_utc.astimezone(timezone(timedelta(hours=-11)))
    moved = replace(small_survey, start_utc=elsewhere)
    assert write(tmp_path / "b.laz", moved).read_bytes() == first


@pytest.mark.parametrize("suffix", [".ply", ".laz"])
def test_nothing_to_write_is_an_error(small_survey: Any, tmp_path: Path, suffix: str) -> None:
    empty = replace(small_survey, bottom=small_survey.bottom.select(np.zeros(0, dtype=np.intp)))
    with pytest.raises(ProductError, match="the cloud is empty"):
        write(tmp_path / f"bottom{suffix}", empty)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".ply", ".laz"])
def test_a_position_that_is_not_finite_is_refused(
    small_survey: Any, tmp_path: Path, suffix: str
) -> None:
    position = small_survey.bottom.position.copy()
    position[7, 2] = np.nan
    bad = replace(small_survey, bottom=replace(small_survey.bottom, position=position))
    with pytest.raises(ProductError, match=r"point 7: position .* is not finite"):
        write(tmp_path / f"bottom{suffix}", bad)


@pytest.mark.parametrize("name", ["uncorrected", "true_surface"])
def test_a_place_that_has_no_steps_is_refused(small_survey: Any, tmp_path: Path, name: str) -> None:
    places = getattr(small_survey.bottom, name).copy()
    places[7, 1] = np.nan
    bad = replace(small_survey, bottom=replace(small_survey.bottom, **{name: places}))
    with pytest.raises(ProductError, match=rf"point 7: {name.replace('_', ' ')} .* is not finite"):
        write(tmp_path / "bottom.laz", bad)


def test_unknown_truth_is_kept(small_survey: Any, tmp_path: Path) -> None:
    truth = np.full_like(small_survey.bottom.truth, np.nan)
    unknown = replace(small_survey, bottom=replace(small_survey.bottom, truth=truth))
    path = write(tmp_path / "bottom.laz", unknown)
    cloud = read_laz(path, small_survey.map_frame, start_utc=small_survey.start_utc)
    assert np.isnan(cloud.truth).all()
    assert np.isnan(read_ply(write(tmp_path / "bottom.ply", unknown))[0].truth).all()


def test_a_lying_disk_is_noticed(
    small_survey: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import laspy

    short = laspy.read(str(write(tmp_path / "short.las", small_survey)))
    short.points = short.points[:-1]
    close = laspy.LasWriter.close

    def lose_a_point(writer: laspy.LasWriter) -> None:
        monkeypatch.undo()
        close(writer)
        short.write(str(tmp_path / ".bottom.partial.laz"))

    monkeypatch.setattr(laspy.LasWriter, "close", lose_a_point)
    with pytest.raises(ReadBackError, match="not read back as written"):
        write(tmp_path / "bottom.laz", small_survey)
    assert [path.name for path in tmp_path.iterdir()] == ["short.las"]

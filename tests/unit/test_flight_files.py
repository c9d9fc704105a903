"""Trajectories and areas from files, and back: what is sound is read, what is not is told."""

from __future__ import annotations

import json
import struct
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyproj import Geod, Transformer

from survey.flight.files.cblue_file import cblue_text, read_cblue
from survey.flight.files.csv_file import read_csv_track
from survey.flight.files.faults import FlightFileError
from survey.flight.files.geojson_file import read_area
from survey.flight.files.sbet_file import RECORD, read_sbet, sbet_bytes
from survey.flight.geodesy import from_map, grid_north, to_map
from survey.flight.track import Track
from survey.products.gps_time import adjusted_gps_time
from survey.products.track_files import write_trajectory_files
from survey.products.trajectory_file import write_trajectory_csv

DATA = Path(__file__).parent / "data"
UTM_32, UTM_11 = 25832, 32611
COLUMNS = "time_s,easting_m,northing_m,up_m,roll_deg,pitch_deg,heading_deg"


def some_track(count: int = 6) -> Track:
    """A climbing curve some 200 km east of the middle meridian, where north is not north."""
    time = 100.0 + 0.5 * np.arange(count)
    along = 50.0 * np.arange(count)
    return Track(
        time=time,
        position=np.column_stack([7.0e5 + along, 6.0e6 - 0.2 * along, 210.0 + 0.01 * along]),
        roll=0.02 * np.sin(time),
        pitch=np.full(count, -0.01),
        heading=np.linspace(6.2, 6.4, count) % (2.0 * np.pi),
    )


def assert_same(found: Track, wanted: Track, *, place: float, angle: float) -> None:
    assert found.time == pytest.approx(wanted.time, abs=1e-6)
    assert np.abs(found.position - wanted.position).max() < place
    for name in ("roll", "pitch", "heading"):
        apart = getattr(found, name) - getattr(wanted, name)
        assert np.abs((apart + np.pi) % (2.0 * np.pi) - np.pi).max() < angle


def faults_of(read: Any, path: Path, **how: Any) -> tuple[str, ...]:
    with pytest.raises(FlightFileError) as caught:
        read(path, epsg=UTM_32, **how)
    assert str(caught.value).startswith(str(path))
    return caught.value.faults


def csv_file(folder: Path, *rows: str, header: str = COLUMNS) -> Path:
    path = folder / "track.csv"
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path


def test_headings_of_a_real_sbet_agree_with_its_way_over_the_ground() -> None:
    track = read_sbet(DATA / "leeward_40_records.sbet", epsg=UTM_11)
    records = np.frombuffer((DATA / "leeward_40_records.sbet").read_bytes(), RECORD)
    assert len(track.time) == 40
    lon, lat = np.degrees(records["longitude"]), np.degrees(records["latitude"])
    course, _, way = Geod(ellps="WGS84").inv(lon[0], lat[0], lon[-1], lat[-1])
    speed = np.hypot(records["velocity_x"], records["velocity_y"])[0]
    assert way / (track.time[-1] - track.time[0]) == pytest.approx(speed, rel=2e-3)
    tilted = np.degrees(np.arctan2(-records["velocity_y"][0], records["velocity_x"][0]))
    assert tilted - np.degrees(records["wander"][0]) == pytest.approx(course, abs=0.05)
    step = track.position[-1] - track.position[0]
    grid_course = np.degrees(np.arctan2(step[0], step[1]))
    crab = np.degrees(track.heading[0]) - grid_course
    true_crab = np.degrees(records["heading"][0] - records["wander"][0]) - course
    assert crab == pytest.approx(true_crab, abs=0.01)
    assert 5.0 < crab < 6.0


def test_a_real_csv_is_read_with_its_own_columns() -> None:
    track = read_csv_track(DATA / "thor75_200_rows.csv", epsg=26915)
    assert len(track.time) == 200
    assert np.degrees(track.roll[0]) == pytest.approx(-5.5802)
    assert track.position[0, 2] == 248.751
    way = track.position[-1] - track.position[0]
    assert 10.0 < np.hypot(*way[:2]) / 3.98 < 40.0
    noses = np.array([np.sin(track.heading), np.cos(track.heading)]).mean(axis=1)
    assert way[:2] @ noses / np.linalg.norm(way[:2]) / np.linalg.norm(noses) > 0.95


def test_grid_north_is_the_convergence_that_the_projection_tells() -> None:
    from pyproj import Proj

    lon, lat = np.radians([6.5, 9.0, 12.5]), np.radians([54.0, 10.0, -30.0])
    angle = grid_north(longitude=lon, latitude=lat, epsg=UTM_32)
    told = Proj(UTM_32).get_factors(np.degrees(lon), np.degrees(lat)).meridian_convergence
    assert np.degrees(np.abs(angle)) == pytest.approx(np.abs(told), abs=1e-4)
    assert (angle < 0.0).tolist() == [True, False, True]
    there = to_map(longitude=lon, latitude=lat, epsg=UTM_32)
    assert np.array(from_map(there, epsg=UTM_32)) == pytest.approx(np.array([lon, lat]), abs=1e-12)


def test_sbet_there_and_back(tmp_path: Path) -> None:
    path = tmp_path / "track.sbet"
    path.write_bytes(sbet_bytes(some_track(), epsg=UTM_32))
    assert path.stat().st_size == 6 * 136
    assert_same(read_sbet(path, epsg=UTM_32), some_track(), place=1e-6, angle=1e-9)
    first = struct.unpack("<17d", path.read_bytes()[:136])
    assert first[0] == 100.0
    assert np.hypot(first[4], first[5]) == pytest.approx(np.hypot(100.0, 20.0), rel=1e-6)
    true_course = np.arctan2(-first[5], first[4]) % (2.0 * np.pi)
    lon, lat = from_map(some_track().position[:2, :2], epsg=UTM_32)
    wanted, _, _ = Geod(ellps="WGS84").inv(*np.degrees([lon[0], lat[0], lon[1], lat[1]]))
    assert np.degrees(true_course) == pytest.approx(wanted, abs=0.01)


def test_cblue_there_and_back(tmp_path: Path) -> None:
    deviations = (0.02, 0.03, 0.05, 1e-4, 2e-4, 3e-4)
    path = tmp_path / "20260621_trajectory.txt"
    path.write_text(cblue_text(some_track(), epsg=UTM_32, deviations=deviations))
    assert_same(read_cblue(path, epsg=UTM_32), some_track(), place=2e-4, angle=2e-8)
    table = np.loadtxt(path)
    assert table.shape == (6, 15)
    assert table[:, 3:6] == pytest.approx(some_track().position, abs=1e-4)
    assert table[0, 9:] == pytest.approx([*deviations[:3], *np.degrees(deviations[3:])], abs=5e-6)


def test_csv_on_the_map_and_csv_of_a_run_s_poses(small_survey: Any, tmp_path: Path) -> None:
    path = tmp_path / "trajectory.csv"
    frames = sorted(small_survey.frames[:8], key=lambda frame: frame.time)
    write_trajectory_csv(path, frames, [frame.pose for frame in frames], small_survey.map_frame)
    for prefix in ("true_", "measured_"):
        track = read_csv_track(path, epsg=UTM_32, prefix=prefix)
        places = small_survey.map_frame.to_map(np.array([f.pose.position for f in frames]))
        assert track.position == pytest.approx(places, abs=1e-4)
        assert np.degrees(track.heading) == pytest.approx(70.0, abs=1e-6)
    assert "line 1: no column easting_m" in faults_of(read_csv_track, path)[0]


def test_quaternions_turn_as_the_angles_do(tmp_path: Path) -> None:
    from scipy.spatial.transform import Rotation

    angles = np.array([[10.0, -5.0, 200.0], [-20.0, 8.0, 350.0]])
    w = Rotation.from_euler("ZYX", angles[:, ::-1], degrees=True).as_quat(scalar_first=True)
    header = "time_s,easting_m,northing_m,up_m,qw,qx,qy,qz"
    rows = [f"{i},5e5,6e6,200,{','.join(map(repr, q.tolist()))}" for i, q in enumerate(w)]
    track = read_csv_track(csv_file(tmp_path, *rows, header=header), epsg=UTM_32)
    found = np.degrees([track.roll, track.pitch, track.heading]).T
    assert found == pytest.approx(angles)
    long = rows[1].rsplit(",", 1)[0] + ",3.0"
    (fault,) = faults_of(read_csv_track, csv_file(tmp_path, rows[0], long, header=header))
    assert fault.startswith("line 3: the quaternion is 3.")


def test_poses_between_records_take_the_short_way_round() -> None:
    track = some_track()
    half = track.poses(np.array([100.25]))[0]
    assert half.position == pytest.approx((track.position[0] + track.position[1]) / 2)
    crossing = Track(
        time=np.array([0.0, 1.0]),
        position=np.zeros((2, 3)),
        roll=np.radians([179.0, -179.0]),
        pitch=np.zeros(2),
        heading=np.radians([359.0, 3.0]),
    ).poses(np.array([0.5]))[0]
    assert np.degrees(crossing.heading) == pytest.approx(1.0)
    assert abs(np.degrees(crossing.roll)) == pytest.approx(180.0)


@pytest.mark.parametrize(
    ("rows", "header", "words"),
    [
        (["1,0,0,9,0,0,0", "1,0,0,9,0,0,0"], COLUMNS, ["line 3: time_s 1 is not after 1"]),
        (
            ["2,0,0,9,0,0,0", "1,0,nan,9,0,99,0"],
            COLUMNS,
            [
                "line 3: northing_m is not a finite number",
                "line 3: pitch_deg 99 is beyond 90",
                "line 3: time_s 1 is not after 2",
            ],
        ),
        (
            ["1,0,0,9,0,0", "2,0,0,x,0,0,0", "3,0,0,9,0,0,0,7"],
            COLUMNS,
            [
                "line 2: 6 columns, but there should be 7",
                "line 4: 8 columns",
                "line 3: up_m 'x' is not a number",
            ],
        ),
        (
            ["1,2,3"],
            "time_s,lon_deg,lat_deg",
            ["no column alt_m", "no column roll_deg", "no column heading_deg"],
        ),
        (["1,0,0,9,0,0,0"], COLUMNS, ["1 records. A track needs 2"]),
        ([], COLUMNS, ["0 records"]),
        (["1,0,0,9,0,0,0"] * 9, COLUMNS, ["and 3 more of the kind"]),
    ],
)
def test_every_fault_of_a_csv_is_told_at_once(
    rows: list[str], header: str, words: list[str], tmp_path: Path
) -> None:
    found = faults_of(read_csv_track, csv_file(tmp_path, *rows, header=header))
    for word in words:
        assert any(word in fault for fault in found), (word, found)


@pytest.mark.parametrize("content", [b"", b"\xff\xfe\x00rubbish", b"\n\n\n", b"time_s"])
def test_rubbish_is_told(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "track.csv"
    path.write_bytes(content)
    for read in (read_csv_track, read_cblue, read_sbet, read_area):
        assert faults_of(read, path)


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    assert faults_of(read_sbet, tmp_path / "none.sbet") == (
        "cannot be read: No such file or directory",
    )


def test_a_cut_sbet_says_how_much_is_too_much(tmp_path: Path) -> None:
    path = tmp_path / "cut.sbet"
    path.write_bytes(sbet_bytes(some_track(), epsg=UTM_32)[:-100])
    (fault,) = faults_of(read_sbet, path)
    assert "716 bytes are no whole number of records of 136" in fault
    assert "Leave off the last 36 bytes" in fault


def test_faults_of_an_sbet_name_the_record(tmp_path: Path) -> None:
    records = np.frombuffer(sbet_bytes(some_track(), epsg=UTM_32), RECORD).copy()
    records["latitude"][2] = np.nan
    records["latitude"][3] = 45.0
    records["time"][4] = 0.0
    path = tmp_path / "bad.sbet"
    path.write_bytes(records.tobytes())
    assert faults_of(read_sbet, path) == (
        "record 2: latitude is not a finite number",
        "record 3: latitude 45 is beyond 1.5708",
        "record 4: time 0 is not after 101.5 before it. Sort the records and leave out doubles",
    )


def test_faults_of_a_cblue_text_name_the_line(tmp_path: Path) -> None:
    text = cblue_text(some_track(), epsg=UTM_32, deviations=(0.0,) * 6).splitlines()
    path = tmp_path / "20260621_bad.txt"
    path.write_text("\n".join([text[0], "", text[2].rsplit(" ", 1)[0], text[3]]))
    assert faults_of(read_cblue, path) == ("line 3: 14 columns, but there should be 15",)
    path.write_text("\n".join([text[0], "", text[3], text[2]]))
    assert faults_of(read_cblue, path)[0].startswith("line 4: time 101 is not after 101.5")


def geojson(folder: Path, value: Any) -> Path:
    path = folder / "area.geojson"
    path.write_text(json.dumps(value), encoding="utf-8")
    return path


SQUARE = np.array([[5e5, 6e6], [5.01e5, 6e6], [5.01e5, 6.0005e6], [5e5, 6.0005e6]])


def in_degrees(corners: np.ndarray) -> list[list[float]]:
    to_degrees = Transformer.from_crs(UTM_32, 4326, always_xy=True)
    ring = np.column_stack(to_degrees.transform(corners[:, 0], corners[:, 1])).tolist()
    return [*ring, ring[0]]


def polygon(ring: Any, *holes: Any) -> dict[str, Any]:
    return {"type": "Polygon", "coordinates": [ring, *holes]}


def test_areas_are_read_in_every_wrapping(tmp_path: Path) -> None:
    bare = polygon(in_degrees(SQUARE))
    feature = {"type": "Feature", "properties": {}, "geometry": bare}
    several = {"type": "MultiPolygon", "coordinates": [bare["coordinates"]]}
    for value in (
        bare,
        feature,
        several,
        {"type": "FeatureCollection", "features": [feature]},
        {"type": "GeometryCollection", "geometries": [bare]},
    ):
        found = read_area(geojson(tmp_path, value), epsg=UTM_32)
        assert found == pytest.approx(SQUARE, abs=1e-6)


@pytest.mark.parametrize("name", ["EPSG:25832", "urn:ogc:def:crs:EPSG::25832"])
def test_areas_of_the_older_edition_name_their_map(name: str, tmp_path: Path) -> None:
    crs = {"type": "name", "properties": {"name": name}}
    value = {**polygon([*SQUARE.tolist(), SQUARE[0].tolist()]), "crs": crs}
    assert read_area(geojson(tmp_path, value), epsg=UTM_32) == pytest.approx(SQUARE)
    crs["properties"] = {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}  # type: ignore[assignment]
    value = {**polygon(in_degrees(SQUARE)), "crs": crs}
    assert read_area(geojson(tmp_path, value), epsg=UTM_32) == pytest.approx(SQUARE, abs=1e-6)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({"type": "Point", "coordinates": [9, 54]}, "0 polygons. Keep one"),
        ({"type": "FeatureCollection", "features": []}, "0 polygons"),
        ([1, 2], "0 polygons"),
        ({"geometries": [polygon([[9, 54]]), polygon([[9, 54]])]}, "2 polygons. Keep one"),
        (polygon([[9, 54]], [[9, 54]]), "1 holes. Keep its outline"),
        (polygon([[9, 54], ["x", 54], [9, 55]]), "not a pair of numbers"),
        (polygon(None), "not a pair of numbers"),
        (polygon([[5e5, 6e6], [5e5, 6.1e6], [6e5, 6e6]]), "no longitudes and latitudes"),
        ({**polygon([[9, 54]]), "crs": {"name": "mine"}}, "names no EPSG code"),
        (
            {**polygon([[9, 54]]), "crs": {"name": "EPSG:999999"}},
            "crs: there is no map EPSG:999999",
        ),
    ],
)
def test_what_is_no_area_is_told(value: Any, words: str, tmp_path: Path) -> None:
    (fault,) = faults_of(read_area, geojson(tmp_path, value))
    assert words in fault


def test_a_run_writes_its_measured_trajectory_for_others(small_survey: Any, tmp_path: Path) -> None:
    frames, start = small_survey.frames[:8], datetime(2026, 6, 21, 10, tzinfo=UTC)
    write_trajectory_files(
        tmp_path,
        frames,
        small_survey.map_frame,
        formats=("sbet", "cblue"),
        start_utc=start,
        deviations=(0.02, 0.02, 0.04, 1e-4, 1e-4, 2e-4),
    )
    places = small_survey.map_frame.to_map(np.array([f.pose.position for f in frames]))
    sbet = read_sbet(tmp_path / "trajectory.sbet", epsg=UTM_32)
    cblue = read_cblue(tmp_path / "20260621_trajectory.txt", epsg=UTM_32)
    for track in (sbet, cblue):
        assert track.position == pytest.approx(places, abs=1e-3)
        assert np.degrees(track.heading) == pytest.approx(70.0, abs=1e-5)
    assert sbet.time[0] == 10 * 3600.0 + 18.0  # a Sunday, 18 leap seconds
    assert cblue.time[0] == pytest.approx(adjusted_gps_time(start, np.zeros(1))[0], abs=1e-5)

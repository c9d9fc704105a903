"""Scoring clouds of others: our own come out as in metrics.json, bad ones as lines."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import laspy
import numpy as np
import pytest
from numpy.typing import NDArray
from pyproj import CRS
from typer.testing import CliRunner

from survey.cli import app
from survey.cloud.georeference import pixel_rays
from survey.cloud.points import Outcome, PixelRecord, PointClass, PointCloud
from survey.cloud.truth import true_targets
from survey.flight.pose import Frame
from survey.preparation import product_settings
from survey.products.frame_file import FrameResult, frame_bytes
from survey.products.las_file import write_laz
from survey.products.ply_file import read_ply
from survey.products.run_products import write_products
from survey.run_folder import RunFolder
from survey.scenario import components
from survey.scenario.scenario import Scenario
from survey.score.score import score_cloud
from survey.score.truth import AIR, GROUND, OBJECT, SEABED, SURFACE, UNKNOWN, WITHIN, truth_at
from terrain.foreign import cloud_reader
from terrain.foreign.faults import ReaderError
from terrain.generators import Ground, plane
from terrain.map_frame import MapFrame
from terrain.objects import cube, place
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]
FIGURES = ("bias_m", "rmse_m", "p95_abs_error_m", "false_bottoms")
TABLES: dict[str, Any] = {
    "mission": {"title": "a benchmark", "seed": 7},
    "flight": {
        **{"start_easting_m": 500250.0, "start_northing_m": 6000750.0, "heading_deg": 90.0},
        **{"frames_per_line": 2, "speed_m_s": 20.0},
    },
    "camera": {"rows": 8, "columns": 16},
    "receiver": {"aperture_radius_m": 0.005, "filter_width_nm": 1.0},
    "detector": {"quantum_efficiency": 0.2, "dark_count_rate_hz": 1.0e4},
    "water": {"type": "coastal"},
    "surface": {"water_level_m": 0.5},
    "seabed": {"kind": "slope", "depth_m": 3.0, "slope_deg": 3.0, "downhill_deg": 90.0},
    "transport": {"walks_per_pixel": 16},
}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory, small_survey: Any) -> Path:
    """A run of two frames of 16 x 8 pixels over a slope from 3 m, its echoes made by hand."""
    folder = tmp_path_factory.mktemp("score")
    scenario = Scenario.from_tables(TABLES, name="reef.toml", folder=folder)
    seabed, flashes = components.seabed(scenario), components.frames(scenario)
    kept = RunFolder.open(folder / "run", scenario)
    for frame in flashes:
        flash = seen(small_survey.bottom, scenario, seabed, frame)
        kept.keep(frame.index, frame_bytes(flash))
    write_products(
        kept.path,
        read=kept.frame,
        frames=flashes,
        seabed=seabed,
        settings=product_settings(scenario),
    )
    return kept.path


def seen(some: PointCloud, scenario: Scenario, seabed: Seabed, frame: Frame) -> FrameResult:
    """Return a frame that finds every bottom with errors of 5 cm, but one 2 m too high.

    What is not said here the points have from ``some``.
    """
    camera, random = components.camera(scenario), np.random.default_rng(frame.index)
    targets = true_targets(
        seabed=seabed,
        surface=components.sea_surface(scenario),
        water=components.water(scenario),
        pose=frame.pose,
        rays=pixel_rays(camera=camera, pose=frame.pose),
    )
    shape = targets.depth.shape
    row, column = (index.ravel() for index in np.indices(shape))
    truth = targets.position.reshape(-1, 3)
    position = truth + random.normal([0.0, 0.0, -0.03], 0.05, truth.shape)
    position[0, 2] += 2.0
    n = len(truth)
    cloud = replace(
        some.select(np.zeros(n, dtype=np.intp)),
        position=position,
        uncorrected=position,
        truth=truth,
        classification=np.full(n, PointClass.BATHYMETRIC, dtype=np.uint8),
        true_elevation=seabed.elevation_at(position[:, 0], position[:, 1]),
        frame=np.full(n, frame.index, dtype=np.uint32),
        row=row.astype(np.uint16),
        column=column.astype(np.uint16),
    )
    record = PixelRecord(
        true_position=targets.position,
        true_depth=targets.depth,
        detection_probability=np.where(column.reshape(shape) < 15, 0.99, 0.5),
        outcome=np.full(shape, Outcome.FOUND, dtype=np.uint8),
        bottom_counts=np.full(shape, 100.0),
        monte_carlo_relative_error=np.full(shape, 0.05),
    )
    return FrameResult(bottom=cloud, surface=cloud.select(slice(0, 0)), record=record)


def metrics(run: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((run / "metrics.json").read_text())
    return found


def columns(run: Path) -> FloatArray:
    """Return easting, northing, elevation and class of the run's own points."""
    cloud, frame = read_ply(run / "bottom.ply")
    return np.column_stack([frame.to_map(cloud.position), cloud.classification])


def csv(path: Path, table: FloatArray, header: str = "x,y,z,classification") -> Path:
    np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.17g")
    return path


def typed(*words: str | Path) -> Any:
    return CliRunner().invoke(app, ["score", *(str(word) for word in words)])


def test_our_own_cloud_has_the_errors_that_metrics_tell(run: Path, tmp_path: Path) -> None:
    """The PLY and a CSV to the last digit; the LAZ to its millimetre steps."""
    wanted = {name: metrics(run)[name] for name in FIGURES}
    for path in (run / "bottom.ply", csv(tmp_path / "own.csv", columns(run))):
        found = score_cloud(path, run)
        assert {name: found["all_depths"][name] for name in FIGURES} == wanted
        assert found["all_depths"]["points"] == metrics(run)["points_bottom"]
    laz = score_cloud(run / "bottom.laz", run)["all_depths"]
    assert {name: laz[name] for name in FIGURES} == pytest.approx(wanted, abs=5e-4)
    assert laz["false_bottoms"] == wanted["false_bottoms"]


def test_known_errors_come_out_by_depth(run: Path, tmp_path: Path) -> None:
    """The true places, 0.2 m too high, but one of them 3 m."""
    cloud, frame = read_ply(run / "bottom.ply")
    true = frame.to_map(cloud.truth)[np.isin(cloud.classification, (40, 43))]
    lifted = true + np.array([0.0, 0.0, 0.2])
    lifted[0, 2] += 2.8
    found = score_cloud(csv(tmp_path / "up.csv", lifted, "E,N,Z"), run)
    count = len(lifted)
    assert found["all_depths"]["bias_m"] == pytest.approx(0.2 + 2.8 / count, abs=1e-5)
    assert found["all_depths"]["p95_abs_error_m"] == pytest.approx(0.2, abs=1e-6)
    assert found["all_depths"]["false_bottoms"] == 1
    assert sum(row["points"] for row in found["by_depth"]) == count
    assert sum(row["missed_bottoms"] for row in found["by_depth"]) <= 1
    assert "no classes" in found["notes"][0] + found["notes"][1]


def test_half_a_cloud_misses_half_of_the_bottoms(run: Path, tmp_path: Path) -> None:
    table = columns(run)
    whole = score_cloud(csv(tmp_path / "whole.csv", table), run)["all_depths"]
    half = table[table[:, 1] > np.median(table[:, 1])]
    found = score_cloud(csv(tmp_path / "half.csv", half), run)["all_depths"]
    assert whole["detectable"] == found["detectable"] > 100
    assert whole["missed_bottoms"] < 0.05 * whole["detectable"]
    share = found["missed_bottoms"] / found["detectable"]
    assert share == pytest.approx(0.5, abs=0.13)


def test_classes_are_told_by_what_is_there() -> None:
    """A bed at 8 m with a cube, and land beside it, by hand."""
    frame = MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714)
    bed = plane(ground=Ground(map_frame=frame, length=40, width=40, reflectance=0.1), depth=8.0)
    body = place(cube(side=2.0), seabed=bed, east=5.0, north=5.0)
    bed = bed.with_object(body, reflectance=0.1, source="a cube")
    points = np.array(
        [
            *([0.0, 0.0, -8.3], [5.0, 5.0, -6.2], [0.0, 0.0, 0.3], [0.0, 0.0, -4.0]),
            *([0.0, 0.0, 5.0], [100.0, 0.0, -8.0]),
        ]
    )
    found = truth_at(points, bed, water_level=0.0)
    assert found.true_class.tolist() == [SEABED, OBJECT, SURFACE, WITHIN, AIR, UNKNOWN]
    assert found.error[:2] == pytest.approx([-0.3, -0.2])
    assert found.depth[:2].tolist() == [8.0, 6.0]
    low = truth_at(points[:1], bed, water_level=-9.0)
    assert (low.true_class[0], low.depth[0]) == (GROUND, -1.0)


def test_confusion_counts_every_point_once(run: Path, tmp_path: Path) -> None:
    table = columns(run)
    table[:10, 3], table[:10, 2] = 41, 0.5
    table[10:13, 2], table[10:13, 3] = 0.6, 40
    found = score_cloud(csv(tmp_path / "mixed.csv", table), run)["confusion"]
    assert sum(sum(row.values()) for row in found.values()) == len(table)
    assert found["41 water surface"]["water_surface"] == 10
    assert found["40 bathymetric"]["water_surface"] == 3


def test_the_command_prints_a_table_and_writes_all_of_it(run: Path, tmp_path: Path) -> None:
    done = typed(run / "bottom.laz", "--run", run, "--json", tmp_path / "score.json")
    assert done.exit_code == 0, done.output
    assert "a benchmark: seed 7, 2 frames" in done.stdout
    assert "40 bathymetric" in done.stdout
    written = json.loads((tmp_path / "score.json").read_text())
    assert (
        written["benchmark"]["scenario_sha256"]
        == json.loads((run / "manifest.json").read_text())["scenario_sha256"]
    )
    assert written["all_depths"]["points"] == metrics(run)["points_bottom"]
    assert written["by_depth"][0]["from_depth_m"] >= 2.0


@pytest.mark.parametrize("order", ["<", ">"])
def test_ply_of_either_byte_order_and_ascii(tmp_path: Path, order: str) -> None:
    table = np.array([[500000.123456789, 6000000.5, -3.25, 40.0], [500001.0, 6000002.0, -4.0, 7.0]])
    types = [(axis, f"{order}f8") for axis in "xyz"]
    records = np.zeros(len(table), dtype=[*types, ("scalar_Classification", f"{order}f4")])
    for number, name in enumerate(records.dtype.names or ()):
        records[name] = table[:, number]
    kind = "little" if order == "<" else "big"
    head = ["ply", f"format binary_{kind}_endian 1.0", "comment epsg 25832"]
    head += [f"element vertex {len(table)}", *(f"property double {axis}" for axis in "xyz")]
    head += ["property float scalar_Classification", "element face 0", "end_header", ""]
    binary, text = tmp_path / "other.ply", tmp_path / "text.ply"
    binary.write_bytes("\n".join(head).encode() + records.tobytes())
    rows = "\n".join(" ".join(f"{value:.17g}" for value in row) for row in table)
    text.write_text("\n".join(head).replace(f"binary_{kind}_endian", "ascii") + rows + "\n")
    for path in (binary, text):
        found = cloud_reader.read_ply(str(path))
        np.testing.assert_array_equal(found["points"], table[:, :3])
        assert found["classification"].tolist() == [40, 7]
        assert found["crs"] == "EPSG:25832"


def refusal(path: Path, run: Path, *more: str) -> tuple[int, list[str]]:
    done = typed(path, "--run", run, *more)
    assert "Traceback" not in done.output
    return done.exit_code, done.stderr.splitlines()


def test_a_cloud_of_another_place_or_with_its_axes_swapped(run: Path, tmp_path: Path) -> None:
    table = columns(run)
    status, lines = refusal(csv(tmp_path / "far.csv", table + np.array([5e3, 0, 0, 0])), run)
    assert (status, len(lines)) == (2, 1)
    assert "another place" in lines[0]
    assert "5000 m away" in lines[0]
    _, lines = refusal(csv(tmp_path / "swapped.csv", table[:, [1, 0, 2, 3]]), run)
    assert "easting and northing are swapped" in lines[0]


def test_another_coordinate_system_and_datum_are_both_told(run: Path, tmp_path: Path) -> None:
    cloud, frame = read_ply(run / "bottom.ply")
    scenario = Scenario.from_tables(TABLES, name="reef.toml", folder=tmp_path)
    elsewhere = replace(frame, epsg=25833, vertical_epsg=5941)
    path = tmp_path / "zone33.laz"
    start = scenario.mission.start_utc
    write_laz(path, cloud, elsewhere, start_utc=start, frames=components.frames(scenario))
    status, lines = refusal(path, run)
    assert (status, len(lines)) == (2, 2)
    assert "zone 33N" in lines[0]
    assert "the run is on EPSG:25832" in lines[0]
    assert "vertical datum" in lines[1]


def test_empty_and_unclassified_clouds(run: Path, tmp_path: Path) -> None:
    table = columns(run)
    status, lines = refusal(csv(tmp_path / "none.csv", table[:0]), run)
    assert (status, lines) == (2, [f"{tmp_path / 'none.csv'}: points: the cloud is empty"])
    header = laspy.LasHeader(version="1.4", point_format=6)
    header.add_crs(CRS.from_epsg(25832))
    laspy.LasData(header).write(str(tmp_path / "none.las"))
    assert cloud_reader.read_las(str(tmp_path / "none.las"))["points"].shape == (0, 3)
    table[:, 3] = 9
    raw = csv(tmp_path / "raw.csv", table)
    status, lines = refusal(raw, run)
    assert "no point of class 40 or 43; it has 9" in lines[0]
    assert typed(raw, "--run", run, "--bottom-class", "9").exit_code == 0


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("x,y,depht\n1,2,3\n", "line 1: no column z"),
        ("a,b\n1,2\n", "columns not known: 'a', 'b'"),
        ("500000.0,6000000.0,-3.0\n", "numbers, but no header"),
        ("x,y,z\n1,2,deep\n4,5\n", "line 2: z: 'deep' is no number"),
        ("x,y,z,class\n1,2,3,300\n", "class 300, but LAS classes are 0 to 255"),
        ("", "no column x"),
    ],
)
def test_tables_that_are_none(tmp_path: Path, content: str, words: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(content)
    with pytest.raises(ReaderError) as refused:
        cloud_reader.read_csv(str(path))
    assert any(words in fault for fault in refused.value.faults)


@pytest.mark.parametrize("mark", [";", "\t", " "])
def test_tables_with_other_separators_and_columns(tmp_path: Path, mark: str) -> None:
    path = tmp_path / "cloud.txt"
    rows = (("time", "Easting", "class", "N", "Height"), ("9:30", "1.5", "40", "2.5", "-3.0"))
    path.write_text("\n".join(mark.join(row) for row in rows) + "\n")
    found = cloud_reader.read_csv(str(path))
    assert found["points"].tolist() == [[1.5, 2.5, -3.0]]
    assert found["classification"].tolist() == [40]


def test_files_that_are_none(run: Path, tmp_path: Path) -> None:
    for name, words in (
        ("bad.las", "LAS"),
        ("bad.dxf", "not a cloud"),
        ("nan.csv", "point 0: not finite"),
    ):
        (tmp_path / name).write_text("x,y,z\n1,2,nan\n")
        status, lines = refusal(tmp_path / name, run)
        assert (status, len([line for line in lines if words in line])) == (2, 1)
    for content, words in (
        (b"plainly nothing of the kind", "not that of a PLY file"),
        ((run / "bottom.ply").read_bytes()[:-100], "announced"),
    ):
        (tmp_path / "bad.ply").write_bytes(content)
        with pytest.raises(ReaderError, match=words):
            cloud_reader.read_ply(str(tmp_path / "bad.ply"))


def test_what_is_wrong_with_run_and_cloud_is_told_at_once(run: Path, tmp_path: Path) -> None:
    broken = shutil.copytree(run, tmp_path / "broken")
    (broken / "frames/000000.npz").write_bytes(b"half")
    (broken / "frames/000001.npz").unlink()
    status, lines = refusal(tmp_path / "none.laz", broken)
    assert status == 2
    assert [line.split(": ", 1)[1].split(".")[0] for line in lines] == [
        "no such file",
        "frame 0: its file is not what was written",
        "frame 1: its file is gone",
    ]
    (broken / "journal.jsonl").write_text("")
    assert "no frame was flown" in refusal(run / "bottom.ply", broken)[1][0]
    empty = tmp_path / "empty"
    empty.mkdir()
    assert "not a run folder" in refusal(run / "bottom.ply", empty)[1][0]
    status, lines = refusal(tmp_path / "none.laz", tmp_path / "nowhere")
    assert (status, len(lines)) == (3, 2)


def test_a_run_over_another_seabed_cannot_judge(run: Path, tmp_path: Path) -> None:
    other = shutil.copytree(run, tmp_path / "other")
    text = (other / "scenario.toml").read_text()
    (other / "scenario.toml").write_text(text.replace("depth_m = 3.0", "depth_m = 3.5"))
    assert "seabed has changed" in refusal(run / "bottom.ply", other)[1][0]

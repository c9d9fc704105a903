"""Whole files, JSON, trajectory, GPS time and the report."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.flight.pose import Pose
from survey.optics.water import WaterColumn, petzold_water
from survey.products.accuracy import Accuracy
from survey.products.coverage import CoverageTally, hull_of, looked_at
from survey.products.depth_profile import DepthProfile
from survey.products.gps_time import adjusted_gps_time
from survey.products.grids import error_places, grid_elevation, gridded
from survey.products.json_file import write_json
from survey.products.pixels import tallied
from survey.products.report.report import Findings, write_report
from survey.products.trajectory_file import read_trajectory_csv, write_trajectory_csv
from survey.products.writing import ProductError, whole_file


def write_half_then_fail(path: Path, fault: BaseException) -> None:
    """Write some bytes and raise before the file is whole."""
    with whole_file(path) as partial:
        partial.write_bytes(b"half")
        raise fault


def test_a_failed_write_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "product.txt"
    path.write_bytes(b"old")
    with pytest.raises(OSError, match="disk full"):
        write_half_then_fail(path, OSError("disk full"))
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [
        ("product.txt", b"old")
    ]


def test_an_interrupted_write_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        write_half_then_fail(tmp_path / "product.txt", KeyboardInterrupt())
    assert list(tmp_path.iterdir()) == []


def test_json_refuses_nan_and_keeps_nothing(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(tmp_path / "metrics.json", {"bias_m": float("nan")})
    assert list(tmp_path.iterdir()) == []


def test_json_keeps_the_order(tmp_path: Path) -> None:
    write_json(tmp_path / "metrics.json", {"b": 1, "a": None})
    assert list(json.loads((tmp_path / "metrics.json").read_text())) == ["b", "a"]


@pytest.mark.parametrize(
    ("utc", "leap_seconds"),
    [((2026, 6, 21), 18), ((2017, 1, 1), 18), ((2016, 12, 31), 17), ((1980, 1, 6), 0)],
)
def test_gps_time_counts_leap_seconds(utc: tuple[int, int, int], leap_seconds: int) -> None:
    start = datetime(*utc, tzinfo=UTC)
    days = (start - datetime(1980, 1, 6, tzinfo=UTC)).days
    time = adjusted_gps_time(start, np.array([0.5]))
    assert time[0] + 1e9 == days * 86400 + leap_seconds + 0.5


def test_gps_time_needs_a_time_zone() -> None:
    with pytest.raises(ValueError, match="no time zone"):
        adjusted_gps_time(datetime(2026, 6, 21), np.zeros(1))


def test_trajectory_round_trip(small_survey: Any, tmp_path: Path) -> None:
    frames = small_survey.frames
    measured = [
        Pose(
            position=frame.pose.position + np.array([0.02, -0.03, 0.05]),
            roll=np.radians(1.0),
            pitch=np.radians(-2.0),
            heading=frame.pose.heading,
        )
        for frame in frames
    ]
    path = tmp_path / "trajectory.csv"
    write_trajectory_csv(path, frames, measured, small_survey.map_frame)
    table = read_trajectory_csv(path)
    assert table["frame"].tolist() == list(range(32))
    assert table["line"].tolist() == [frame.line for frame in frames]
    on_map = small_survey.map_frame.to_map(np.array([frame.pose.position for frame in frames]))
    for index, name in enumerate(("easting_m", "northing_m", "up_m")):
        np.testing.assert_allclose(table[f"true_{name}"], on_map[:, index], rtol=0.0, atol=6e-5)
    np.testing.assert_allclose(table["measured_up_m"] - table["true_up_m"], 0.05, atol=2e-4)
    np.testing.assert_allclose(table["measured_roll_deg"], 1.0)
    np.testing.assert_allclose(table["measured_pitch_deg"], -2.0)
    np.testing.assert_allclose(table["true_heading_deg"], 70.0)


def test_trajectory_needs_one_measured_pose_a_frame(small_survey: Any, tmp_path: Path) -> None:
    with pytest.raises(ProductError, match="32 frames and 0 measured poses"):
        write_trajectory_csv(
            tmp_path / "trajectory.csv", small_survey.frames, [], small_survey.map_frame
        )


FIGURES = ["depth", "depth-histogram", "error-by-depth", "error-histogram", "errors", "holes"]


class Links(HTMLParser):
    """Collects what a page would load or link to, and its text."""

    def __init__(self) -> None:
        super().__init__()
        self.targets: list[str] = []
        self.words = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.targets += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_data(self, data: str) -> None:
        self.words += data


def write_report_of(survey: Any, folder: Path) -> str:
    """Write the report of a survey and return the page."""
    folder.mkdir()
    hull, origin = hull_of(survey.records), survey.map_frame.origin[:2]
    accuracy = Accuracy(water_level=survey.water_level, survey_area=hull, cell_size=8.0)
    accuracy.add(survey.bottom, survey.surface)
    coverage = CoverageTally(survey_area=hull + origin, cell_size=4.0, reach=4.6)
    looked = [looked_at(record) for record in survey.records]
    places, outcomes = (np.concatenate(columns) for columns in zip(*looked, strict=True))
    coverage.add(places + origin, outcomes)
    water = petzold_water("coastal", refractive_index=1.34, group_index=1.36)
    depths, grid = DepthProfile(), grid_elevation(survey.bottom, survey.map_frame, cell_size=8.0)
    depths.add(survey.bottom)
    metrics = accuracy.metrics(
        pixels=tallied(survey.records),
        elevation_at=survey.elevation_at,
        water=WaterColumn.uniform(water),
    )
    write_report(
        folder,
        Findings(
            title="Bar <b>",
            description="Flown & stitched.",
            metrics=metrics | {"error_by_depth": depths.metrics()},
            grid=grid,
            error_grid=gridded(*error_places(survey.bottom, survey.map_frame, grid.cells)),
            coverage=coverage.map(),
            errors=accuracy.bottom.errors,
            water_level=survey.water_level,
        ),
    )
    return (folder / "report.html").read_text(encoding="utf-8")


def test_report_is_self_contained_and_repeatable(small_survey: Any, tmp_path: Path) -> None:
    page = write_report_of(small_survey, tmp_path / "a")
    assert page == write_report_of(small_survey, tmp_path / "b")
    parsed = Links()
    parsed.feed(page)
    figures = sorted(file.stem for file in (tmp_path / "a" / "figures").iterdir())
    assert figures == FIGURES
    assert len(parsed.targets) == len(figures)
    assert all(target.startswith("data:image/png;base64,") for target in parsed.targets)
    assert "Bar <b>" in parsed.words
    assert "Flown & stitched." in parsed.words
    assert "too deep" in parsed.words
    assert "nine in ten should down to 7.0 m (c z 2.8, K_d z 1.3)" in parsed.words

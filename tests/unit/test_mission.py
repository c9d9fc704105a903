"""Small but real missions, from scenario to products."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import binom
from typer.testing import CliRunner

from survey.cli import app
from survey.cloud.points import Outcome, PointClass
from survey.errors import UserError
from survey.exit_status import BAD_INPUT, explain
from survey.mission import fly, fly_frame
from survey.preparation import prepare
from survey.products.frame_file import FrameResult, read_frame
from survey.products.writing import ProductError
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario
from survey.scenario.toml_text import to_toml
from survey.sensor.detector import Readings

FIGURES = (
    *("depth", "holes", "errors", "waveform", "failures", "error-histogram"),
    *("depth-histogram", "error-by-depth", "detection"),
)
PRODUCTS = {
    *("scenario.toml", "manifest.json", "journal.jsonl", "trajectory.csv", "bottom.laz"),
    *("water_surface.laz", "bottom.ply", "water_surface.ply", "bathymetry.tif", "bathymetry.glb"),
    *("coverage.geojson", "failures.geojson", "lines.geojson", "metrics.json"),
    *("performance.json", "report.html", "strip_differences.tif", "log.txt", ".lock"),
    *(f"frames/{number:06d}.npz" for number in range(3)),
}
DIFFERS_BY_RUN = {"performance.json", "journal.jsonl", "log.txt"}


@pytest.fixture
def small(tables: dict[str, Any], tmp_path: Path) -> Scenario:
    """Three frames of 16 x 8 pixels with few walks, over a slope from 3 m."""
    tables["flight"] |= {"frames_per_line": 3, "speed_m_s": 20.0}
    tables["camera"] = {"rows": 8, "columns": 16}
    tables["transport"] = {"walks_per_pixel": 32}
    tables["seabed"] = {"kind": "slope", "depth_m": 3.0, "slope_deg": 3.0, "downhill_deg": 90.0}
    return Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)


class Log:
    """Remembers which frames were flown."""

    def __init__(self) -> None:
        self.total, self.flown, self.summary = -1, set[int](), ""
        self.notices = list[str]()
        self.steps, self.written_steps = 0, 0

    def started(self, total: int) -> None:
        self.total = total

    def noticed(self, text: str) -> None:
        self.notices.append(text)

    def frame_done(self, index: int, seconds: float) -> None:
        self.flown.add(index)

    def writing(self, total: int) -> None:
        self.steps = total

    def written(self, steps: int) -> None:
        self.written_steps += steps

    def finished(self, summary: str) -> None:
        self.summary = summary


def products(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    found = {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}
    return {name: content for name, content in found.items() if name not in DIFFERS_BY_RUN}


def metrics(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "metrics.json").read_text())
    return found


def test_a_mission_leaves_every_product_and_finds_the_seabed(
    small: Scenario, tmp_path: Path
) -> None:
    log = Log()
    run = fly(small, tmp_path / "run", workers=2, watch=log)
    files = {p.relative_to(run).as_posix() for p in run.rglob("*") if p.is_file()}
    assert files == PRODUCTS | {f"figures/{name}.png" for name in FIGURES}
    found = metrics(run)
    assert found["frames"] == 3
    assert found["points_bottom"] > 250
    assert abs(found["bias_m"]) < 0.15
    assert found["p95_abs_error_m"] < 0.4
    assert abs(found["surface_bias_m"]) < 0.1
    assert (log.total, log.flown) == (3, {0, 1, 2})
    assert log.written_steps == log.steps >= 6
    assert f"{found['points_bottom']} bottom points" in log.summary
    assert set(found["s44"]["orders"]["special"]["criteria"]) > {"tvu", "feature_detection"}
    assert "Secchi depths" in log.summary
    assert "<h2>Verdict</h2>" in (run / "report.html").read_text()


@pytest.mark.slow
def test_same_bytes_for_any_workers_any_stops_and_any_damage(
    small: Scenario, tmp_path: Path
) -> None:
    wanted = products(fly(small, tmp_path / "one", workers=1))
    assert products(fly(small, tmp_path / "two", workers=2)) == wanted

    log = Log()
    parts = fly(small, tmp_path / "parts", frames=range(1, 2), watch=log)
    assert log.flown == {1}
    assert metrics(parts)["frames"] == 1
    log = Log()
    fly(small, parts, watch=log)
    assert (log.total, log.flown) == (2, {0, 2})
    assert products(parts) == wanted

    (parts / "frames/000002.npz").write_bytes(b"ruined")
    log = Log()
    fly(small, parts, watch=log)
    assert log.flown == {2}
    assert log.notices == ["frame 2 is flown again: its file is not what was written"]
    assert products(parts) == wanted

    log = Log()
    fly(small, parts, watch=log)
    assert (log.total, log.flown) == (0, set())
    assert products(parts) == wanted


@pytest.mark.slow
def test_another_seed_is_another_survey(small: Scenario, tmp_path: Path) -> None:
    runs = [
        fly(small.replace(**{"mission.seed": seed}), tmp_path / str(seed), frames=range(1))
        for seed in (1, 2)
    ]
    results = [read_frame(run / "frames/000000.npz") for run in runs]
    assert not np.array_equal(results[0].bottom.position, results[1].bottom.position)


@pytest.mark.parametrize(
    ("depth", "bins", "reason"),
    [(45.0, 500, "too weak: the bottom is too deep"), (60.0, 300, "outside the receiver's gate")],
)
def test_water_too_deep_is_an_error_that_says_so(
    small: Scenario, tmp_path: Path, depth: float, bins: int, reason: str
) -> None:
    seabed = {"kind": "plane", "depth_m": depth}
    deep = small.replace(**{"seabed": seabed, "receiver.bins": bins})
    with pytest.raises(ProductError, match=f"no bottom found: .*{reason}") as caught:
        fly(deep, tmp_path / "run")
    assert explain(caught.value)[0] == BAD_INPUT
    file = tmp_path / "deep.toml"
    file.write_text(to_toml(dict(deep.given)), encoding="utf-8")
    result = CliRunner().invoke(app, ["run", str(file), "-o", str(tmp_path / "run2"), "--quiet"])
    assert result.exit_code == BAD_INPUT == 2
    assert reason in result.stderr
    assert "Traceback" not in result.output


def test_frames_that_do_not_exist_are_an_error(small: Scenario, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no frame was flown"):
        fly(small, tmp_path / "run", frames=range(7, 9))


def test_over_land_there_is_ground_and_no_bottom(small: Scenario, tmp_path: Path) -> None:
    land = small.replace(seabed={"kind": "plane", "depth_m": -3.0})
    found = metrics(fly(land, tmp_path / "run", frames=range(1)))
    assert found["points_ground"] > 0.95 * 16 * 8
    assert (found["points_bottom"], found["points_surface"], found["pixels_wet"]) == (0, 0, 0)
    assert abs(found["ground_bias_m"]) < 0.05


def flown(scenario: Scenario, frames: int) -> list[FrameResult]:
    mission = prepare(scenario)
    return [fly_frame(mission, frame) for frame in mission.frames[:frames]]


class Dice:
    """A detector that counts as expected and remembers what it was given to draw from."""

    def __init__(self) -> None:
        self.rolls: list[int] = []

    def read(self, light: NDArray[np.float64], chance: np.random.Generator) -> Readings:
        self.rolls.append(int(chance.integers(1 << 62)))
        return Readings(
            counts=np.round(light).astype(np.int32), blind=np.zeros(light.shape, np.bool_)
        )


def test_every_frame_draws_its_own_counts_and_always_the_same(small: Scenario) -> None:
    dice = Dice()
    mission = replace(prepare(small), detector=dice)  # type: ignore[arg-type]
    for index in (0, 1, 0):
        fly_frame(mission, mission.frames[index])
    assert dice.rolls[0] == dice.rolls[2] != dice.rolls[1]


def test_a_bottom_just_under_the_surface_is_merged_with_it(small: Scenario) -> None:
    shallow = small.replace(seabed={"kind": "plane", "depth_m": 0.2})
    (result,) = flown(shallow, 1)
    assert not np.isin(result.bottom.classification, (40, 43)).any()
    assert (result.record.outcome == Outcome.MERGED_WITH_SURFACE).all()
    assert result.record.true_depth == pytest.approx(0.7)


def test_over_bottomless_water_false_bottoms_are_as_rare_as_stated() -> None:
    scenario = load_scenario("too-deep")
    results = flown(scenario, 2)
    pixels = sum(result.record.outcome.size for result in results)
    false = sum(int(np.isin(result.bottom.classification, (40, 43)).sum()) for result in results)
    assert pixels == 4096
    assert false <= binom.isf(1e-4, pixels, scenario.processing.false_alarm_rate)
    for result in results:
        wrong = result.record.outcome == Outcome.FALSE_BOTTOM
        assert wrong.sum() == np.isin(result.bottom.classification, (40, 43)).sum()
        assert not np.any(result.bottom.classification == PointClass.GROUND)


def test_bottoms_too_far_apart_for_a_mesh_leave_all_other_products(
    small: Scenario, tmp_path: Path
) -> None:
    """Four pixels 1.6 m apart over cells of 0.5 m."""
    few = {"camera.rows": 2, "camera.columns": 2, "processing.grid_m": 0.5}
    run = fly(small.replace(**few, **{"flight.frames_per_line": 1}), tmp_path / "run", workers=1)
    assert not (run / "bathymetry.glb").exists()
    assert (run / "bathymetry.tif").exists()
    assert metrics(run)["points_bottom"] == 4

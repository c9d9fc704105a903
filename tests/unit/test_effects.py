"""What each effect costs: which effects a scenario has, the figures, and their errors."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

from survey.cli import app
from survey.effects.costs import cost, figures_of
from survey.effects.report import as_json, row
from survey.effects.switches import effects
from survey.scenario import Scenario, components
from survey.scenario.load import load_scenario
from survey.scenario.toml_text import to_toml

ALWAYS = {"scattering", "light of neighbours", "sun", "dark counts"}


@pytest.mark.parametrize(
    ("name", "more"),
    [
        ("sandbar", set()),
        ("reef-with-swell", {"waves", "whitecaps"}),
        ("harbor-wreck", {"map of the bottom", "objects"}),
        ("rolling-aircraft", {"motion", "side wind", "navigation errors"}),
        ("area-survey", {"motion", "side wind", "navigation errors"}),
    ],
)
def test_each_effect_of_a_scenario_can_be_left_out(name: str, more: set[str]) -> None:
    scenario = load_scenario(name)
    found = effects(scenario)
    assert set(found) == ALWAYS | more
    for effect, changes in found.items():
        assert effect not in effects(scenario.replace(**changes)) or effect == "scattering"


def test_a_spad_becomes_a_counter_of_as_many_photons(tables: dict[str, Any]) -> None:
    tables["detector"] = {
        **{"kind": "spad", "quantum_efficiency": 0.4, "fill_factor": 0.5, "dead_time_ns": 50.0},
        **{"dark_count_rate_hz": 10.0, "pulses_per_frame": 7},
    }
    scenario = Scenario.from_tables(tables, name="spad.toml", folder=Path())
    ideal = scenario.replace(**effects(scenario)["detector"]).detector
    assert (ideal.kind, ideal.quantum_efficiency, ideal.pulses_per_frame) == ("ideal", 0.2, 7)


def test_the_mounting_that_is_known_stays() -> None:
    scenario = load_scenario("rolling-aircraft")
    left = components.navigation(scenario.replace(**effects(scenario)["navigation errors"]))
    assert left.mounting == left.believed_mounting
    assert left.mounting.lever_arm == (0.5, 0.0, 0.3)
    assert left.deviations == (0.0,) * 6


def some_sums(
    bias: float, *, seed: int, frames: int = 400, pixels: int = 50, spread: float = 0.1
) -> NDArray[np.float64]:
    """Frames whose errors share a part of ``spread`` [m] and scatter by 0.2 m within them."""
    random = np.random.default_rng(seed)
    error = bias + spread * random.normal(size=(frames, 1))
    error = error + 0.2 * random.normal(size=(frames, pixels))
    count = np.full(frames, float(pixels))
    squares = (error**2).sum(axis=1)
    return np.column_stack([count * 2, count, count * 0.5, error.sum(axis=1), squares, squares])


def test_figures_and_their_errors_against_known_scatter() -> None:
    """The mean's error is sqrt(0.1^2 + 0.2^2 / 50) / sqrt(400)."""
    found = cost("waves", some_sums(-0.1, seed=1), some_sums(-0.1, seed=1))
    error = np.hypot(0.1, 0.2 / np.sqrt(50.0)) / 20.0
    assert found.error[1] == pytest.approx(error, rel=0.1)
    assert found.value[1] == pytest.approx(-0.1, abs=4.0 * error)
    assert found.value[0] == pytest.approx(np.sqrt(0.01 + 0.01 + 0.04), rel=0.03)
    assert found.value[3:].tolist() == [25.0, 25.0]
    assert not found.change.any()
    assert not found.change_error.any()


def test_what_both_missions_share_does_not_blur_the_change() -> None:
    whole = some_sums(0.0, seed=2)
    shifted = whole.copy()
    shifted[:, 3] += 0.05 * whole[:, 1]
    found = cost("waves", shifted, whole)
    assert found.change[1] == pytest.approx(0.05)
    assert found.change_error[1] < 1e-9 < found.error[1]
    apart = cost("waves", some_sums(0.05, seed=3), whole)
    assert apart.change_error[1] == pytest.approx(np.sqrt(2.0) * found.error[1], rel=0.2)


def test_one_frame_has_no_error_and_nothing_found_no_figure() -> None:
    sums = np.array([[10.0, 0.0, 2.0, 0.0, 0.0, 0.0]])
    assert figures_of(sums)[3:].tolist() == [80.0, 20.0]
    told = as_json(cost("sun", sums, sums))
    assert told["rmse_m"]["value"] is None
    assert told["lost_percent"] == {
        **{"value": 80.0, "standard_error": None, "change": 0.0, "change_standard_error": None}
    }
    assert row(cost("sun", sums, sums)).startswith("| sun | - | - | - | 80.00 (+0.00 ± nan)")


def test_the_command_tells_what_navigation_costs(tables: dict[str, Any], tmp_path: Path) -> None:
    tables["camera"] = {"rows": 4, "columns": 8, "pixel_footprint_m": 2.0}
    tables["seabed"] = {"kind": "plane", "depth_m": 4.0}
    tables["transport"] = {"walks_per_pixel": 32}
    tables["navigation"] = {"gnss_bias_east_m": 0.5, "gnss_bias_up_m": 0.2}
    file = tmp_path / "reef.toml"
    file.write_text(to_toml(tables), encoding="utf-8")
    result = CliRunner().invoke(app, ["effects", str(file), "--json"])
    assert result.exit_code == 0, result.output
    found = {each["without"]: each for each in json.loads(result.stdout)["costs"]}
    assert set(found) == ALWAYS | {"nothing", "navigation errors"}
    assert found["nothing"]["sideways_m"]["value"] == pytest.approx(0.5, abs=1e-3)
    better = found["navigation errors"]
    assert better["sideways_m"]["value"] == pytest.approx(0.0, abs=1e-3)
    assert better["bias_m"]["change"] == pytest.approx(-0.2, abs=0.03)
    assert 0.0 < found["scattering"]["bias_m"]["change"] < 0.1

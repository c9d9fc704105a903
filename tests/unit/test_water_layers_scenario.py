"""Layers and profiles of water in a scenario, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.errors import OtherRunError
from survey.optics.phase import fournier_forand_of_backscatter, petzold
from survey.optics.water import PAPER_COEFFICIENTS
from survey.run_folder import RunFolder
from survey.scenario import components
from survey.scenario.faults import ScenarioError
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario
from survey.scenario.water_notes import water_notes

CAST = (
    "depth_m, absorption_per_m, scattering_per_m, temperature_degc\n"
    "1.0, 0.10, 0.20, 14\n4.0, 0.10, 0.20, 13\n8.0, 0.20, 0.60, 11\n"
)
WITH_BACKSCATTER = (
    "scattering_per_m,depth_m,absorption_per_m,backscatter_fraction\n"
    "0.2,0,0.1,0.0101\n0.2,5,0.1,0.0102\n0.8,6,0.2,0.02\n"
)
LAYERED: dict[str, Any] = {
    "type": "clear",
    "layers": [
        {"type": "harbor", "from_depth_m": 8.0, "scattering_per_m": 1.0},
        {"secchi_depth_m": 5.0, "from_depth_m": 0.0, "to_depth_m": 2.0},
    ],
}
WATERS = {
    "layers": LAYERED,
    "profile": {"profile": "cast.csv"},
    "profile with backscatter": {"profile": "back.csv"},
    "layer in a profile": {
        "profile": {"file": "cast.csv", "source": "a cast"},
        "phase_function": "molecular",
        "layers": [
            {
                "absorption_per_m": 0.3,
                "scattering_per_m": 2.0,
                "phase_function": {"kind": "fournier_forand", "backscatter_fraction": 0.02},
                "from_depth_m": 9.0,
                "to_depth_m": 10.0,
            }
        ],
    },
}


@pytest.fixture
def scenario(tables: dict[str, Any], tmp_path: Path) -> Any:
    """Return a function that makes the scenario with a given section [water]."""
    (tmp_path / "cast.csv").write_text(CAST)
    (tmp_path / "back.csv").write_text(WITH_BACKSCATTER)

    def make(water: dict[str, Any], **changes: Any) -> Scenario:
        return Scenario.from_tables(
            tables | {"water": water} | changes, name="reef.toml", folder=tmp_path
        )

    return make


@pytest.mark.parametrize("name", WATERS)
def test_resolved_text_reads_back_as_the_same_column(
    scenario: Any, tmp_path: Path, name: str
) -> None:
    first = scenario(WATERS[name])
    (tmp_path / "runs").mkdir()
    path = tmp_path / "runs" / "scenario.toml"
    path.write_text(first.to_toml(beside=path.parent), encoding="utf-8")
    again = load_scenario(path)
    assert again.to_toml(beside=path.parent) == path.read_text(encoding="utf-8")
    made, remade = (components.water(each) for each in (first, again))
    for one, other in zip(made.layers, remade.layers, strict=True):
        assert one.top == other.top
        assert one.water.absorption == other.water.absorption
        assert one.water.scattering == other.water.scattering
        assert one.water.phase_function.name == other.water.phase_function.name


def test_layers_lie_in_the_water_of_the_section(scenario: Any) -> None:
    made = components.water(scenario(LAYERED))
    assert [layer.top for layer in made.layers] == [0.0, 2.0, 8.0]
    _, clear, harbor = (layer.water for layer in made.layers)
    assert (clear.absorption, clear.scattering) == PAPER_COEFFICIENTS["clear"]
    assert (harbor.absorption, harbor.scattering) == (0.366, 1.0)
    assert harbor.phase_function.name == petzold("harbor").name


def test_a_profile_is_that_of_its_cast(scenario: Any) -> None:
    made = components.water(scenario(WATERS["profile"]))
    assert made.absorbed([1.0, 4.0, 8.0, 10.0]) == pytest.approx([0.1, 0.4, 1.0, 1.4])
    assert made.scattered([1.0, 4.0, 8.0, 10.0]) == pytest.approx([0.2, 0.8, 2.4, 3.6])
    assert {layer.water.phase_function.name for layer in made.layers} == {
        "average Petzold particle, web book"
    }


def test_backscatter_of_a_cast_makes_few_phase_functions(scenario: Any) -> None:
    made = components.water(scenario(WATERS["profile with backscatter"]))
    kinds = {id(layer.water.phase_function) for layer in made.layers}
    assert len(kinds) == 2
    for depth, fraction in ((0.0, 0.0101), (5.1, 0.0102), (6.0, 0.02)):
        found = made.at(depth).phase_function.backscatter_fraction
        expected = fournier_forand_of_backscatter(fraction).backscatter_fraction
        assert found == pytest.approx(expected, rel=0.026)


def test_a_layer_in_a_profile_replaces_it_there(scenario: Any) -> None:
    made = components.water(scenario(WATERS["layer in a profile"]))
    assert np.diff(made.scattered([8.5, 9.0, 10.0, 11.0])) == pytest.approx([0.3, 2.0, 0.6])
    assert made.at(9.5).phase_function.name.startswith("Fournier-Forand")
    assert made.at(8.5).phase_function.name.startswith("molecular")


def test_a_cast_belongs_to_the_run(scenario: Any, tmp_path: Path) -> None:
    flown = scenario(WATERS["profile"])
    RunFolder.open(tmp_path / "run", flown)
    RunFolder.open(tmp_path / "run", flown)
    (tmp_path / "cast.csv").write_text(CAST.replace("0.60", "0.61"))
    with pytest.raises(OtherRunError, match="other files that the scenario names"):
        RunFolder.open(tmp_path / "run", flown)


def test_sunlight_by_type_is_that_of_the_topmost_water(scenario: Any) -> None:
    sun = {"water_light": "by_water_type"}
    plume = {"type": "clear", "layers": [layer(0.0, 1.0)]}
    assert components.sky(scenario(plume, sun=sun)).water_reflectance == 0.0121
    assert components.sky(scenario({"type": "clear"}, sun=sun)).water_reflectance == 0.0097
    with pytest.raises(ScenarioError, match="is known by type for clear, coastal and harbor"):
        scenario(LAYERED, sun=sun)


def test_check_tells_every_layer(scenario: Any, tmp_path: Path) -> None:
    notes = list(water_notes(scenario(LAYERED)))
    assert notes[0].startswith("layer from 0 to 2 m: absorption 0.163, scattering 1.38, K_d ")
    assert notes[1].startswith("  low to high estimate: absorption ")
    assert notes[-3] == notes[0].replace("layer", "water")
    assert notes[-2] == ("water from 2 to 8 m: absorption 0.114, scattering 0.037, K_d 0.12 1/m")
    assert notes[-1].startswith("water from 8 m down: absorption 0.366, scattering 1, K_d 0.4")
    path = tmp_path / "cast.toml"
    path.write_text(scenario(WATERS["profile"]).to_toml())
    done = CliRunner().invoke(app, ["check", str(path)])
    assert done.exit_code == 0
    assert "profile down to 8 m, 17 layers: absorption 0.1 to 0.2, scattering 0.2 to 0" in (
        done.stdout
    )


def faults_of(scenario: Any, water: dict[str, Any], **changes: Any) -> list[str]:
    with pytest.raises(ScenarioError) as caught:
        scenario(water, **changes)
    return [line.removeprefix("reef.toml: ") for line in caught.value.lines]


def layer(begin: float, end: float | None = None, **water: Any) -> dict[str, Any]:
    return {"type": "harbor", "from_depth_m": begin, "to_depth_m": end} | water


@pytest.mark.parametrize(
    ("layers", "lines"),
    [
        (
            [{"type": "harbour", "to_depth_m": 1.0}, layer(-1.0, 0.0, colour=1)],
            [
                "water.layers.0.type: 'harbour' is not one of clear, coastal, harbor, stated, ",
                "water.layers.1.from_depth_m: -1.0 is out of bounds. It must be at least 0.",
                "water.layers.1.to_depth_m: 0.0 is out of bounds. It must be greater than 0.",
                "water.layers.1.colour: unknown key.",
            ],
        ),
        (
            [{"absorption_per_m": 0.1, "from_depth_m": 1.0, "refractive_index": 1.3}, {}],
            [
                "water.layers.0.scattering_per_m: missing. Give it a value.",
                "water.layers.0.refractive_index: unknown key. It belongs in [water].",
                "water.layers.1.type: missing. Say clear, coastal or harbor, or give ",
            ],
        ),
        (
            [layer(3.0, 3.0), layer(8.0), layer(2.0, 2.5), layer(9.0, 10.0), layer(2.4, 2.6)],
            [
                "water.layers.4.from_depth_m: 2.4 lies in layer 2 from 2 m to 2.5 m. Layers must",
                "water.layers.0.to_depth_m: 3 is not below from_depth_m 3. Lower it.",
                "water.layers.3.from_depth_m: 9 lies in layer 1 from 8 m to the bottom. Layers",
            ],
        ),
        (
            [
                {"type": "surveyed", "from_depth_m": 1.0, "to_depth_m": 2.0},
                {"kd_490_per_m": 0.001, "from_depth_m": 2.0, "to_depth_m": 3.0},
                layer(3.0, phase_function={"kind": "table", "file": "absent.csv"}),
            ],
            [
                "water.layers.0: give one of secchi_depth_m, kd_490_per_m, turbidity_ntu; there",
                "water.layers.1.kd_490_per_m: K_d(490) of 0.001 1/m, at 532 nm",
                "water.layers.2.phase_function.file: no file 'absent.csv' in ",
            ],
        ),
    ],
)
def test_every_fault_of_layers_has_its_line(
    scenario: Any, layers: list[dict[str, Any]], lines: list[str]
) -> None:
    given = [{k: v for k, v in each.items() if v is not None} for each in layers]
    found = faults_of(scenario, {"type": "clear", "layers": given})
    assert len(found) == len(lines)
    for line, start in zip(found, lines, strict=True):
        assert line.startswith(start)


def test_a_layer_has_its_wavelength_too(scenario: Any) -> None:
    water = {"absorption_per_m": 0.1, "scattering_per_m": 0.1, "layers": [layer(1.0, 2.0)]}
    (found,) = faults_of(scenario, water, laser={"wavelength_nm": 450.0})
    assert found.startswith("laser.wavelength_nm: 450 is outside 500 to 560, where water.layers.0")


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        (
            "depth_m,absorption_per_m\n1,2\n",
            ["line 1: no column scattering_per_m. It has depth_m, absorption_per_m."],
        ),
        (
            "depth_m,absorption_per_m,scattering_per_m\n1,2\n2,a,3\n",
            [
                "line 2: 2 columns, but there should be 3.",
                "line 3: absorption_per_m 'a' is not a number.",
            ],
        ),
        (
            "depth_m,absorption_per_m,scattering_per_m,backscatter_fraction\n"
            "-1,0.1,0.1,0.01\n2,-0.1,nan,0.7\n\n2,0.1,0.1,0.01\n",
            [
                "line 2: depth_m -1 is not in 0 to 12000.",
                "line 3: absorption_per_m -0.1 is not in 1e-06 to 1000.",
                "line 3: scattering_per_m nan is not in 1e-06 to 1000.",
                "line 3: backscatter_fraction 0.7 is not in ",
                "line 5: depth_m 2 is not below 2 before it. Sort the rows and leave out doubles.",
            ],
        ),
        ("depth_m,absorption_per_m,scattering_per_m\n1,2,3\n", ["1 rows. A profile needs 2 to "]),
        ("", ["line 1: no column depth_m. It has ."] + ["line 1: no column "] * 2),
        (b"\xff\xfe\x00", ["not UTF-8 text."]),
    ],
)
def test_every_fault_of_a_cast_has_its_line(
    scenario: Any, tmp_path: Path, text: str | bytes, lines: list[str]
) -> None:
    path = tmp_path / "bad.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    found = faults_of(scenario, {"profile": "bad.csv"})
    assert len(found) == len(lines)
    for line, start in zip(found, lines, strict=True):
        assert line.startswith(f"water.profile: bad.csv: {start}")


def test_a_cast_that_is_not_there(scenario: Any) -> None:
    (found,) = faults_of(scenario, {"profile": "absent.csv"})
    assert found.startswith("water.profile: no file 'absent.csv' in ")
    with pytest.raises(ScenarioError) as caught:
        scenario({"profile": "absent.csv"})
    assert caught.value.only_missing_files

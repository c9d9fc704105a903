"""The ways to state a water in a scenario, what they come to, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.errors import OtherRunError
from survey.optics.phase import average_particle, molecular, petzold
from survey.optics.water import Water, petzold_water
from survey.run_folder import RunFolder
from survey.scenario import components
from survey.scenario.faults import ScenarioError
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario
from survey.scenario.toml_text import to_toml
from survey.scenario.water_notes import water_notes

OWN = {"absorption_per_m": 0.1, "scattering_per_m": 0.3}
TABLE = "angle_deg,value\n1,50\n10,1\n90,0.004\n180,0.006\n"
WAYS: dict[str, dict[str, Any]] = {
    "petzold": {"type": "harbor"},
    "petzold, changed": {"type": "clear", "absorption_per_m": 0.2, "phase_function": "molecular"},
    "stated": OWN,
    "file": OWN | {"phase_function": {"kind": "table", "file": "vsf.csv"}},
    "mixture": OWN
    | {
        "phase_function": {
            "kind": "mixture",
            "components": [
                {"scattering_fraction": 0.1, "phase_function": "molecular"},
                {
                    "scattering_fraction": 0.9,
                    "phase_function": {"kind": "table", "file": "vsf.csv"},
                },
            ],
        }
    },
    "components": {"chlorophyll_mg_m3": 2.0, "yellow_absorption_440_per_m": 0.05},
    "components of the paper": {
        "type": "components",
        "pure_absorption": "paper",
        "pure_scattering": "paper",
        "particle_scattering_550_per_m": 0.2,
    },
    "secchi": {"secchi_depth_m": 6.0},
    "secchi by Lee": {"secchi_depth_m": 6.0, "secchi_relation": "lee", "estimate": "low"},
    "kd": {"kd_490_per_m": 0.15},
    "turbidity": {"turbidity_ntu": 2.0, "particle_scattering_factor": 0.45},
}


def uniform(scenario: Scenario) -> Water:
    """Return the water of a scenario without layers."""
    column = components.water(scenario)
    assert column.is_uniform
    return column.surface


@pytest.fixture
def scenario(tables: dict[str, Any], tmp_path: Path) -> Any:
    """Return a function that makes the scenario with a given section [water]."""
    (tmp_path / "vsf.csv").write_text(TABLE)

    def make(water: dict[str, Any], **changes: Any) -> Scenario:
        return Scenario.from_tables(
            tables | {"water": water} | changes, name="reef.toml", folder=tmp_path
        )

    return make


@pytest.mark.parametrize("way", WAYS)
def test_resolved_text_reads_back_as_the_same_water(
    scenario: Any, tmp_path: Path, way: str
) -> None:
    first = scenario(WAYS[way])
    (tmp_path / "runs").mkdir()
    path = tmp_path / "runs" / "scenario.toml"
    path.write_text(first.to_toml(beside=path.parent), encoding="utf-8")
    again = load_scenario(path)
    assert again.to_toml(beside=path.parent) == path.read_text(encoding="utf-8")
    made, remade = uniform(first), uniform(again)
    assert (made.absorption, made.scattering) == (remade.absorption, remade.scattering)
    density = made.phase_function.density_on_grid
    assert np.array_equal(density, remade.phase_function.density_on_grid)
    assert made.absorption > 0.0
    assert 0.0 < made.scattering / made.attenuation < 1.0


def test_petzolds_waters_are_as_before(scenario: Any) -> None:
    made = uniform(scenario({"type": "coastal", "scattering_per_m": 0.5}))
    expected = petzold_water("coastal", scattering=0.5, refractive_index=1.3415, group_index=1.36)
    assert (made.absorption, made.scattering) == (expected.absorption, expected.scattering)
    density = made.phase_function.density_on_grid
    assert np.array_equal(density, expected.phase_function.density_on_grid)


@pytest.mark.parametrize(
    ("phase", "name", "backscatter"),
    [
        ("average_particle", "average Petzold particle, web book", 0.0183),
        ({"kind": "petzold", "type": "harbor"}, "Petzold harbor", 0.01996),
        ({"kind": "fournier_forand", "backscatter_fraction": 0.01}, "Fournier-Forand", 0.01),
        (
            {"kind": "fournier_forand", "particle_index": 1.1, "size_slope": 3.5835},
            "Fournier-Forand n = 1.1000, mu = 3.5835",
            0.0183,
        ),
        ({"kind": "henyey_greenstein", "asymmetry": 0.9}, "Henyey-Greenstein g = 0.9", 0.0229),
        (
            {
                "kind": "two_term",
                "forward_share": 0.5,
                "forward_asymmetry": 0.6,
                "backward_asymmetry": -0.6,
            },
            "Henyey-Greenstein 0.5",
            0.5,
        ),
        ({"kind": "molecular", "depolarisation": 0.09}, "molecular, depolarisation 0.09", 0.5),
        ({"kind": "table", "file": "vsf.csv"}, "vsf.csv", None),
    ],
)
def test_phase_functions_by_their_words(
    scenario: Any, phase: Any, name: str, backscatter: float | None
) -> None:
    found = uniform(scenario(OWN | {"phase_function": phase})).phase_function
    assert found.name.startswith(name)
    if backscatter is not None:
        assert found.backscatter_fraction == pytest.approx(backscatter, rel=5e-3)


def test_a_mixture_is_weighted_by_its_fractions(scenario: Any) -> None:
    parts = [
        {"scattering_fraction": 0.25, "phase_function": "molecular"},
        {"scattering_fraction": 0.75, "phase_function": {"kind": "petzold", "type": "clear"}},
    ]
    made = uniform(scenario(OWN | {"phase_function": {"kind": "mixture", "components": parts}}))
    expected = 0.25 * molecular().density(1.0) + 0.75 * petzold("clear").density(1.0)
    assert float(made.phase_function.density(1.0)) == pytest.approx(float(expected), rel=1e-4)


def test_components_add_up(scenario: Any) -> None:
    """The paper's sum, with its own pure water: 22 1/km and 1.5 1/km, particles 0.2 1/m at 550."""
    made = uniform(scenario(WAYS["components of the paper"]))
    assert made.absorption == pytest.approx(0.022, rel=1e-12)
    assert made.scattering == pytest.approx(0.0015 + 0.2 * 550.0 / 532.0, rel=1e-12)
    made = uniform(scenario(WAYS["components"]))
    yellow = 0.05 * np.exp(-0.014 * 92.0)
    assert made.absorption == pytest.approx(0.04444 + 0.0155 * 2.0**0.7993 + yellow, rel=1e-4)
    assert made.scattering == pytest.approx(0.00196 + 0.30 * 2.0**0.62 * 550 / 532, rel=1e-3)


def test_particles_take_the_phase_function_pure_water_keeps_its_own(scenario: Any) -> None:
    water = WAYS["components"] | {"phase_function": {"kind": "petzold", "type": "coastal"}}
    made = uniform(scenario(water))
    pure = 0.00196
    share = (made.scattering - pure) * petzold("coastal").backscatter_fraction + 0.5 * pure
    found = made.phase_function.backscatter_fraction * made.scattering
    assert found == pytest.approx(share, rel=2e-3)
    assert average_particle().backscatter_fraction > found / made.scattering


@pytest.mark.parametrize(("by", "depolarisation"), [("zhang", 0.039), ("morel", 0.09)])
def test_pure_water_scatters_as_molecules(scenario: Any, by: str, depolarisation: float) -> None:
    made = uniform(scenario({"type": "components", "pure_scattering": by}))
    ahead, aside = made.phase_function.density([1e-3, 0.5 * np.pi])
    assert aside / ahead == pytest.approx(0.5 * (1.0 + depolarisation), rel=1e-4)


def test_low_and_high_estimates_enclose_the_central_one(scenario: Any) -> None:
    for figure in ("secchi_depth_m", "kd_490_per_m", "turbidity_ntu"):
        value = {"secchi_depth_m": 8.0, "kd_490_per_m": 0.1, "turbidity_ntu": 1.0}[figure]
        low, central, high = (
            uniform(scenario({figure: value, "estimate": word})).attenuation
            for word in ("low", "central", "high")
        )
        assert low < central < high


def test_spread_is_told(scenario: Any) -> None:
    first, estimates, mixtures = water_notes(scenario({"kd_490_per_m": 0.15}))
    assert first.startswith("water at 532 nm: absorption 0.0871, scattering 0.61")
    assert "low to high estimate: absorption 0.07" in estimates
    assert "particle_scattering_factor 0.12 to 0.45: absorption 0.0" in mixtures
    assert len(list(water_notes(scenario(WAYS["components"])))) == 1
    assert list(water_notes(scenario({"type": "coastal"}))) == []


def test_check_tells_the_spread(scenario: Any, tmp_path: Path) -> None:
    path = tmp_path / "secchi.toml"
    path.write_text(scenario({"secchi_depth_m": 6.0}).to_toml())
    done = CliRunner().invoke(app, ["check", str(path)])
    assert done.exit_code == 0
    assert "low to high estimate: absorption" in done.stdout


def test_a_table_belongs_to_the_run(scenario: Any, tmp_path: Path) -> None:
    flown = scenario(WAYS["mixture"])
    RunFolder.open(tmp_path / "run", flown)
    RunFolder.open(tmp_path / "run", flown)
    (tmp_path / "vsf.csv").write_text(TABLE.replace("0.006", "0.007"))
    with pytest.raises(OtherRunError, match="other files that the scenario names"):
        RunFolder.open(tmp_path / "run", flown)


def faults_of(scenario: Any, water: dict[str, Any], **changes: Any) -> list[str]:
    with pytest.raises(ScenarioError) as caught:
        scenario(water, **changes)
    return [line.removeprefix("reef.toml: ") for line in caught.value.lines]


@pytest.mark.parametrize(
    ("water", "lines"),
    [
        ({}, ["water.type: missing. Say clear, coastal or harbor, or give secchi_depth_m, "]),
        (
            {"type": "harbour", "absorption_per_m": -1.0, "colour": 1},
            [
                "water.type: 'harbour' is not one of clear, coastal, harbor, stated, components, "
                "surveyed, profiled. Did you mean 'harbor'?",
                "water.absorption_per_m: -1.0 is out of bounds. It must be at least 0.",
                "water.colour: unknown key.",
            ],
        ),
        (
            {"absorption_per_m": 0.0, "scattering_per_m": -0.1, "phase_function": "averge"},
            [
                "water.absorption_per_m: 0.0 is out of bounds. It must be greater than 0.",
                "water.scattering_per_m: -0.1 is out of bounds. It must be greater than 0.",
                "water.phase_function.kind: 'averge' is not one of petzold, average_particle, ",
            ],
        ),
        (
            {"type": "stated"},
            [
                "water.absorption_per_m: missing. Give it a value.",
                "water.scattering_per_m: missing. Give it a value.",
            ],
        ),
        (
            {"type": "coastal", "secchi_depth_m": 5.0},
            ["water.secchi_depth_m: unknown key. It goes with type = surveyed."],
        ),
        (
            {"secchi_depth_m": 5.0, "kd_490_per_m": 0.1},
            [
                "water: give one of secchi_depth_m, kd_490_per_m, turbidity_ntu; there is "
                "secchi_depth_m and kd_490_per_m."
            ],
        ),
        (
            {"type": "surveyed"},
            ["water: give one of secchi_depth_m, kd_490_per_m, turbidity_ntu; there is none."],
        ),
        (
            {"kd_490_per_m": 0.001},
            ["water.kd_490_per_m: K_d(490) of 0.001 1/m, at 532 nm 0.039 1/m, lies outside "],
        ),
        (
            {"secchi_depth_m": 5.0, "estimate": "middle"},
            ["water.estimate: 'middle' is not one of low, central, high."],
        ),
        (
            {"chlorophyll_mg_m3": -1.0, "salinity_psu": 90.0},
            [
                "water.salinity_psu: 90.0 is out of bounds. It must be at most 45.",
                "water.chlorophyll_mg_m3: -1.0 is out of bounds. It must be at least 0.",
            ],
        ),
        (
            OWN | {"phase_function": {"kind": "henyey_greenstein", "assymetry": 0.9}},
            [
                "water.phase_function.asymmetry: missing. Give it a value.",
                "water.phase_function.assymetry: unknown key. Did you mean 'asymmetry'?",
            ],
        ),
        (
            OWN | {"phase_function": {"kind": "molecular", "asymmetry": 0.9}},
            ["water.phase_function.asymmetry: unknown key. It goes with kind = henyey_greenstein."],
        ),
        (
            OWN | {"phase_function": {"kind": "fournier_forand", "size_slope": 3.5}},
            [
                "water.phase_function: give particle_index and size_slope, or "
                "backscatter_fraction alone."
            ],
        ),
        (
            OWN | {"phase_function": {"kind": "fournier_forand", "backscatter_fraction": 0.499}},
            ["water.phase_function.backscatter_fraction: backscatter_fraction = 0.499: must lie "],
        ),
        (
            OWN | {"phase_function": {"kind": "table", "file": "absent.csv"}},
            ["water.phase_function.file: no file 'absent.csv' in "],
        ),
        (
            OWN
            | {
                "phase_function": {
                    "kind": "mixture",
                    "components": [
                        {"scattering_fraction": 0.5, "phase_function": "molecular"},
                        {
                            "scattering_fraction": 0.6,
                            "phase_function": {"kind": "table", "file": "absent.csv"},
                        },
                    ],
                }
            },
            [
                "water.phase_function.components: the scattering fractions add up to 1.1. Make it",
                "water.phase_function.components.1.phase_function.file: no file 'absent.csv' in ",
            ],
        ),
        (
            OWN | {"group_index": 1.3},
            ["water.group_index: 1.3 is below refractive_index 1.3415. A pulse "],
        ),
    ],
)
def test_every_fault_has_its_line(scenario: Any, water: dict[str, Any], lines: list[str]) -> None:
    found = faults_of(scenario, water)
    assert len(found) == len(lines)
    for line, start in zip(found, lines, strict=True):
        assert line.startswith(start)


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ("angle_deg,value\n10,1\n5,2\n180,1\n", ["line 3: angle 5 deg after 10: angles must asc"]),
        (
            "angle_deg,value\n0,1\n90,-1\n170,1\n",
            ["line 3: value -1: must be positive", "line 4: the table ends at 170 deg: must reach"],
        ),
        ("angle_deg,value\n1,8\n2,1\n180,1\n", ["line 2: below its first angle the table goes on"]),
        ("", ["line 1: a table needs at least two rows"]),
    ],
)
def test_tables_that_are_no_phase_function(
    scenario: Any, tmp_path: Path, text: str, faults: list[str]
) -> None:
    (tmp_path / "bad.csv").write_text(text)
    found = faults_of(scenario, OWN | {"phase_function": {"kind": "table", "file": "bad.csv"}})
    assert len(found) == len(faults)
    for line, start in zip(found, faults, strict=True):
        assert line.startswith(f"water.phase_function.file: bad.csv: {start}")


@pytest.mark.parametrize(
    ("water", "wavelength", "text"),
    [
        ({"type": "coastal"}, 450.0, "450 is outside 500 to 560, where water.type"),
        (WAYS["components of the paper"], 515.0, "the paper's figures for pure water hold at 530"),
    ],
)
def test_waters_known_at_one_colour_keep_to_it(
    scenario: Any, water: dict[str, Any], wavelength: float, text: str
) -> None:
    (line,) = faults_of(scenario, water, laser={"wavelength_nm": wavelength})
    assert line.startswith(f"laser.wavelength_nm: {text}")


@pytest.mark.parametrize("wavelength", [400.0, 450.0, 600.0, 650.0])
def test_components_and_figures_hold_in_all_the_visible(scenario: Any, wavelength: float) -> None:
    found = [
        uniform(scenario(water, laser={"wavelength_nm": wavelength})).absorption
        for water in (WAYS["components"], WAYS["secchi"], WAYS["kd"], WAYS["turbidity"])
    ]
    assert all(absorption > 0.0 for absorption in found)


def test_light_from_the_water_by_type_needs_a_type(scenario: Any) -> None:
    (line,) = faults_of(scenario, OWN, sun={"water_light": "by_water_type"})
    assert line.startswith("sun.water_light: is known by type for clear, coastal and harbor alone")


def test_tables_within_a_section_stand_in_one_line() -> None:
    text = to_toml({"water": {"phase_function": {"kind": "table", "slope": None, "parts": [{}]}}})
    assert text == '[water]\nphase_function = {kind = "table", parts = [{}]}\n'

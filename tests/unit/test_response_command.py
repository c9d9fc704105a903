"""The command `response`."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.response_report import water_of

RUN = CliRunner()
HARBOR = ["response", "--water", "harbor", "--illumination", "isolated", "--json"]
HARBOR += ["--bottom-depth", "2"]
OWN_WATER = ["response", "--a", "0.5", "--b", "0.5", "--bottom-depth", "1", "--phase-function"]

OWN_KIND = ["--phase-function", "molecular", "--bottom-depth", "1"]


def test_json_has_column_and_bottom(tmp_path):
    plot = tmp_path / "response.png"
    done = RUN.invoke(
        app,
        [*HARBOR, "--plot", str(plot)],
    )
    assert done.exit_code == 0
    found = json.loads(done.stdout)
    first, bottom = found["column"][0], found["bottom"]
    assert (first["from_m"], first["to_m"]) == (0.0, 0.5)
    assert 0.0 < first["sem"] < 0.02 * first["per_m_sr"]
    assert bottom["depth_m"] == 2.0
    assert 0.0 < bottom["two_way_10ns"] <= bottom["two_way"] < 1.0
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_own_water_as_a_table(tmp_path):
    table = tmp_path / "even.csv"
    table.write_text("angle_deg,value\n1,1\n90,1\n180,1\n")
    done = RUN.invoke(
        app,
        [*OWN_WATER, str(table)],
    )
    assert done.exit_code == 0
    assert "two-way transmission" in done.stdout


@pytest.mark.parametrize(
    ("phase", "name"),
    [
        ("average_particle", "average Petzold particle, web book"),
        ("harbor", "Petzold harbor"),
        ('{kind = "henyey_greenstein", asymmetry = 0.9}', "Henyey-Greenstein g = 0.9"),
    ],
)
def test_phase_functions_by_their_words(phase, name):
    water = water_of(
        name=None, absorption=0.5, scattering=0.25, phase_function=phase, bottom_depth=1.0
    )
    assert (water.absorption, water.scattering) == (0.5, 0.25)
    assert water.phase_function.name == name


def test_all_faults_of_the_options_at_once():
    options = ["--a", "0", "--b", "-1", "--phase-function", "averge_particle"]
    done = RUN.invoke(app, ["response", *options, "--bottom-depth", "inf"])
    assert done.exit_code == 2
    places = [line.split(": ")[1] for line in done.stderr.splitlines()]
    assert places == ["--a 0", "--b -1", "--bottom-depth inf", "--phase-function.kind"]
    assert "Did you mean 'average_particle'?" in done.stderr


def test_every_fault_of_a_table_has_its_line(tmp_path):
    table = tmp_path / "mine.csv"
    table.write_text("angle_deg,value\n10,1\n5,-1\n90,1\n")
    done = RUN.invoke(app, [*OWN_WATER, str(table)])
    assert done.exit_code == 2
    assert [line.split("mine.csv: ")[1][:7] for line in done.stderr.splitlines()] == [
        "line 3:",
        "line 3:",
        "line 4:",
    ]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--water", "coastel"], "is none of clear, coastal, harbor. Did you mean 'coastal'?"),
        (["--water", "harbor", "--bottom-depth", "50"], "beyond the light: from below 24.2 m"),
        (["--a", "1", "--b", "nan", "--phase-function", "molecular"], "--b nan: must be above 0"),
        (["--a", "1", "--b", "1", "--phase-function", "{kind = 1"], "not valid TOML"),
        (["--a", "1", "--b", "1", "--phase-function", "table"], "--phase-function.file: missing"),
        (["--a", "0.1", "--b", "0.2"], "go together"),
        ([], "give either --water or --a"),
        (["--water", "coastal", "--illumination", "sun"], "'flood', 'isolated'"),
        (["--water", "coastal", "--bottom-depth", "0"], "must be above 0"),
        (["--water", "coastal", "--plot", "x.bmp"], ".png or .svg"),
        (["--water", "coastal", "--plot", "none/x.png"], "--plot none/x.png: no folder 'none'"),
        (["--water", "coastal", "--seed", "9223372036854775808"], "'--seed'"),
        ([*OWN_KIND, "--a", "1e-9", "--b", "1e-9"], "together 2e-09 1/m, must be 0.04 or more"),
        ([*OWN_KIND, "--a", "1001", "--b", "1e300"], "--b 1e+300: must be 1000 or less"),
        (["--a", "-1", "--b", "0", "--phase-function", "x.csv"], "--b 0: must be above 0"),
        (["--a", "1", "--b", "1", "--phase-function", "none.csv"], "no file 'none.csv'"),
    ],
)
def test_bad_input_is_one_line_without_traceback(options, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = RUN.invoke(app, ["response", *options])
    assert done.exit_code in (2, 3)
    assert message in done.stderr
    assert "Traceback" not in done.stderr

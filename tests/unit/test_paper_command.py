"""The command `paper`: what it writes, what it refuses, what it leaves alone."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.paper.output import NAMES

RUN = CliRunner()
QUICK = ["paper", "--work", "0.01", "-o"]
WATERS = ["P02", "P05", "P07"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("paper") / "results"
    done = RUN.invoke(app, [*QUICK, str(folder), "--threads", "2"])
    assert done.exit_code == 0, done.output
    return folder, done.stdout


@pytest.fixture(scope="module")
def found(made):
    return json.loads((made[0] / "paper.json").read_text())


def test_all_files_and_no_others(made):
    folder, _ = made
    assert sorted(file.name for file in folder.iterdir()) == sorted(NAMES)
    assert (folder / "figure1.png").read_bytes().startswith(b"\x89PNG")
    assert b"<svg" in (folder / "single_element.svg").read_bytes()
    assert [file.name for file in folder.parent.iterdir()] == ["results"]


def test_the_screen_has_table_verdict_and_outcome(made):
    _, said = made
    for words in ("P02, day", "published", "cannot be built", "single-element", "c t / 2"):
        assert words in said


def test_six_depths_with_errors_and_residuals(found):
    for part in (found, found["flood"], found["apparent_depth"]):
        for sun in ("day", "night"):
            for name in WATERS:
                depth, published = part["depths"][sun][name], part["published"][sun][name]
                assert part["residual_percent"][sun][name] == pytest.approx(
                    100.0 * (depth / published - 1.0), abs=0.01
                )
                assert 0.0 < part["depths_sem_m"][sun][name] < 2.0
        six = [part["residual_percent"][sun][name] for sun in ("day", "night") for name in WATERS]
        assert part["rms_percent"] == pytest.approx(
            (sum(x * x for x in six) / 6.0) ** 0.5, rel=1e-4
        )


def test_receiver_and_curves(found):
    keys = {"aperture_radius_m", "filter_width_nm", "quantum_efficiency_assumed"}
    keys |= {"etendue_m2_sr", "background_counts_per_gate"}
    for part in (found, found["flood"]):
        assert keys <= set(part["receiver"])
        for name in WATERS:
            curves = part["curves"][name]
            assert {"0.001", "50"} <= set(curves["snr"])
            assert len(curves["snr"]) >= 5
            length = len(curves["depth_m"])
            lists = [curves["power_w"], curves["power_sem_w"], *curves["snr"].values()]
            assert {len(values) for values in lists} == {length}
            assert max(curves["depth_m"]) > 50.0


def test_curves_have_surface_column_and_bottom(found):
    """In P02 the spike, the decay and the bottom at 50 m stand out one after the other."""
    curves = found["curves"]["P02"]
    power = dict(zip(curves["depth_m"], curves["power_w"], strict=True))
    assert max(power, key=power.get) == pytest.approx(0.0, abs=0.2)
    assert power[5.125] > power[20.125] > power[40.125]
    assert power[50.125] > 5.0 * power[47.125]


def test_single_element(found):
    part = found["single_element"]
    assert len(part["sentences"]) == 2
    for name in WATERS:
        reached = {
            lidar: part[lidar][name]["limit_optical_depth"]["day"]
            for lidar in ("single_equal_pulse_energy", "matrix", "single_equal_energy_per_area")
        }
        assert reached["single_equal_pulse_energy"] > reached["matrix"]
        assert reached["matrix"] > reached["single_equal_energy_per_area"]


@pytest.mark.slow
def test_again_the_same_bytes_and_others_files_stay(made, tmp_path):
    """Over earlier results beside another file, on one thread."""
    folder, _ = made
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "paper.json").write_bytes((folder / "paper.json").read_bytes())
    (tmp_path / "figure1.png").write_text("of an earlier run")
    done = RUN.invoke(app, [*QUICK, str(tmp_path), "--threads", "1", "--quiet"])
    assert (done.exit_code, done.output) == (0, "")
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted([*NAMES, "notes.txt"])
    for name in NAMES:
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes(), name


def test_json_alone_on_standard_output(tmp_path, monkeypatch):
    empty = dict.fromkeys(NAMES, b"")
    monkeypatch.setattr("survey.paper.figures.pictures", lambda findings: empty)
    done = RUN.invoke(app, [*QUICK, str(tmp_path / "new"), "--json", "--seed", "7"])
    assert json.loads(done.stdout)["seed"] == 7
    assert "light of P02" in done.stderr


@pytest.mark.slow
def test_flights_join_the_results(tmp_path, monkeypatch):
    """By c z of the flooding matrix; what they reach comes on the screen and into paper.json."""
    row = dict.fromkeys(("snr_depth_m", "run_depth_m", "found_fraction"), 0.5)
    row |= dict.fromkeys(("false_bottom_fraction", "hidden_false_fraction"), 0.001)
    row |= dict.fromkeys(f"stitched_depth_{unit}" for unit in ("m", "c_z", "k_d_z"))
    asked = {}

    def fly_all(folder, *, limits, tell):
        tell("flight p05-flat-day")
        asked.update(folder=folder, limits=limits)
        return {"p05-flat-day": row}

    monkeypatch.setattr("survey.paper_flights.fly_all", fly_all)
    done = RUN.invoke(app, [*QUICK, str(tmp_path / "new"), "--flights"])
    assert done.exit_code == 0, done.output
    found = json.loads((tmp_path / "new/paper.json").read_text())
    assert found["flights"] == {"p05-flat-day": row}
    assert asked["folder"] == tmp_path / "new/flights"
    matrix = found["single_element"]["matrix"]["P05"]["limit_optical_depth"]
    assert asked["limits"]["P05"] == pytest.approx(matrix, rel=1e-5)
    assert "none" in done.stdout
    assert "0.10 %" in done.stdout


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--work", "0"], "--work 0: must lie in 0.01 to 100"),
        (["--work", "nan"], "--work nan: must lie in"),
        (["--work", "much"], "--work"),
        (["--seed", "-1"], "--seed"),
    ],
)
def test_bad_options(options, message, tmp_path):
    done = RUN.invoke(app, ["paper", "-o", str(tmp_path / "new"), *options])
    assert done.exit_code == 2
    assert message in done.stderr
    assert not (tmp_path / "new").exists()


def test_a_file_is_no_folder(tmp_path):
    file = tmp_path / "file"
    file.write_text("mine")
    for place in (file, file / "deeper"):
        done = RUN.invoke(app, [*QUICK, str(place)])
        assert (done.exit_code, file.read_text()) == (2, "mine")
        assert "is a file. Choose a folder" in done.stderr


@pytest.mark.parametrize("content", ["{}", "[]", "not JSON"])
def test_files_of_another_making_are_not_replaced(tmp_path, content):
    (tmp_path / "paper.json").write_text(content)
    (tmp_path / "figure1.png").write_text("mine")
    done = RUN.invoke(app, [*QUICK, str(tmp_path)])
    assert done.exit_code == 2
    assert "figure1.png, paper.json of another making" in done.stderr
    assert (tmp_path / "figure1.png").read_text() == "mine"
    assert (tmp_path / "paper.json").read_text() == content


def test_nothing_half_written_stays(tmp_path, monkeypatch):
    """A disk that fails half-way leaves the earlier results as they were, and no scraps."""
    from survey.paper import output

    whole = {name: name.encode() for name in NAMES}
    whole["paper.json"] = b'{"made_by": "bathyflash paper"}'
    output.write_results(tmp_path / "results", whole)

    def full(path, content):
        if path.name == "figure3.png":
            raise OSError(28, "No space left on device", str(path))
        path.write_bytes(content)

    monkeypatch.setattr(output, "write_whole", full)
    for place in (tmp_path / "results", tmp_path / "other"):
        with pytest.raises(OSError, match="No space"):
            output.write_results(place, dict.fromkeys(NAMES, b"new"))
    assert [path.name for path in tmp_path.iterdir()] == ["results"]
    assert sorted(path.name for path in (tmp_path / "results").iterdir()) == sorted(NAMES)
    assert all((tmp_path / "results" / name).read_bytes() == whole[name] for name in NAMES)

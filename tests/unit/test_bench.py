"""The benchmark's figures, with hardly any work."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from survey import bench, bench_scaling
from survey.cli import app
from survey.transport.settings import TransportSettings
from tests.benchmarks import kernels

RUN = CliRunner()
SMALL = {"camera.rows": 4, "camera.columns": 8}
FIGURES = {
    "seconds_per_frame",
    "error",
    "frames_per_second_at_5_percent",
    "frames_per_second_end_to_end",
    "ns_per_scattering",
    "memory_mb",
}


@pytest.fixture
def small_bench(monkeypatch):
    """One case of 32 pixels, 8 walks each, three flashes."""
    whole = bench.bench_scenario
    case = bench.Case(water="coastal", depth_m=10.0, walks_per_pixel=8)
    monkeypatch.setattr(bench, "CASES", {bench.MERIT_CASE: case})
    monkeypatch.setattr(bench, "FLASHES", 3)
    monkeypatch.setattr(
        bench, "bench_scenario", lambda case, **values: whole(case, **SMALL, **values)
    )


def test_json_has_every_case_and_what_it_was_measured_on(small_bench):
    done = RUN.invoke(app, ["bench", "--json", "--threads", "1"])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert set(found) == {"cases", "machine", "system", "threads", "versions"}
    assert found["threads"] == 1
    figures = found["cases"][bench.MERIT_CASE]
    assert set(figures) >= FIGURES
    assert all(np.isfinite(figures[name]) and figures[name] > 0.0 for name in FIGURES)


def test_merit_goes_with_its_case_alone(small_bench, monkeypatch):
    ratio = {"figure_of_merit_ratio": 2.0, "figure_of_merit_ratio_lower_95": 1.0}
    monkeypatch.setattr(bench, "figure_of_merit", lambda **_: ratio)
    plain, compared = (dict(bench.bench(threads=1, merit=merit)) for merit in (False, True))
    assert not set(ratio) & set(plain[bench.MERIT_CASE])
    assert ratio.items() <= compared[bench.MERIT_CASE].items()


def test_cases_have_whole_replicates():
    waters = {"clear 20 m", "coastal 10 m", "coastal 20 m", "harbor 4 m"}
    assert set(bench.CASES) == waters | {"coastal 10 m, waves"}
    replicates = TransportSettings().replicates
    assert all(case.walks_per_pixel % replicates == 0 for case in bench.CASES.values())


def test_gate_error_is_the_scatter_of_the_sum_in_the_gate():
    """Independent noise of 30 % in each of ten bins, the peak half as high again as the others."""
    pulse = np.where(np.abs(np.arange(60) - 29.5) < 5.0, 1.0, 0.0)
    pulse[30] = 1.5
    noise = np.random.default_rng(1).normal(1.0, 0.3, size=(400, 6, 6, 60))
    of_sum = 0.3 * np.sqrt((pulse**2).sum()) / pulse.sum()
    assert bench._gate_error(pulse * noise) == pytest.approx(of_sum, rel=0.03)


def test_exponent_is_that_of_the_power_law(monkeypatch):
    monkeypatch.setattr(bench_scaling, "_seconds", lambda size: 0.2 * size**0.7)
    row = bench_scaling._row("pixels", [512, 2048, 8192], [512, 2048, 8192])
    assert row["exponent"] == pytest.approx(0.7)
    assert row["sizes"] == [512, 2048, 8192]


def test_every_kernel_has_its_time(monkeypatch):
    """The script of `make bench`, with hardly any work: nanoseconds, none of them timed here."""
    for name in ("CALLS", "TRACKS", "PIXELS"):
        monkeypatch.setattr(kernels, name, 16)
    found = kernels.measured(repeats=1)
    assert len(found) == 7
    assert all(np.isfinite(time) and time > 0.0 for time in found.values())

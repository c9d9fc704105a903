"""The section [detector]: kinds, devices of the catalogue, gates, and every fault at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.scenario import components
from survey.scenario.detector_sections import (
    ApdDetector,
    IdealDetector,
    PmtDetector,
    SpadDetector,
)
from survey.scenario.faults import ScenarioError
from survey.scenario.scenario import Scenario, with_changes
from survey.sensor.apd import LinearApd
from survey.sensor.catalogue import devices
from survey.sensor.ideal import IdealCounter
from survey.sensor.pmt import Pmt
from survey.sensor.spad import Spad

SPAD = {
    "kind": "spad",
    "quantum_efficiency": 0.4,
    "dark_count_rate_hz": 100.0,
    "dead_time_ns": 50.0,
}
KEYS = {"spad": SpadDetector, "apd": ApdDetector, "pmt": PmtDetector}


def scenario(tables: dict[str, Any], **changes: Any) -> Scenario:
    changed = with_changes(tables, changes, name="reef.toml")
    return Scenario.from_tables(changed, name="reef.toml", folder=Path())


def faults_of(tables: dict[str, Any], **changes: Any) -> list[str]:
    with pytest.raises(ScenarioError) as caught:
        scenario(tables, **changes)
    return [line.removeprefix("reef.toml: detector.") for line in caught.value.lines]


def test_without_a_kind_the_counter_is_ideal(tables: dict[str, Any]) -> None:
    ideal = scenario(tables)
    assert isinstance(ideal.detector, IdealDetector)
    detector = components.detector(ideal)
    assert isinstance(detector, IdealCounter)
    assert (detector.pulses, detector.photo_electrons_per_photon) == (1, 0.2)


def test_a_spad_in_si_units(tables: dict[str, Any]) -> None:
    keys = {
        "fill_factor": 0.5,
        "afterpulse_probability": 0.01,
        "afterpulse_lifetime_ns": 40.0,
        "crosstalk_probability": 0.002,
        "timing_jitter_ps": 100.0,
        "pulses_per_frame": 30,
    }
    detector = components.detector(scenario(tables, detector=SPAD | keys))
    assert isinstance(detector, Spad)
    assert detector.dead_time == pytest.approx(50e-9)
    assert detector.afterpulse_lifetime == pytest.approx(40e-9)
    assert detector.jitter_sigma == pytest.approx(100e-12 / np.sqrt(8.0 * np.log(2.0)))
    assert detector.photo_electrons_per_photon == pytest.approx(0.2)
    assert (detector.dark_count_rate, detector.bin_width) == (100.0, pytest.approx(1e-9))
    (look,) = detector.looks
    assert (look.pulses, look.armed.shape, look.armed.all()) == (30, (1, 1, 300), True)
    assert not detector.keep_tags


def test_an_apd_and_a_photomultiplier_in_si_units(tables: dict[str, Any]) -> None:
    apd = components.detector(scenario(tables, **{"detector.device": "si-apd-300mhz"}))
    assert isinstance(apd, LinearApd)
    assert apd.bandwidth == pytest.approx(300e6)
    assert apd.amplifier_noise == pytest.approx(32e-12)
    assert (apd.gain, apd.pulses) == (100.0, 1)
    pmt = components.detector(
        scenario(tables, **{"detector.device": "pml-16-gaasp", "detector.pulses_per_frame": 4})
    )
    assert isinstance(pmt, Pmt)
    assert pmt.rc == pytest.approx(0.5e-9)
    assert pmt.transit_time_sigma == pytest.approx(180e-12 / 2.3548, rel=1e-4)
    assert pmt.pulses == 4


def test_gates_count_from_the_echo_of_the_level_sea(tables: dict[str, Any]) -> None:
    gates = {
        "surface_gate_open_ns": -10.0,
        "surface_gate_close_ns": 15.0,
        "bottom_gate_open_ns": 20.0,
        "bottom_gate_close_ns": 200.0,
    }
    both = components.detector(scenario(tables, detector=SPAD | gates))
    assert isinstance(both, Spad)
    (look,) = both.looks
    open_bins = np.flatnonzero(look.armed[0, 0])
    assert (open_bins[0], open_bins[-1]) == (20, 229)
    assert open_bins.size == 25 + 180
    shared = SPAD | gates | {"pulses_per_frame": 50, "surface_pulses": 10}
    apart = components.detector(scenario(tables, detector=shared | {"gates_follow_slant": True}))
    assert isinstance(apart, Spad)
    surface, bottom = apart.looks
    assert (surface.pulses, bottom.pulses) == (10, 40)
    assert surface.armed.shape == (32, 64, 300)
    camera = components.camera(scenario(tables))
    forward, right = camera.pixel_centres()
    slant_ns = 2e9 * 200.0 / 299_792_458.0 * (np.sqrt(1.0 + forward**2 + right**2) - 1.0)
    opened = surface.armed.argmax(axis=-1)
    assert np.abs(opened - 20 - slant_ns).max() <= 0.51
    assert slant_ns.max() > 50.0


def test_a_device_fills_in_what_is_not_given(tables: dict[str, Any]) -> None:
    del tables["detector"]
    bare = scenario(tables, detector={"device": "linospad2"}).detector
    assert isinstance(bare, SpadDetector)
    assert (bare.dark_count_rate_hz, bare.crosstalk_probability) == (125.0, 0.0022)
    own = scenario(tables, detector={"device": "linospad2", "dark_count_rate_hz": 7.0}).detector
    assert isinstance(own, SpadDetector)
    assert (own.dark_count_rate_hz, own.crosstalk_probability) == (7.0, 0.0022)


def test_a_resolved_scenario_reads_back_the_same(tables: dict[str, Any], tmp_path: Path) -> None:
    from survey.scenario.load import load_scenario

    for name in devices():
        chosen = scenario(tables, detector={"device": name})
        file = tmp_path / f"{name}.toml"
        file.write_text(chosen.to_toml(), encoding="utf-8")
        assert load_scenario(file).detector == chosen.detector


@pytest.mark.parametrize("name", devices())
def test_every_figure_of_the_catalogue_is_a_key_with_its_source(
    tables: dict[str, Any], name: str
) -> None:
    device = devices()[name]
    assert set(device.figures) <= set(KEYS[device.kind].model_fields)
    assert len(device.title) > 10
    for figure in device.figures.values():
        assert len(figure.source) >= len("assumed")
    detector = components.detector(scenario(tables, detector={"device": name}))
    assert 0.0 < detector.photo_electrons_per_photon <= 1.0


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        ({"kind": "sapd"}, ["kind: 'sapd' is not one of ideal, spad, apd, pmt."]),
        ({"quantum_efficiency": 1.2}, ["quantum_efficiency: 1.2 is out of bounds."]),
        ({"quantum_efficiency": 0.0}, ["quantum_efficiency: 0.0 is out of bounds."]),
        ({"dark_count_rate_hz": -1.0}, ["dark_count_rate_hz: -1.0 is out of bounds."]),
        ({"kind": "spad"}, ["dead_time_ns: missing."]),
        ({"pulses_per_frame": 0}, ["pulses_per_frame: 0 is out of bounds."]),
        (
            {"device": "linospad"},
            ["device: 'linospad' is not one of spad-64x32, linospad2, swissspad3, qvga-8um, "],
        ),
        ({"device": "linospad", "kind": "apd"}, ["gain: missing.", "bandwidth_mhz: missing."]),
        (
            {"device": "h12700", "kind": "spad"},
            ["dead_time_ns: missing.", "device: 'h12700': it is of kind pmt. Leave kind out"],
        ),
        ({"device": ""}, ["device: the text is empty."]),
        ({"device": ["a"]}, ["device: ['a'] is not text in quotes."]),
        ({"gain": 3.0}, ["gain: unknown key. It goes with kind = apd or pmt."]),
        (
            SPAD | {"dead_tim_ns": 3.0, "afterpulse_probability": 1.0, "fill_factor": 2.0},
            [
                "fill_factor: 2.0 is out of bounds.",
                "afterpulse_probability: 1.0 is out of bounds. It must be less than 1.",
                "dead_tim_ns: unknown key. Did you mean 'dead_time_ns'?",
            ],
        ),
        (SPAD | {"dead_time_ns": 0.0}, ["dead_time_ns: 0.0 is out of bounds."]),
        (
            SPAD | {"dead_time_ns": 2e9},
            ["dead_time_ns: 2e+09 is longer than the 1000000000 ns between pulses"],
        ),
        (
            SPAD | {"dead_time_ns": 2e4, "pulses_per_frame": 9},
            ["dead_time_ns: 20000 is longer than the 10000 ns between pulses"],
        ),
        (
            {"pulses_per_frame": 9, "burst_rate_hz": 1e6},
            ["burst_rate_hz: pulses follow each other after 1000 ns, but the gate closes at 1604"],
        ),
        (
            {"pulses_per_frame": 2000, "burst_rate_hz": 1e3},
            [
                "pulses_per_frame: the burst takes 2e+03 ms, in which the aircraft flies 200 m",
                "pulses_per_frame: the burst takes 2e+03 ms and the next one begins after 1e+03",
            ],
        ),
        (
            SPAD | {"bottom_gate_open_ns": 5.0, "surface_pulses": 3},
            [
                "bottom_gate: a gate needs both its open_ns and its close_ns.",
                "surface_pulses: pulses are shared out between a surface gate and a bottom gate.",
                "surface_pulses: 3 leave none of pulses_per_frame 1 for the bottom.",
            ],
        ),
        (
            SPAD | {"bottom_gate_open_ns": 5.0, "bottom_gate_close_ns": 5.5},
            ["bottom_gate_close_ns: 5.5 is less than a bin of 1 ns after bottom_gate_open_ns 5."],
        ),
        (
            SPAD | {"surface_gate_open_ns": -500.0, "surface_gate_close_ns": -400.0},
            ["surface_gate_open_ns: the gate from -500 to -400 ns holds no bin of the receiver"],
        ),
        ({"device": "c30902eh", "ionisation_ratio": 1.5}, ["ionisation_ratio: 1.5 is out of"]),
        ({"device": "h12700", "secondary_emission": 1.0}, ["secondary_emission: 1.0 is out of"]),
    ],
)
def test_faults_of_a_detector_come_all_at_once(
    tables: dict[str, Any], changes: dict[str, Any], lines: list[str]
) -> None:
    found = faults_of(tables, detector=tables["detector"] | changes)
    for line in lines:
        assert any(each.startswith(line) for each in found), (line, found)


def test_an_unknown_device_has_a_nearest_one(tables: dict[str, Any]) -> None:
    (line,) = faults_of(tables, **{"detector.device": "c30902"})
    assert line.endswith("Did you mean 'c30902eh'?")


def test_an_echo_gate_is_at_least_a_bin(tables: dict[str, Any]) -> None:
    with pytest.raises(ScenarioError, match=r"echo_gate_ns: 0.5 is shorter than a bin of 1 ns"):
        scenario(tables, **{"processing.echo_gate_ns": 0.5})

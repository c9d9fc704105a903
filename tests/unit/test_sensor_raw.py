"""Raw histograms and time tags in the frames' files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import Outcome
from survey.mission import fly_frame
from survey.preparation import Mission, prepare
from survey.products.frame_file import FrameResult, frame_bytes, read_frame, read_raw
from survey.scenario.scenario import Scenario

BURST = {
    "kind": "spad",
    "quantum_efficiency": 0.2,
    "dark_count_rate_hz": 1.0e4,
    "dead_time_ns": 20.0,
    "pulses_per_frame": 100,
}


@pytest.fixture
def small(tables: dict[str, Any]) -> Scenario:
    """One frame of 16 x 8 pixels at night, a burst of weak pulses over 5.5 m of water."""
    tables["flight"] |= {"frames_per_line": 1}
    tables["camera"] = {"rows": 8, "columns": 16}
    tables["laser"] = {"pulse_energy_j": 1e-4}
    tables["sun"] = {"day": False}
    tables["seabed"] = {"kind": "plane", "depth_m": 5.0}
    tables["detector"] = BURST
    return Scenario.from_tables(tables, name="reef.toml", folder=Path())


def flown(scenario: Scenario) -> tuple[Mission, FrameResult]:
    mission = prepare(scenario)
    return mission, fly_frame(mission, mission.frames[0])


def test_all_histograms_and_tags_come_back_and_agree(small: Scenario, tmp_path: Path) -> None:
    mission, result = flown(small.replace(**{"processing.keep_waveforms": "all"}))
    assert (result.record.outcome == Outcome.FOUND).mean() > 0.9
    (tmp_path / "frame.npz").write_bytes(frame_bytes(result))
    raw = read_raw(tmp_path / "frame.npz")
    assert raw is not None
    assert raw.counts.shape == (128, 300)
    assert float(raw.bin_width) == pytest.approx(1e-9)
    assert float(raw.bin_start) == mission.noise.bin_start
    assert raw.tag_time.size == raw.counts.sum() > 1000
    assert set(np.unique(raw.tag_pulse)) <= set(range(100))
    again = np.zeros((8, 16, 300), np.int64)
    place = np.minimum((raw.tag_time / np.float32(1e-9)).astype(int), 299)
    np.add.at(again, (raw.tag_row, raw.tag_column, place), 1)
    late = np.abs(again[raw.row, raw.column] - raw.counts).sum()
    assert late <= 2e-3 * raw.counts.sum()
    assert read_frame(tmp_path / "frame.npz").raw is None


def test_a_sample_is_one_pixel_in_8_x_8_and_nothing_is_kept_unasked(
    small: Scenario, tmp_path: Path
) -> None:
    _, plain = flown(small)
    assert plain.raw is None
    (tmp_path / "plain.npz").write_bytes(frame_bytes(plain))
    assert read_raw(tmp_path / "plain.npz") is None
    _, sampled = flown(small.replace(**{"processing.keep_waveforms": "sampled"}))
    assert sampled.raw is not None
    assert (sampled.raw.row.tolist(), sampled.raw.column.tolist()) == ([4, 4], [4, 12])
    assert set(sampled.raw.tag_column) <= {4, 12}
    assert sampled.raw.tag_time.size == sampled.raw.counts.sum()
    assert np.array_equal(sampled.bottom.position, plain.bottom.position)
    assert len(frame_bytes(sampled)) < 1.5 * len(frame_bytes(plain))


def test_a_current_has_histograms_and_no_tags(small: Scenario, tmp_path: Path) -> None:
    _, result = flown(
        small.replace(
            detector={"device": "c30902eh", "quantum_efficiency": 0.2, "dark_count_rate_hz": 1e4},
            laser={"pulse_energy_j": 1.0},
            **{"processing.keep_waveforms": "sampled"},
        )
    )
    (tmp_path / "frame.npz").write_bytes(frame_bytes(result))
    raw = read_raw(tmp_path / "frame.npz")
    assert raw is not None
    assert raw.counts.shape == (2, 300)
    assert raw.counts.dtype == np.float32
    assert raw.tag_time.size == 0


def test_a_spad_blinded_by_the_surface_says_saturated(small: Scenario) -> None:
    bright = small.replace(detector=BURST | {"dead_time_ns": 5000.0}, laser={"pulse_energy_j": 1.0})
    _, result = flown(bright)
    assert (result.record.outcome == Outcome.SATURATED).mean() > 0.99
    assert (result.record.detection_probability < 0.01).all()

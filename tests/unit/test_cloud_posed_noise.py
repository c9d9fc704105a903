"""What a tilted sensor expects of bottomless water is what the light engine says it sees."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from survey.cloud.points import Outcome
from survey.cloud.posed_noise import delayed
from survey.flight.pose import Pose
from survey.mission import fly_frame
from survey.preparation import Mission, prepare
from survey.scenario.scenario import Scenario

FloatArray = NDArray[np.float64]


@pytest.fixture(scope="module")
def bottomless(tmp_path_factory: pytest.TempPathFactory) -> Mission:
    """Sixteen by eight pixels over water whose bottom lies outside the gate."""
    tables = {
        "mission": {"title": "deep water"},
        "flight": {
            **{"start_easting_m": 500250.0, "start_northing_m": 6000750.0, "heading_deg": 40.0},
            "frames_per_line": 1,
        },
        "camera": {"rows": 8, "columns": 16, "pixel_footprint_m": 6.0},
        "receiver": {
            **{"aperture_radius_m": 0.005, "filter_width_nm": 1.0},
            **{"gate_start_ns": 1240.0, "bins": 400},
        },
        "detector": {"quantum_efficiency": 0.2, "dark_count_rate_hz": 1.0e4},
        "water": {"type": "coastal"},
        "surface": {"water_level_m": 0.0, "wind_speed_m_s": 6.0},
        "seabed": {"kind": "plane", "depth_m": 60.0, "margin_m": 300.0},
        "transport": {"walks_per_pixel": 512, "tracks_per_replicate": 4096},
    }
    folder = tmp_path_factory.mktemp("deep")
    return prepare(Scenario.from_tables(tables, name="deep.toml", folder=folder))


def turned(mission: Mission, *, roll: float, pitch: float, up: float = 0.0) -> Pose:
    """The first pose, turned by degrees and lifted by metres."""
    pose = mission.frames[0].pose
    return replace(
        pose,
        position=pose.position + np.array([0.0, 0.0, up]),
        roll=np.radians(roll),
        pitch=np.radians(pitch),
    )


def expected_and_seen(mission: Mission, pose: Pose) -> tuple[FloatArray, FloatArray]:
    """Light that the noise model expects and that some flashes have on average."""
    noise = mission.noise_at(pose)
    seen = np.mean([mission.engine.flash(pose=pose, frame=i).total for i in range(6)], axis=0)
    return noise.bottomless_light - noise.steady_light, seen


def test_level_flight_keeps_its_model(bottomless: Mission) -> None:
    for pose in (bottomless.frames[0].pose, turned(bottomless, roll=1e-4, pitch=0.0)):
        assert bottomless.noise_at(pose) is bottomless.noise


@pytest.mark.parametrize(
    ("roll", "pitch", "up"), [(4.0, 0.0, 0.0), (-3.0, 2.0, 0.0), (0.0, 0.0, -6.0), (2.0, 1.0, 5.0)]
)
def test_light_comes_when_and_as_strong_as_expected(
    bottomless: Mission, roll: float, pitch: float, up: float
) -> None:
    expected, seen = expected_and_seen(
        bottomless, turned(bottomless, roll=roll, pitch=pitch, up=up)
    )
    level = bottomless.noise.bottomless_light - bottomless.noise.steady_light
    apart = np.abs(expected.argmax(axis=-1) - seen.argmax(axis=-1))
    assert np.median(apart) <= 1.0
    assert np.abs(level.argmax(axis=-1) - seen.argmax(axis=-1)).max() > 5
    bins = np.arange(expected.shape[-1])
    after = (bins > seen.argmax(axis=-1)[..., None] + 15) & (seen > 0.05)
    assert (expected * after).sum() == pytest.approx((seen * after).sum(), rel=0.02)
    by_pixel = (expected * after).sum(axis=-1) / (seen * after).sum(axis=-1)
    assert 0.7 < np.percentile(by_pixel, 5) < np.percentile(by_pixel, 95) < 1.4


def test_the_surface_is_expected_no_weaker_than_it_comes(bottomless: Mission) -> None:
    pose = turned(bottomless, roll=4.0, pitch=0.0)
    expected, seen = expected_and_seen(bottomless, pose)
    ratio = expected.max(axis=-1) / seen.max(axis=-1)
    assert ratio.min() > 0.75
    assert np.median(ratio) == pytest.approx(1.0, abs=0.15)
    level = bottomless.noise.bottomless_light.max(axis=-1) / seen.max(axis=-1)
    assert np.median(np.abs(level - 1.0)) > 2.0 * np.median(np.abs(ratio - 1.0))


def test_a_tilted_flight_finds_the_bottom_without_false_ones(
    tables: dict[str, Any], tmp_path: Path
) -> None:
    tables["flight"] |= {"frames_per_line": 2, "speed_m_s": 60.0}
    tables["camera"] = {"rows": 8, "columns": 16, "pixel_footprint_m": 6.0}
    tables["receiver"] |= {"gate_start_ns": 1240.0, "bins": 420}
    tables["motion"] = {"roll_mean_deg": 8.0, "pitch_mean_deg": -3.0}
    tables["seabed"] = {"kind": "plane", "depth_m": 5.0}
    mission = prepare(Scenario.from_tables(tables, name="tilt.toml", folder=tmp_path))
    for frame in mission.frames:
        result = fly_frame(mission, frame)
        assert np.mean(result.record.outcome == Outcome.FOUND) > 0.98
        assert not (result.record.outcome == Outcome.FALSE_BOTTOM).any()
        errors = result.bottom.position[:, 2] - result.bottom.true_elevation
        assert abs(errors.mean()) < 0.15


def test_points_lie_where_navigation_says(tables: dict[str, Any], tmp_path: Path) -> None:
    tables["flight"] |= {"frames_per_line": 1}
    tables["camera"] = {"rows": 8, "columns": 16, "pixel_footprint_m": 6.0}
    tables["seabed"] = {"kind": "plane", "depth_m": 5.0}
    places = []
    for bias in (0.0, 0.4):
        tables["navigation"] = {"gnss_bias_east_m": bias, "gnss_bias_up_m": bias}
        mission = prepare(Scenario.from_tables(tables, name="bias.toml", folder=tmp_path))
        result = fly_frame(mission, mission.frames[0])
        found = result.record.outcome.ravel() == Outcome.FOUND
        places.append((result.bottom.position - result.bottom.truth)[found].mean(axis=0))
        assert result.record.true_depth == pytest.approx(5.5)
    assert places[1] - places[0] == pytest.approx([0.4, 0.0, 0.4], abs=0.03)


def test_delays_between_bins_share_the_light_out() -> None:
    light = np.zeros((1, 2, 8))
    light[..., 3] = 1.0
    late = delayed(light, np.array([[1.25, -2.0]]))
    assert late[0, 0].tolist() == [0.0, 0.0, 0.0, 0.0, 0.75, 0.25, 0.0, 0.0]
    assert late[0, 1].tolist() == [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]

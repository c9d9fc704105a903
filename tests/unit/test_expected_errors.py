"""Level bottoms: of which echoes a table is made, how deep it reaches, what brightness does."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr

from survey.cloud.bottom_search import ThresholdSearch
from survey.cloud.noise import NoiseModel, RangingSettings
from survey.expected_errors import LevelBottoms
from survey.flight.pose import Frame, Pose
from survey.mission import fly_frame
from survey.preparation import prepare
from survey.scenario.load import load_scenario
from survey.sensor.camera import Camera
from survey.sensor.ideal import IdealCounter
from survey.transport.waveforms import Waveforms, pulse_taps
from terrain.map_frame import MapFrame
from terrain.seabed import Seabed

START, WIDTH, BINS, SIGMA = 1300e-9, 1e-9, 700, 4e-9
LIGHT = 299_792_458.0
CAMERA = Camera(rows=8, columns=16, pixel_tangent=0.032, long_side="along")
COUNTER = IdealCounter(quantum_efficiency=1.0, dark_count_rate=0.0, max_counts_per_bin=10**8)
LATE = 0.5e-9
"""How much later than straight light a bottom's light comes [s]."""


def cosines() -> Any:
    """Return the cosines of the pixels' rays in air and in water."""
    forward, right = CAMERA.pixel_centres()
    square = forward**2 + right**2
    sine = square / (1.0 + square)
    return np.sqrt(1.0 - sine), np.sqrt(1.0 - sine / 1.34**2)


def pulses(time: Any, photons: float) -> Any:
    edges = START + WIDTH * np.arange(BINS + 1)
    return photons * np.diff(ndtr((edges - np.asarray(time)[..., None]) / SIGMA), axis=-1)


@dataclass(frozen=True)
class Bounces:
    """Stands for the engine: a surface, a bottom as deep as the seabed, and its second bounce."""

    seabed: Seabed
    deepest: float
    water = SimpleNamespace(refractive_index=1.34, group_index=1.36)

    def flash(self, *, pose: Pose, frame: int) -> Waveforms:
        air, wet = cosines()
        depth = -float(self.seabed.mesh.vertices[:, 2].min())
        once = 2.0 * depth * 1.36 / wet / LIGHT
        surface = 2.0 * pose.position[2] / air / LIGHT
        seen = 1e5 if depth <= self.deepest else 0.0
        bottom = pulses(surface + once + LATE, seen) + pulses(surface + 2.0 * once, 0.5 * seen)
        light = np.stack([pulses(surface, 1e5), np.zeros_like(bottom), bottom])
        return Waveforms(
            photo_electrons=light.astype(np.float32),
            variance=np.zeros(light.shape, np.float32),
            bin_start=START,
            bin_width=WIDTH,
            scatterings=0,
            ledger={},
        )


def level_bottoms(deepest: float) -> LevelBottoms:
    pose = Pose(position=np.array([0.0, 0.0, 200.0]), roll=0.0, pitch=0.0, heading=0.3)
    surface = pulses(2.0 * 200.0 / cosines()[0] / LIGHT, 1e5)
    noise = NoiseModel.build(
        settings=RangingSettings(false_alarm_rate=1e-3, gate=10e-9),
        detector=COUNTER,
        steady_light=0.02,
        bottomless_light=surface + 0.02,
        flash_variance=np.zeros(surface.shape),
        model_flashes=4,
        pulse=pulse_taps(sigma=SIGMA, width=WIDTH, pad=13),
        bin_start=START,
        bin_width=WIDTH,
    )
    return LevelBottoms(
        engine=lambda bed: Bounces(bed, deepest),  # type: ignore[arg-type, return-value]
        search=ThresholdSearch,
        noise=noise,
        frame=Frame(index=0, line=0, time=0.0, pose=pose),
        camera=CAMERA,
        level=0.0,
        map_frame=MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714),
    )


@pytest.mark.parametrize("deepest", [5.9, 20.0])
def test_a_table_is_made_of_light_that_touched_the_bottom_once(deepest: float) -> None:
    table = level_bottoms(deepest).expected_errors()
    too_deep = LATE * LIGHT / 1.36 / 2.0
    assert table.bias[1:] == pytest.approx(-too_deep, abs=0.01)
    assert table.bias_rim == pytest.approx(0.0, abs=0.01)
    assert deepest / 1.15 < table.depth[-1] < deepest + 2.0 * too_deep


def test_water_without_any_bottom_echo_has_no_table() -> None:
    assert level_bottoms(0.5).expected_errors().depth.tolist() == [0.0]


@pytest.mark.parametrize("reflectance", [0.05, 0.1, 0.4])
def test_bright_and_dark_beds_lie_at_the_same_depth_and_tell_what_they_are(
    reflectance: float,
) -> None:
    """Harbor water: of 0.084, 0.021 and -0.026 m all but a centimetre is taken off.

    Pixels at the edges of the view miss light from beyond it and tell a darker bed.
    """
    scenario = load_scenario("paper-p07").replace(
        {
            "camera.rows": 8,
            "camera.columns": 16,
            "laser.pulse_energy_j": 1.0 / 16.0,
            "receiver.bins": 220,
            "flight.frames_per_line": 1,
            "transport.walks_per_pixel": 512,
            "seabed": {"kind": "plane", "depth_m": 3.0, "reflectance": reflectance},
        }
    )
    mission = prepare(scenario)
    cloud = fly_frame(mission, mission.frames[0]).bottom
    error = cloud.position[:, 2] - cloud.true_elevation
    inside = (cloud.row % 7 > 0) & (cloud.column % 15 > 0)
    unheeded = mission.scattering().error_by_brightness(
        depth=np.array(3.0), reflectance=np.array(reflectance)
    )
    assert abs(unheeded) > 0.02
    assert error.mean() == pytest.approx(0.0, abs=0.01)
    assert np.mean(np.abs(error) <= cloud.tvu) > 0.9
    assert cloud.reflectance[inside].mean() == pytest.approx(reflectance, abs=0.004)

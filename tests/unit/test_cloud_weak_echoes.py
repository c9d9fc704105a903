"""Weak echoes and what would have made them strong."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr

from survey.cloud.bottom_search import ThresholdSearch
from survey.cloud.noise import NoiseModel, RangingSettings
from survey.cloud.points import Outcome, PointClass
from survey.cloud.ranging import bottom_detection_probability
from survey.cloud.truth import TrueTargets
from survey.cloud.weak_echoes import weak_causes
from survey.optics.water import WaterColumn, petzold_water
from survey.sensor.ideal import IdealCounter
from survey.transport.waveforms import pulse_taps

NS = 1e-9
SIGMA = 10.0 * NS / 2.3548
BINS = 120
CLEAR, HARBOR = (
    petzold_water(kind, refractive_index=1.34, group_index=1.36) for kind in ("clear", "harbor")
)
UNIFORM = WaterColumn.uniform(CLEAR)


def pulse(time: float, photons: float) -> Any:
    edges = np.arange(BINS + 1) * NS
    return photons * np.diff(ndtr((edges - time * NS) / SIGMA))


def model(light: Any) -> NoiseModel:
    return NoiseModel.build(
        settings=RangingSettings(false_alarm_rate=1e-3, gate=10.0 * NS),
        detector=IdealCounter(quantum_efficiency=0.2, dark_count_rate=0.0, max_counts_per_bin=999),
        steady_light=0.02,
        bottomless_light=light + 0.02,
        flash_variance=np.zeros(light.shape),
        model_flashes=4,
        pulse=pulse_taps(sigma=SIGMA, width=NS, pad=13),
        bin_start=0.0,
        bin_width=NS,
    )


def targets(depth: Any, reflectance: Any) -> TrueTargets:
    place = np.zeros((*depth.shape, 3))
    return TrueTargets(
        surface=place,
        normal=place,
        position=place,
        time=depth,
        water_path=1.02 * depth,
        depth=depth,
        classification=np.full(depth.shape, PointClass.BATHYMETRIC, np.uint8),
        reflectance=reflectance,
        substrate=np.zeros(depth.shape, np.uint8),
    )


def causes(bottom: Any, surface: Any, doubt: float = 0.0, **truth: Any) -> list[Outcome]:
    """Return the causes of one row of pixels, all of them too weak."""
    noise = model(surface)
    noise = replace(noise, bottom_threshold=noise.bottom_threshold + doubt)
    assert np.all(bottom_detection_probability(bottom=bottom, noise=noise) < 0.5)
    shape = bottom.shape[:2]
    found = weak_causes(
        outcome=np.full(shape, Outcome.TOO_DEEP, np.uint8),
        bottom=bottom,
        surface=surface,
        targets=targets(
            np.full(shape, truth.get("depth", 6.0)), np.full(shape, truth.get("reflectance", 0.1))
        ),
        water=truth.get("water", UNIFORM),
        search=ThresholdSearch(noise=noise, surface_time=np.zeros(shape)),
    )
    return [Outcome(cause) for cause in found[0]]


def test_a_dark_bottom_is_low_reflectance_and_a_bright_one_too_deep() -> None:
    dim = np.stack([pulse(80.0, 4.0), pulse(80.0, 0.4)])[None]
    nothing = np.zeros(dim.shape)
    assert causes(dim, nothing, reflectance=0.02) == [Outcome.LOW_REFLECTANCE, Outcome.TOO_DEEP]
    assert causes(dim, nothing, reflectance=0.3) == [Outcome.TOO_DEEP, Outcome.TOO_DEEP]


def test_a_bottom_within_the_glint_is_lost_in_it() -> None:
    dim = np.stack([pulse(45.0, 15.0), pulse(90.0, 4.0)])[None]
    glint = np.broadcast_to(pulse(40.0, 3000.0), dim.shape)
    assert causes(dim, glint) == [Outcome.GLINT, Outcome.TOO_DEEP]


def test_a_threshold_raised_for_doubt_is_no_glint() -> None:
    dim = pulse(80.0, 9.0)[None, None]
    assert causes(dim, np.zeros(dim.shape), doubt=20.0) == [Outcome.TOO_DEEP]
    assert causes(dim, pulse(10.0, 50.0)[None, None], doubt=20.0) == [Outcome.TOO_DEEP]


def test_only_layers_make_water_too_turbid_and_only_above_the_bottom() -> None:
    dim = np.stack([pulse(80.0, 2.0), pulse(80.0, 0.01)])[None]
    nothing = np.zeros(dim.shape)
    plume = UNIFORM.with_layer(HARBOR, top=2.0, bottom=5.0)
    assert causes(dim, nothing, water=plume) == [Outcome.TOO_TURBID, Outcome.TOO_DEEP]
    assert causes(dim, nothing, water=plume, depth=2.0) == [Outcome.TOO_DEEP] * 2
    assert causes(dim, nothing, water=WaterColumn.uniform(HARBOR)) == [Outcome.TOO_DEEP] * 2


def test_the_edge_lies_where_the_light_grows_as_stated() -> None:
    """Two layers by hand: exp(2 x 1.02 x 3 m x (K_harbor - K_clear)) more light."""
    from survey.optics.water.apparent import diffuse_attenuation

    plume = UNIFORM.with_layer(HARBOR, top=2.0, bottom=5.0)
    gain = np.exp(2.04 * 3.0 * (diffuse_attenuation(HARBOR) - diffuse_attenuation(CLEAR)))
    nothing = np.zeros((1, 1, BINS))
    photons = np.linspace(1.0, 30.0, 400)
    echoes = np.stack([pulse(80.0, each) for each in photons])[None]
    probability = bottom_detection_probability(bottom=echoes, noise=model(np.zeros(echoes.shape)))
    least = photons[np.searchsorted(probability[0], 0.5)]
    for share, cause in ((1.05, Outcome.TOO_TURBID), (0.95, Outcome.TOO_DEEP)):
        dim = pulse(80.0, share * least / gain)[None, None]
        assert causes(dim, nothing, water=plume) == [cause]


def test_other_outcomes_stay() -> None:
    kinds = np.array([[kind for kind in Outcome if kind != Outcome.TOO_DEEP]], np.uint8)
    shape = (*kinds.shape, BINS)
    light = np.zeros(shape)
    found = weak_causes(
        outcome=kinds,
        bottom=light,
        surface=light,
        targets=targets(np.full(kinds.shape, 3.0), np.full(kinds.shape, 0.01)),
        water=UNIFORM,
        search=ThresholdSearch(noise=model(light), surface_time=np.zeros(kinds.shape)),
    )
    assert np.array_equal(found, kinds)


@pytest.mark.parametrize("reflectance", [0.0, np.nan])
def test_no_reflectance_to_speak_of_is_no_error(reflectance: float) -> None:
    """A black bottom sends nothing back, at 0.1 neither as long as nothing is known of it."""
    dim = np.zeros((1, 1, BINS))
    assert causes(dim, dim, reflectance=reflectance) == [Outcome.TOO_DEEP]

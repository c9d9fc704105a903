"""Fit, limits, verdict and the single element, on light made up for the purpose."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from survey.paper import instrument
from survey.paper.depth_limit import limit_depth
from survey.paper.fit import Columns, fit, six_depths
from survey.paper.receiver import PaperReceiver
from survey.paper.single_element import EQUAL_AREA, EQUAL_PULSE, contenders, sight
from survey.paper.verdict import buildable, filter_shift, judge, spad_etendue
from survey.transport.response_walks import FLOOD, ISOLATED

DEPTH = np.arange(0.125, 90.0, 0.25)
ATTENUATION = {"P02": 0.14, "P05": 0.26, "P07": 0.55}
TRUE = PaperReceiver(aperture_radius=0.21, filter_width=3.7e-9)


def synthetic(noise=0.0, seed=4):
    """Columns that decay evenly, eight batches each."""
    chance = np.random.default_rng(seed)
    return Columns(
        depth=DEPTH,
        batches={
            name: 1e-3
            * np.exp(-2.0 * k * DEPTH)
            * (1.0 + noise * chance.standard_normal((8, len(DEPTH))))
            for name, k in ATTENUATION.items()
        },
    )


@pytest.mark.parametrize("reading", [1.0, 1.33])
def test_fit_finds_the_receiver_again(monkeypatch, reading):
    """Depths computed from a known receiver give it back to 0.1 %."""
    columns = synthetic()
    truth = six_depths(TRUE, columns.mean(), DEPTH, reading=reading)
    monkeypatch.setattr(instrument, "PUBLISHED", truth)
    found = fit(columns, reading=reading)
    assert found.receiver.aperture_radius == pytest.approx(TRUE.aperture_radius, rel=1e-3)
    assert found.receiver.filter_width == pytest.approx(TRUE.filter_width, rel=1e-3)
    assert found.rms < 1e-5


def test_errors_of_depths_are_those_of_repetition(monkeypatch):
    """The jackknife's errors are the scatter of 30 whole repetitions, within 25 %."""
    truth = six_depths(TRUE, synthetic().mean(), DEPTH)
    monkeypatch.setattr(instrument, "PUBLISHED", truth)
    fits = [fit(synthetic(noise=0.03, seed=seed)) for seed in range(30)]
    ratios = []
    for sun, waters in truth.items():
        for name in waters:
            scatter = np.std([found.depths[sun][name] for found in fits], ddof=1)
            stated = np.mean([found.errors[sun][name] for found in fits])
            ratios.append(stated / scatter)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.25)
    radii = [found.receiver.aperture_radius for found in fits]
    stated = np.mean([found.radius_error for found in fits])
    assert stated == pytest.approx(np.std(radii, ddof=1), rel=0.6)


def test_limit_depth_below_a_spike():
    """The first fall below 10 after the peak counts, later echoes do not."""
    snr = np.array([1.0, 1e4, 1e2, 1.0, 1e3, 1.0])
    assert limit_depth(depth=np.arange(6.0), snr=snr) == pytest.approx(2.5)
    assert limit_depth(depth=np.arange(3.0), snr=np.array([1.0, 2.0, 1.0])) == 0.0
    assert limit_depth(depth=np.arange(3.0), snr=np.full(3, 99.0)) == 2.0


def test_limit_by_hand():
    """Night: n_s = 10 and a little more, so exp(-2 k z) counts are solved by hand."""
    k, receiver = 0.14, TRUE
    at_0 = float(receiver.signal_rate(np.array(1e-3))) * 10e-9
    sun = receiver.background_rate(1e-3) * 10e-9
    needed = 5.0 + math.sqrt(25.0 + 10.0 * sun)
    expected = math.log(at_0 / needed) / (2.0 * k)
    found = six_depths(receiver, synthetic().mean(), DEPTH)["night"]["P02"]
    assert found == pytest.approx(expected, abs=1e-3)


def test_background_by_hand():
    """Equations (1) and (8): 50 W/(m2 um sr), 0.35 m, 2.5 nm, 6.4e-5 sr, eta 0.3, in 10 ns."""
    receiver = PaperReceiver(aperture_radius=0.35, filter_width=2.5e-9)
    photon = 6.62607015e-34 * 299792458.0 / 532e-9
    expected = 0.3 * 50.0 * 2.5e-3 * math.pi * 0.35**2 * 6.4e-5 / photon * 10e-9
    assert receiver.background_rate(50.0) * 10e-9 == pytest.approx(expected, rel=1e-9)


def test_verdict_on_two_receivers():
    """The digest's receiver takes in some ten thousand times too much; the other just enough."""
    spike = {"P02": np.array([1e-2])}
    impossible = judge(PaperReceiver(aperture_radius=0.35, filter_width=2.5e-9), surface=spike)
    assert 1.0e4 < impossible.etendue_ratio < 1.5e4
    assert impossible.filter_shift == pytest.approx(5e-9, rel=0.05)
    assert impossible.sun_per_gate == pytest.approx(2.47e4, rel=0.01)
    assert not impossible.can_exist
    assert "cannot be built" in impossible.sentences()[0]
    assert buildable().etendue == pytest.approx(spad_etendue(), rel=1e-12)
    dim = PaperReceiver(aperture_radius=1e-4, filter_width=6e-9)
    assert judge(dim, surface=spike).can_exist
    assert filter_shift(0.0) == 0.0


def made_light(illumination_gain):
    """Light of a water in which bottoms fade by exp(-c z), the column being next to nothing."""
    attenuation, sweep = 0.5, np.linspace(1.0, 60.0, 60)
    echo = 1e-4 * np.exp(-attenuation * sweep)
    both = np.stack([illumination_gain * echo, echo])
    return SimpleNamespace(
        water=SimpleNamespace(attenuation=attenuation),
        depth=DEPTH,
        column=np.full((4, 2, len(DEPTH)), 1e-30),
        sweep_depth=sweep,
        sweep_peak=np.repeat(both[None], 4, axis=0),
    )


def test_energy_buys_depth_as_it_must():
    """In the sun the ratio goes with the echo squared: 2,048 times the light, ln 2048 in c z."""
    rivals = contenders(TRUE)
    assert (rivals[EQUAL_PULSE].energy, rivals[EQUAL_AREA].energy) == (2048.0, 1.0)
    assert rivals[EQUAL_PULSE].illumination == rivals[EQUAL_AREA].illumination == ISOLATED
    assert rivals["matrix"].illumination == FLOOD
    light = made_light(5.0)
    limits = {name: sight(light, rival).limit["day"] for name, rival in rivals.items()}
    assert limits[EQUAL_PULSE] - limits[EQUAL_AREA] == pytest.approx(math.log(2048.0), rel=0.01)
    assert limits["matrix"] - limits[EQUAL_AREA] == pytest.approx(math.log(5.0), rel=0.01)
    assert sight(light, rivals["matrix"]).even is None


def test_a_bright_column_hides_the_bottom():
    light = made_light(1.0)
    light.column[:] = 1e-8
    found = sight(light, contenders(TRUE)[EQUAL_AREA])
    assert found.even == pytest.approx(math.log(1e4), rel=0.01)
    assert (
        found.limit["night"] < sight(made_light(1.0), contenders(TRUE)[EQUAL_AREA]).limit["night"]
    )

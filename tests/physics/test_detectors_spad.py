"""The SPAD array against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr
from scipy.stats import chi2

from survey.sensor.detector import TimeTags
from survey.sensor.spad import Look, Spad

FloatArray = NDArray[np.float64]
NS = 1e-9


def spad(bins: int, *, pulses: int = 1, **changes: Any) -> Spad:
    """A SPAD that detects 30 % without any effect but dead time; bins of 1 ns."""
    values: dict[str, Any] = {
        "quantum_efficiency": 0.3,
        "fill_factor": 1.0,
        "dark_count_rate": 0.0,
        "dead_time": 20.0 * NS,
        "afterpulse_probability": 0.0,
        "afterpulse_lifetime": 30.0 * NS,
        "crosstalk_probability": 0.0,
        "jitter_sigma": 0.0,
        "max_counts_per_bin": 1 << 30,
        "bin_width": NS,
        "looks": (Look(armed=np.ones((1, 1, bins), np.bool_), pulses=pulses),),
    }
    return Spad(**(values | changes))


def counts_of(array: Spad, light: FloatArray, seed: int = 1) -> NDArray[np.int32]:
    counts: NDArray[np.int32] = array.read(light, np.random.default_rng(seed)).counts
    return counts


def tags_of(array: Spad, light: FloatArray) -> TimeTags:
    tags = array.read(light, np.random.default_rng(1)).tags
    assert tags is not None
    return tags


def echo(centre: float, photons: float, bins: int = 120) -> FloatArray:
    edges = np.arange(bins + 1.0)
    return np.asarray(photons * np.diff(ndtr((edges - centre) / 4.25)))


@pytest.mark.parametrize("rate", [0.01, 0.05, 0.5, 1e3, 1e6])
@pytest.mark.parametrize("dead_time", [2.5, 20.0])
def test_dead_time_leaves_r_over_1_plus_r_tau(rate: float, dead_time: float) -> None:
    """Counts settle to r / (1 + r tau), and the interval between them is at least tau."""
    start, bins, pixels = 500, 2500, 200
    array = spad(bins, dead_time=dead_time * NS)
    counts = counts_of(array, np.full((10, 20, bins), rate))[..., start:].sum(axis=-1)
    wanted = (bins - start) * rate / (1.0 + rate * dead_time)
    scatter = np.sqrt(wanted / (1.0 + rate * dead_time) ** 2 / pixels)
    assert abs(counts.mean() - wanted) < 4.0 * scatter + 0.5
    mean = array.mean(np.full((1, 1, bins), rate))[..., start:].sum()
    assert mean == pytest.approx(wanted, rel=3e-3)


def test_counts_of_a_pixel_keep_the_dead_time() -> None:
    array = spad(300, keep_tags=True, pulses=20)
    tags = tags_of(array, np.full((3, 4, 300), 0.2))
    order = np.lexsort((tags.time, tags.pulse, tags.column, tags.row))
    row, column, pulse, time = (
        part[order] for part in (tags.row, tags.column, tags.pulse, tags.time)
    )
    same = (np.diff(row) == 0) & (np.diff(column) == 0) & (np.diff(pulse) == 0)
    gaps = np.diff(time)[same]
    assert gaps.min() >= 19.99 * NS
    assert gaps.mean() == pytest.approx(25.0 * NS, rel=0.02)


@pytest.mark.parametrize("photons", [0.2, 3.0, 1e6])
def test_first_photons_pile_up_at_the_front(photons: float) -> None:
    """Dead beyond the gate: P(bin k) = exp(-n_0 - ... - n_(k-1)) [1 - exp(-n_k)]."""
    light = echo(60.0, photons) + 0.002
    array = spad(120, dead_time=1e-6, pulses=100)
    counts = counts_of(array, np.broadcast_to(light, (20, 20, 120))).sum(axis=(0, 1))
    before = np.concatenate([[0.0], np.cumsum(light)[:-1]])
    wanted = 100 * 400 * np.exp(-before) * -np.expm1(-light)
    mean = array.mean(light[None, None])[0, 0]
    assert mean == pytest.approx(wanted / 400, rel=1e-7, abs=1e-12)
    some = wanted > 10.0
    statistic = np.sum((counts[some] - wanted[some]) ** 2 / wanted[some])
    assert statistic < chi2.isf(1e-4, some.sum())
    assert abs(counts[~some].sum() - wanted[~some].sum()) < 5.0 * np.sqrt(wanted[~some].sum() + 1)


@pytest.mark.parametrize(
    "effects",
    [
        {"dead_time": 1.1 * NS},
        {"dead_time": 20.0 * NS},
        {"dead_time": 50.4 * NS, "afterpulse_probability": 0.05},
        {"dead_time": 20.0 * NS, "crosstalk_probability": 0.02},
        {"dead_time": 8.0 * NS, "jitter_sigma": 2.0 * NS},
    ],
)
def test_mean_counts_are_those_of_the_avalanches(effects: dict[str, float]) -> None:
    """Per bin, pooled over pixels and pulses, behind a strong echo and before a weak one."""
    light = echo(40.0, 300.0) + echo(95.0, 0.5) + 0.01
    array = spad(120, pulses=100, **effects)
    full = np.broadcast_to(light, (16, 16, 120)).copy()
    counts = counts_of(array, full).sum(axis=(0, 1))
    wanted = array.mean(full).sum(axis=(0, 1))
    excess = (counts - wanted) / np.sqrt(wanted + 1.0)
    assert np.abs(excess).max() < 5.0
    assert counts.sum() == pytest.approx(wanted.sum(), rel=4e-3)


@pytest.mark.parametrize("probability", [0.05, 0.4])
def test_afterpulses_make_clusters_of_1_over_1_minus_p(probability: float) -> None:
    """Cluster sizes are geometric: mean 1 / (1 - p), variance over mean square p."""
    light = np.zeros((40, 50, 800))
    light[..., 0] = 1e6
    array = spad(
        800,
        dead_time=1.5 * NS,
        afterpulse_probability=probability,
        afterpulse_lifetime=10.0 * NS,
    )
    sizes = np.concatenate([counts_of(array, light, seed).sum(axis=-1) for seed in range(20)])
    mean, variance = 1.0 / (1.0 - probability), probability / (1.0 - probability) ** 2
    assert abs(sizes.mean() - mean) < 4.0 * np.sqrt(variance / sizes.size)
    assert sizes.var() == pytest.approx(variance, rel=0.05)
    assert (sizes == 1).mean() == pytest.approx(1.0 - probability, abs=0.01)
    poisson_clusters = (variance + mean**2) / mean
    widened = 1.0 + array.scatter(light[:1, :1], light[:1, :1]).gain_variance.max()
    assert widened == pytest.approx(poisson_clusters)


def test_afterpulses_come_exponentially_late_after_the_dead_time() -> None:
    light = np.zeros((40, 50, 400))
    light[..., 0] = 1e6
    array = spad(400, afterpulse_probability=0.3, afterpulse_lifetime=30.0 * NS, pulses=10)
    counts = counts_of(array, light).sum(axis=(0, 1))
    assert counts[0] == 20_000
    assert counts[1:20].sum() == 0
    first = 20_000 * 0.3 * np.exp(-np.arange(0.0, 19.0) / 30.0) * -np.expm1(-1.0 / 30.0)
    assert np.all(np.abs(counts[20:39] - first) < 5.0 * np.sqrt(first) + 5.0)


def test_crosstalk_sets_off_the_four_nearest_neighbours() -> None:
    probability, fired = 0.05, 200_000
    light = np.zeros((5, 5, 3))
    light[2, 2, 1] = 1e6
    counts = counts_of(spad(3, crosstalk_probability=probability, pulses=fired), light)
    sums = counts.sum(axis=-1) / fired
    error = 5.0 * np.sqrt(probability / fired)
    assert sums[2, 2] == 1.0
    for row, column in ((1, 2), (3, 2), (2, 1), (2, 3)):
        assert abs(sums[row, column] - probability) < error + probability**3 * 4.0
    assert abs(sums[1, 1] - 2.0 * probability**2) < error
    assert sums[0, 0] < 1e-3


def test_crosstalk_on_a_dead_pixel_is_lost() -> None:
    light = np.zeros((4, 4, 60))
    light[..., 1] = 1e6
    light[:2, :, 30] = 1e6
    array = spad(60, crosstalk_probability=0.2, dead_time=40.0 * NS, pulses=50)
    counts = counts_of(array, light)
    assert counts[..., 1].sum() == 16 * 50
    assert counts.sum() == 16 * 50


def test_jitter_scatters_the_time_and_nothing_else() -> None:
    light = np.zeros((20, 20, 61))
    light[..., 30] = 0.1
    array = spad(61, jitter_sigma=1.7 * NS, dead_time=1e-6, pulses=200, keep_tags=True)
    tags = tags_of(array, light)
    assert tags.time.mean() == pytest.approx(30.5 * NS, abs=0.15 * NS)
    wanted = np.hypot(1.7, 1.0 / np.sqrt(12.0)) * NS
    assert tags.time.std() == pytest.approx(wanted, rel=4.0 / np.sqrt(2.0 * tags.time.size))
    counts = array.read(light, np.random.default_rng(1)).counts
    assert counts.sum() == tags.time.size
    place = (tags.row, tags.column, (tags.time / NS).astype(int))
    again = np.zeros_like(counts)
    np.add.at(again, place, 1)
    assert np.array_equal(again, counts)


def test_a_better_spad_detects_all_that_a_worse_one_detects() -> None:
    """Same random numbers, no dead time: every count of 20 % is among those of 50 %."""
    photons = np.random.default_rng(2).gamma(0.5, 4.0, (6, 7, 80))
    arrays = [
        spad(80, quantum_efficiency=efficiency, dead_time=0.0, pulses=3, keep_tags=True)
        for efficiency in (0.2, 0.5)
    ]
    tags = [tags_of(array, photons * array.quantum_efficiency) for array in arrays]
    worse, better = (
        set(zip(t.row, t.column, t.pulse, np.round(t.time / NS, 3), strict=True)) for t in tags
    )
    assert len(worse) > 3000
    assert worse < better
    assert len(better) / len(worse) == pytest.approx(2.5, rel=0.05)


@pytest.mark.parametrize("efficiency", [0.1, 1.0])
def test_thinned_photons_stay_poisson(efficiency: float) -> None:
    light = np.full((40, 40, 50), 2.0)
    counts = counts_of(spad(50, quantum_efficiency=efficiency, dead_time=0.0), light)
    assert counts.mean() == pytest.approx(2.0, abs=4.0 * np.sqrt(2.0 / counts.size))
    assert counts.var() / counts.mean() == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / counts.size))
    both = np.corrcoef(counts[..., :-1].ravel(), counts[..., 1:].ravel())[0, 1]
    assert abs(both) < 4.0 / np.sqrt(counts.size)


def test_a_gate_keeps_the_surface_from_blinding_the_bottom() -> None:
    light = np.broadcast_to(echo(30.0, 1e5) + echo(90.0, 0.5), (8, 8, 120)).copy()
    open_array = spad(120, dead_time=1e-6, pulses=50)
    blinded = open_array.read(light, np.random.default_rng(1))
    assert blinded.counts[..., 60:].sum() == 0
    assert blinded.blind[..., 60:].all()
    armed = [np.zeros((1, 1, 120), np.bool_) for _ in range(2)]
    armed[0][..., 10:50] = True
    armed[1][..., 60:120] = True
    looks = (Look(armed=armed[0], pulses=10), Look(armed=armed[1], pulses=40))
    gated = spad(120, dead_time=1e-6, looks=looks)
    readings = gated.read(light, np.random.default_rng(1))
    assert readings.counts[..., :50].sum() == 64 * 10
    assert readings.counts[..., 50:60].sum() == 0
    wanted = 64 * 40 * -np.expm1(-0.5)
    assert abs(readings.counts[..., 60:].sum() - wanted) < 4.0 * np.sqrt(wanted)
    assert not readings.blind[..., 80:90].any()
    assert readings.blind[..., 40:50].all()
    assert gated.mean(light).sum() == pytest.approx(640 + wanted, rel=1e-3)


def test_nothing_fires_while_the_gate_is_closed() -> None:
    light = np.zeros((6, 6, 100))
    light[..., 10] = 1e6
    armed = np.zeros((6, 6, 100), np.bool_)
    armed[..., :40] = True
    effects = {"afterpulse_probability": 0.5, "crosstalk_probability": 0.2}
    array = spad(100, dead_time=5.0 * NS, looks=(Look(armed=armed, pulses=50),), **effects)
    counts = counts_of(array, light)
    assert counts[..., 15:40].sum() > 500
    assert counts[..., 40:].sum() == 0
    assert array.mean(light)[..., 40:].sum() == 0.0


def test_a_full_counter_is_blind() -> None:
    array = spad(30, dead_time=2.0 * NS, pulses=30, max_counts_per_bin=5)
    readings = array.read(np.full((2, 2, 30), 5.0), np.random.default_rng(1))
    assert readings.counts.max() == 5
    assert readings.blind[readings.counts == 5].all()


def test_same_generator_same_counts_with_and_without_tags() -> None:
    light = np.full((4, 5, 60), 0.3)
    effects: dict[str, Any] = {
        "afterpulse_probability": 0.3,
        "crosstalk_probability": 0.1,
        "jitter_sigma": 0.2 * NS,
        "pulses": 5,
    }
    plain = counts_of(spad(60, **effects), light)
    array = spad(60, **effects, keep_tags=True)
    assert np.array_equal(counts_of(array, light), plain)
    assert tags_of(array, light).time.size == plain.sum()
    assert not np.array_equal(counts_of(spad(60, **effects), light, seed=2), plain)

"""Water in layers: what must hold exactly, and light of single layers against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from survey.optics.water import WaterColumn, petzold_water
from survey.transport.layers import bend_at, crossed, free_path, kernel_layers
from tests.physics.conftest import level_pose

INDEX = 1.33


def petzold(name, **changes):
    return petzold_water(name, refractive_index=INDEX, group_index=INDEX, **changes)


THREE = (
    WaterColumn.uniform(petzold("coastal"))
    .with_layer(petzold("harbor"), top=4.0, bottom=5.0)
    .with_layer(petzold("clear"), top=5.0)
)


def summed(engine, flashes, origin):
    """Return photo-electrons (flashes, bins), all pixels pooled."""
    pose = level_pose()
    return np.array(
        [
            engine.flash(pose=pose, frame=frame).origin(origin).sum(axis=(0, 1), dtype=float)
            for frame in range(flashes)
        ]
    )


@pytest.mark.parametrize(
    ("whole", "top", "bottom", "apart", "layers"),
    [
        (WaterColumn.uniform(petzold("coastal")), 0.0, math.inf, 1.0, 10),
        (THREE, 4.0, 5.0, 0.1, 12),
    ],
    ids=["uniform water", "turns that differ by depth"],
)
def test_a_layer_split_in_ten_changes_nothing(engine_of, whole, top, bottom, apart, layers):
    """The same walks in the same water: equal to the rounding of single precision."""
    split = whole
    for part in range(1, 10):
        split = split.with_layer(whole.at(top), top=top + apart * part, bottom=bottom)
    assert len(split.layers) == layers
    pose = level_pose()
    light = [
        engine_of(column=column, shape=(4, 8)).flash(pose=pose, frame=3).photo_electrons
        for column in (whole, split)
    ]
    assert light[1] == pytest.approx(light[0], rel=1e-4, abs=1e-6 * float(light[0].max()))


def test_absorbing_layers_dim_the_bottom_like_their_mean(engine_of):
    """Without scattering every ray crosses all layers at one angle: exp of the whole."""
    clear = petzold("clear", absorption=0.05, scattering=0.0)
    layers = WaterColumn.uniform(clear).with_layer(replace(clear, absorption=0.4), top=7.0)
    mean = WaterColumn.uniform(replace(clear, absorption=(7.0 * 0.05 + 3.0 * 0.4) / 10.0))
    pose = level_pose()
    light = [
        engine_of(column=column, shape=(4, 8), depth=10.0)
        .flash(pose=pose, frame=3)
        .origin("bottom")
        for column in (layers, mean)
    ]
    assert light[0].sum() > 0.0
    assert light[0] == pytest.approx(light[1], rel=1e-5)


@pytest.mark.parametrize("sinking", [1.0, 0.3, -0.6, 1e-9, -1e-9])
@pytest.mark.parametrize("depth", [0.0, 3.9, 4.5, 8.0])
def test_free_paths_have_the_optical_length_that_was_drawn(sinking, depth):
    """Against coefficients summed up in small steps along the way."""
    layers = kernel_layers(THREE)
    length = free_path(layers, depth, sinking, 0.7)
    way = (np.arange(200_000) + 0.5) / 200_000 * length
    layer = np.searchsorted([0.0, 4.0, 5.0], depth + sinking * way, side="right") - 1
    layer = np.maximum(layer, 0)
    assert np.mean(layers.scattering[layer]) * length == pytest.approx(0.7, rel=1e-3)
    for name, to_top in (("scattering", "scattered"), ("absorption", "absorbed")):
        found = crossed(
            layers, getattr(layers, name), getattr(layers, to_top), depth, sinking, length
        )
        plain = np.mean(getattr(layers, name)[layer]) * length
        assert found == pytest.approx(plain, rel=1e-3)


def test_light_turns_by_the_water_where_it_scatters():
    """Chances of a turn within 10 degrees are those of the layer's own phase function."""
    layers = kernel_layers(THREE)
    within = np.radians(10.0)
    for depth in (1.0, 4.5, 30.0):
        share = THREE.at(depth).phase_function.fraction_within(within)
        bend = bend_at(layers, depth, share)
        assert bend == pytest.approx(1.0 - np.cos(within), rel=1e-3)


def test_turns_looked_up_on_the_way_do_as_those_drawn_before(engine_of):
    """Uniform water whose two halves have a table each: 4 standard errors of pooled light."""
    coastal = petzold("coastal")
    twice = WaterColumn.uniform(coastal).with_layer(
        replace(coastal, phase_function=petzold("coastal").phase_function), top=3.0
    )
    assert len(twice.phase_functions) == 2
    for origin in ("column", "bottom"):
        pairs = [
            summed(engine_of(column=column, shape=(8, 16), seed=seed), 24, origin).sum(axis=1)
            for column, seed in ((WaterColumn.uniform(coastal), 1), (twice, 2))
        ]
        spread = np.hypot(*(light.std(ddof=1) / 24**0.5 for light in pairs))
        assert spread < 0.01 * pairs[0].mean()
        assert abs(pairs[0].mean() - pairs[1].mean()) < 4.0 * spread

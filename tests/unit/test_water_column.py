"""Water in layers and continuous profiles: its integrals by depth."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from survey.optics.phase import average_particle, henyey_greenstein
from survey.optics.water import Layer, WaterColumn, petzold_water, profiled_water
from survey.optics.water.apparent import diffuse_attenuation
from survey.optics.water.column import FINEST_STEP

CLEAR, COASTAL, HARBOR = (
    petzold_water(kind, refractive_index=1.34, group_index=1.36)
    for kind in ("clear", "coastal", "harbor")
)
DEPTHS = np.array([0.0, 1.0, 4.0, 4.5, 6.0, 7.0, 30.0])
TURBID = WaterColumn.uniform(CLEAR).with_layer(HARBOR, top=4.0, bottom=6.0)


def test_optical_depths_add_up_layer_by_layer() -> None:
    inside = np.clip(DEPTHS - 4.0, 0.0, 2.0)
    for found, clear, harbor in (
        (TURBID.absorbed(DEPTHS), 0.114, 0.366),
        (TURBID.scattered(DEPTHS), 0.037, 1.824),
        (TURBID.attenuated(DEPTHS), 0.151, 2.190),
        (
            TURBID.integral(DEPTHS, diffuse_attenuation),
            diffuse_attenuation(CLEAR),
            diffuse_attenuation(HARBOR),
        ),
    ):
        assert found == pytest.approx(clear * (DEPTHS - inside) + harbor * inside, rel=1e-12)
    mean = TURBID.mean(7.0)
    assert 7.0 * mean.scattering == pytest.approx(float(TURBID.scattered(7.0)))
    assert mean.phase_function is HARBOR.phase_function


def test_a_layer_split_in_ten_changes_no_integral_and_no_water() -> None:
    split = TURBID
    for top, bottom in pairwise(np.linspace(4.0, 6.0, 11)):
        split = split.with_layer(HARBOR, top=float(top), bottom=float(bottom))
    assert len(split.layers) == 12
    assert split.absorbed(DEPTHS) == pytest.approx(TURBID.absorbed(DEPTHS), rel=1e-12)
    assert split.scattered(DEPTHS) == pytest.approx(TURBID.scattered(DEPTHS), rel=1e-12)
    assert all(split.at(depth) is TURBID.at(depth) for depth in DEPTHS)


def test_layers_replace_what_they_cover_in_any_order() -> None:
    below_first = WaterColumn.uniform(CLEAR).with_layer(COASTAL, top=6.0)
    both = below_first.with_layer(HARBOR, top=0.0, bottom=2.0)
    above_first = WaterColumn.uniform(CLEAR).with_layer(HARBOR, top=0.0, bottom=2.0)
    assert above_first.with_layer(COASTAL, top=6.0) == both
    assert [both.at(z) for z in (0.0, 1.9, 2.0, 6.0, 99.0)] == [
        HARBOR, HARBOR, CLEAR, COASTAL, COASTAL,
    ]  # fmt: skip
    assert both.surface is HARBOR
    assert not both.is_uniform
    meeting = both.with_layer(CLEAR, top=2.0, bottom=6.0)
    assert [layer.top for layer in meeting.layers] == [0.0, 2.0, 6.0]


def test_profiles_integrate_exactly_at_every_slice() -> None:
    depth, absorption, scattering = (
        [0.0, 3.0, 10.0, 12.0],
        [0.1, 0.1, 0.2, 0.2],
        [0.0, 1.0, 0.1, 2.0],
    )
    column = profile(depth, absorption, scattering)
    tops = np.array([layer.top for layer in column.layers])
    fine = np.linspace(0.0, 12.0, 120_001)
    for found, values in ((column.absorbed, absorption), (column.scattered, scattering)):
        straight = np.interp(fine, depth, values)
        steps = 0.5 * (straight[1:] + straight[:-1]) * np.diff(fine)
        expected = np.interp(tops, fine, np.concatenate([[0.0], np.cumsum(steps)]))
        assert found(tops) == pytest.approx(expected, abs=1e-6)
    beyond = column.scattered(15.0) - column.scattered(12.0)
    assert beyond == pytest.approx(3.0 * 2.0)
    ends = np.interp(tops, depth, scattering)
    larger = np.array([1.0, 1.0, 2.0])[np.searchsorted(depth, tops[1:]) - 1]
    assert np.all(np.abs(np.diff(ends)) <= FINEST_STEP * larger + 1e-12)


def test_profiles_that_begin_deeper_stay_as_they_are_there_up_to_the_surface() -> None:
    column = profile([2.0, 4.0], [0.1, 0.3], [0.2, 0.6])
    assert column.surface.absorption == 0.1
    assert column.scattered([2.0, 4.0]) == pytest.approx([0.4, 0.4 + 0.8])


def test_even_profiles_have_few_slices_and_the_nearer_phase_function() -> None:
    sharp, blunt = henyey_greenstein(0.95), henyey_greenstein(0.8)
    column = profiled_water(
        depth=[0.0, 4.0, 8.0],
        absorption=[0.1, 0.1, 0.1],
        scattering=[0.1, 0.1, 0.3],
        phase_functions=[sharp, sharp, blunt],
        refractive_index=1.34,
        group_index=1.36,
    )
    assert len(column.layers) == 1 + 14 + 1
    assert column.at(5.5).phase_function is sharp
    assert column.at(6.5).phase_function is blunt
    assert column.at(20.0).phase_function is blunt


@pytest.mark.parametrize(
    ("depth", "scattering", "text"),
    [
        ([0.0, 0.0], [0.1, 0.1], "depths must increase from the surface down"),
        ([-1.0, 2.0], [0.1, 0.1], "depths must increase from the surface down"),
        ([0.0, 2.0], [0.1, -0.1], "scattering = .*must not be negative"),
    ],
)
def test_profiles_that_are_none(depth: list[float], scattering: list[float], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        profile(depth, [0.1, 0.1], scattering)


def test_columns_that_are_none() -> None:
    slow = petzold_water("clear", refractive_index=1.34, group_index=1.4)
    with pytest.raises(ValueError, match=r"must begin at 0 m\n.*increasing depth\n.*same refract"):
        WaterColumn(
            layers=tuple(Layer(top=top, water=water) for top, water in ((1.0, CLEAR), (1.0, slow)))
        )
    with pytest.raises(ValueError, match="3 to 2 m: must go down from the surface"):
        TURBID.with_layer(HARBOR, top=3.0, bottom=2.0)


def profile(depth: list[float], absorption: list[float], scattering: list[float]) -> WaterColumn:
    return profiled_water(
        depth=depth,
        absorption=absorption,
        scattering=scattering,
        phase_functions=[average_particle()] * len(depth),
        refractive_index=1.34,
        group_index=1.36,
    )

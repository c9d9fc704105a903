"""Tracks of open water: what is drawn once and laid everywhere."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import kstest

from survey.optics.water import WaterColumn, petzold_water
from survey.transport import tracks as tracks_module
from survey.transport.layers import kernel_layers
from survey.transport.random import TRACKS as TRACKS_PURPOSE
from survey.transport.random import start_stream, uniform
from survey.transport.tracks import (
    TILT_STEP,
    TILTS,
    Tracks,
    chosen,
    draw_tracks,
    frame_around,
    frame_straying,
    frame_uphill,
    part_early,
    way_to,
)
from terrain.kernels import kernel

SETS, TRACKS, LEGS = 8, 2048, 12
DETOUR = 1.0
DIRECTIONS = [
    (0.0, 0.0, -1.0),
    (0.0, 0.0, 1.0),
    (1.0, 0.0, 0.0),
    (0.48, -0.6, 0.64),
    (-0.6, 0.48, -0.64),
]


@pytest.fixture(scope="module")
def water():
    return petzold_water("coastal", refractive_index=1.33, group_index=1.33)


@pytest.fixture(scope="module")
def layers(water):
    return kernel_layers(WaterColumn.uniform(water))


@pytest.fixture(scope="module")
def tracks(layers):
    return draw_tracks(layers, SETS, TRACKS, LEGS, 10.0, DETOUR, 3, 5)


def test_lengths_are_exponential(tracks):
    """Free optical lengths of first and later legs; false alarms below 1e-4 each."""
    for leg in (0, 1, 5, LEGS - 1):
        assert kstest(tracks.legs[..., leg, 3].ravel(), "expon").pvalue > 1e-4


def test_first_lengths_are_stratified(tracks):
    """One in each of as many strata of equal chance, in every set."""
    strata = np.sort((1.0 - np.exp(-tracks.legs[..., 0, 3].astype(float))) * TRACKS, axis=1)
    assert np.abs(strata - np.arange(TRACKS) - 0.5).max() < 0.51


def test_directions_turn_as_the_phase_function_says(tracks, water):
    """First legs point ahead; mean cosine of turn k is g, of leg k is g^k: 4 standard errors.

    Tracks stray to all sides alike.
    """
    directions = tracks.legs[..., :3].astype(float).reshape(-1, LEGS, 3)
    assert np.array_equal(directions[:, 0], np.tile([0.0, 0.0, 1.0], (len(directions), 1)))
    assert np.linalg.norm(directions, axis=2) == pytest.approx(1.0, abs=1e-6)
    g = water.phase_function.mean_cosine
    turns = (directions[:, 1:] * directions[:, :-1]).sum(axis=2)
    error = turns.std() / turns.size**0.5
    assert abs(turns.mean() - g) < 4.0 * error
    for leg in (3, LEGS - 1):
        cosine = directions[:, leg, 2]
        assert abs(cosine.mean() - g**leg) < 4.0 * cosine.std() / len(cosine) ** 0.5
        aside = directions[:, leg, :2]
        assert np.all(np.abs(aside.mean(axis=0)) < 4.0 * aside.std(axis=0) / len(aside) ** 0.5)


def test_turns_have_the_shares_of_the_phase_function(tracks, water):
    """Turns within 1, 10, 45 and 90 degrees against its integral: 4 standard errors."""
    directions = tracks.legs[..., :3].astype(float).reshape(-1, LEGS, 3)
    cross = np.linalg.norm(np.cross(directions[:, 1:], directions[:, :-1]), axis=2)
    turn = np.arctan2(cross, (directions[:, 1:] * directions[:, :-1]).sum(axis=2))
    for degrees in (1.0, 10.0, 45.0, 90.0):
        share = water.phase_function.fraction_within(math.radians(degrees))
        error = math.sqrt(share * (1.0 - share) / turn.size)
        assert abs((turn < math.radians(degrees)).mean() - share) < 4.0 * error


def plain_path_to(depth, legs):
    """Path to a depth by walking in small steps along a finely cut track."""
    ends = np.concatenate([[0.0], np.cumsum(legs[:, 3])])
    depths = np.concatenate([[0.0], np.cumsum(legs[:, 2] * legs[:, 3])])
    path = np.linspace(0.0, ends[-1], 400_001)
    below = np.flatnonzero(np.interp(path, ends, depths) >= depth)
    return path[below[0]] if len(below) else math.inf


def test_path_to_a_depth(tracks, layers, water):
    """Where a track first gets there, within a step of 400,000; never is infinity."""
    for legs in tracks.legs[0, ::128]:
        for depth in (0.5, 2.0, 6.0):
            expected = plain_path_to(depth, legs.astype(float))
            step = float(legs[:, 3].sum()) / 400_000
            path = way_to(layers, depth / water.scattering, legs)[0] * water.scattering
            assert path == pytest.approx(expected, abs=2.0 * step + 1e-5)


def test_tracks_stand_in_the_order_of_their_paths(tracks, layers):
    """Those that get down first, of these the early ones."""
    for i in range(SETS):
        ends = np.array([way_to(layers, 10.0, legs) for legs in tracks.legs[i]])
        paths = ends[:, 0]
        assert np.array_equal(tracks.aside[i], ends[:, 1:])
        reached, early = tracks.reached[i], tracks.early[i]
        assert paths[early - 1] < 10.0 + DETOUR <= paths[early]
        assert np.all(np.diff(paths[:reached]) >= 0.0)
        assert np.isinf(paths[reached:]).all()
        assert np.isfinite(paths[:reached]).all()
    assert 0.9 < tracks.reached.mean() / TRACKS < 0.99


def aslant_path_to(depth, legs, tangent):
    """Path to a depth of a track laid with its first axis uphill, by plain trigonometry."""
    slope = math.atan(tangent)
    down = legs[:, 3] * (legs[:, 2] * math.cos(slope) - legs[:, 0] * math.sin(slope))
    depths, path = np.cumsum(down), np.cumsum(legs[:, 3])
    below = np.flatnonzero(depths >= depth)
    if not len(below):
        return math.inf
    first = below[0]
    return path[first] - (depths[first] - depth) * legs[first, 3] / down[first]


@pytest.mark.parametrize("tilt", [3, TILTS - 1])
def test_tracks_laid_aslant_are_ordered_by_their_paths_aslant(tracks, water, tilt):
    """Out of order by a fifth at most of what they are in the order of no tilt.

    Of late light that comes down all the same, by root mean square of the paths' difference from
    the sorted ones. The order is to first order of the tilt. Broken: with the sign of the first
    axis turned round it is twice as much as in the order of no tilt.
    """
    legs = tracks.legs[0].astype(float)
    paths = np.array(
        [aslant_path_to(10.0 * water.scattering, track, tilt * TILT_STEP) for track in legs]
    )

    def disorder(order):
        found = paths[order][tracks.early[0] : tracks.reached[0] * 9 // 10]
        found = found[np.isfinite(found)]
        return math.sqrt(np.mean((found - np.sort(found)) ** 2))

    assert disorder(tracks.order[tilt, 0]) < 0.2 * disorder(tracks.order[0, 0])
    assert np.array_equal(tracks.order[0, 0], np.arange(TRACKS))
    assert np.array_equal(np.sort(tracks.order[tilt, 0]), np.arange(TRACKS))


def test_places_of_early_tracks_come_first(tracks):
    part = part_early(tracks, 0)
    assert 0.5 < part < 1.0
    assert chosen(tracks, 0, part - 1e-6, 0).track == tracks.early[0] - 1
    assert chosen(tracks, 0, part + 1e-6, 0).track == tracks.early[0]
    assert part_early(tracks._replace(early=np.zeros_like(tracks.early)), 0) == 0.0


def test_sets_are_different_and_repeatable(tracks, layers):
    again = draw_tracks(layers, SETS, TRACKS, LEGS, 10.0, DETOUR, 3, 5)
    assert np.array_equal(again.legs, tracks.legs)
    other = draw_tracks(layers, SETS, TRACKS, LEGS, 10.0, DETOUR, 3, 6)
    every = np.concatenate([tracks.legs[..., 0, 3].ravel(), other.legs[..., 0, 3].ravel()])
    assert len(np.unique(every)) > 0.999 * len(every)


@pytest.mark.parametrize("reached", [0, 3, 40, 97, 100])
def test_every_track_counts_alike(reached):
    """Over all places the weights add up to 1/100 for each of 100 tracks, hence to one."""
    lost_rarely = Tracks(
        legs=np.zeros((1, 100, 2, 4), np.float32),
        aside=np.zeros((1, 100, 2)),
        reached=np.array([reached]),
        early=np.array([reached]),
        order=np.random.default_rng(1).permuted(np.arange(100)[None, None], axis=-1),
    )
    places = (np.arange(40_000) + 0.5) / 40_000
    found = [chosen(lost_rarely, 0, place, 0) for place in places]
    expected = np.zeros(100)
    for track, weight, _ in found:
        expected[track] += weight / len(places)
    assert expected == pytest.approx(0.01, rel=0.02)
    assert expected.sum() == pytest.approx(1.0, rel=1e-3)


@kernel
def whole_frames(dx, dy, dz, circle, count):
    state, frames = np.empty(2, np.uint64), np.empty((count, 9))
    start_stream(state, 1, 2, 3, 4, 5)
    for i in range(count):
        frames[i] = frame_around(dx, dy, dz, circle, uniform(state))
    return frames


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_axes_make_a_frame_around_a_direction(direction):
    """Right-handed, orthonormal, and at every azimuth alike: 4 standard errors of 10,000."""
    azimuth = 2.0 * np.pi * np.arange(256) / 256
    frames = whole_frames(*direction, np.column_stack([np.cos(azimuth), np.sin(azimuth)]), 10_000)
    a, b, c = frames[:, :3], frames[:, 3:6], frames[:, 6:]
    assert np.array_equal(c, np.tile(direction, (len(c), 1)))
    assert np.linalg.norm(a, axis=1) == pytest.approx(1.0, abs=1e-12)
    assert np.linalg.norm(b, axis=1) == pytest.approx(1.0, abs=1e-12)
    assert np.cross(a, b) == pytest.approx(np.tile(direction, (len(a), 1)), abs=1e-12)
    assert np.abs(a.mean(axis=0)).max() < 4.0 / 100.0
    spread = np.eye(3) - np.outer(direction, direction)
    assert a.T @ a / len(a) == pytest.approx(0.5 * spread, abs=4.0 / 100.0)


@pytest.mark.parametrize("direction", [(0.0, 0.0, -1.0), (-0.6, 0.48, -0.64), (0.3, 0.4, -0.866)])
def test_first_axis_leads_uphill(direction):
    """It is what rises fastest of all that is square to a direction going down."""
    d = np.array(direction) / np.linalg.norm(direction)
    a, b, c = np.array(frame_uphill(*d)).reshape(3, 3)
    assert np.stack([a, b, c]) @ np.stack([a, b, c]).T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.cross(a, b) == pytest.approx(d, abs=1e-12)
    assert a[2] == pytest.approx(np.hypot(d[0], d[1]), abs=1e-12)
    assert b[2] == 0.0


def test_tracks_stray_to_an_azimuth(tracks):
    """Laid straight down at a quarter turn a track strays to the south, whatever its own axes."""
    azimuth = 2.0 * np.pi * np.arange(256) / 256
    circle = np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    late = tracks.reached[0] - 1
    a, b, _ = np.array(frame_straying(tracks, 0, late, 0.0, 0.0, -1.0, circle, 0.25)).reshape(3, 3)
    along, across = tracks.aside[0, late]
    strayed = along * a - across * b
    assert strayed == pytest.approx((0.0, -np.hypot(along, across), 0.0), abs=1e-9)


def test_streams_of_tracks_have_their_own_addresses(layers, monkeypatch):
    """No two tracks of two frames draw the same numbers."""
    addresses = []

    def noted(state, *address):
        addresses.append(address)
        start_stream(state, *address)

    monkeypatch.setattr(tracks_module, "start_stream", noted)
    for frame in (0, 1):
        draw_tracks.py_func(layers, 4, 16, 6, 10.0, DETOUR, 3, frame)
    assert len(set(addresses)) == len(addresses) == 2 * 4 * 16
    assert {address[1] for address in addresses} == {TRACKS_PURPOSE}

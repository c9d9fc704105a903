"""Do the standard errors that the engine states cover what happens?"""

from __future__ import annotations

import numpy as np

from survey.transport.waveforms import crossed_variance
from tests.physics.conftest import level_pose, make_engine

FLASHES = 24


def test_stated_errors_are_those_of_repeated_flashes():
    """Standard deviation of 24 flashes of one scene against the stated standard errors.

    Still water, so that flashes differ by chance alone. Root mean square over pixels and bins
    where the echo counts: the ratio of scatter to statement lies in 0.9 to 1.1.
    """
    engine = make_engine(wind_speed=0.0, backward_walks_per_pixel=32, forward_walks_per_m2=8.0)
    flashes = [engine.flash(pose=level_pose(), frame=frame) for frame in range(FLASHES)]
    for origin in (1, 2):
        echoes = np.stack([flash.photo_electrons[origin, 8:24, 16:48] for flash in flashes])
        stated = np.mean([flash.variance[origin, 8:24, 16:48] for flash in flashes], axis=0)
        mean = echoes.mean(axis=0)
        strong = mean > 0.2 * mean.max()
        ratio = np.sqrt(echoes.var(axis=0, ddof=1)[strong].sum() / stated[strong].sum())
        assert 0.9 < ratio < 1.1, (origin, ratio)


def test_variance_of_crossed_batches():
    """Forward, backward and pairing parts of variance 1, 4 and 9 in 8 batches: 5/8 + 9/64.

    The mean of 20,000 independent estimates; their own scatter holds it to 2 %.
    """
    chance, batches, pixels = np.random.default_rng(3), 8, 20_000
    grid = chance.normal(size=(batches, 1, pixels)) + 2.0 * chance.normal(size=(batches, pixels))
    grid += 3.0 * chance.normal(size=(batches, batches, pixels))
    matched = grid[np.arange(batches), np.arange(batches)]
    sides = np.stack([grid.mean(axis=1), grid.mean(axis=0), matched]).astype(np.float32)
    variance = crossed_variance(sides[:, :, None, :, None], np.ones(1, np.float32))
    assert abs(variance.mean() / (5 / 8 + 9 / 64) - 1.0) < 0.02

"""Do the standard errors that the engine states cover what happens?"""

from __future__ import annotations

import numpy as np

from survey.transport.waveforms import Replicates
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


def test_replicates_give_mean_and_variance_of_the_mean():
    values = np.random.default_rng(3).normal(size=(50, 4))
    sums = Replicates(shape=(4,))
    for value in values:
        sums.add(value)
    assert np.allclose(sums.mean, values.mean(axis=0))
    assert np.allclose(sums.variance_of_mean, values.var(axis=0, ddof=1) / 50)

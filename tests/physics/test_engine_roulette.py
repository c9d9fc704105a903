"""The roulette of faint walks: those that survive carry the weight of those that did not."""

from __future__ import annotations

import numpy as np

from survey.optics.phase import henyey_greenstein
from survey.transport import engine as engine_module
from survey.transport.light_paths import ROULETTE_BELOW
from tests.physics.conftest import level_pose, make_engine

FLASHES, DEPTH, ABSORPTION = 64, 11.0, 1.0
# 99.9 %, two-sided, 63 degrees of freedom.
QUANTILE = 3.45


def bottom_echoes(**water):
    """Return the light of the bottom in 32 pixels together, flash by flash."""
    engine = make_engine(
        depth=DEPTH, absorption=ABSORPTION, wind_speed=0.0, shape=(4, 8), pixel_tangent=0.002,
        split_angle=0.0, **water,
    )  # fmt: skip
    flashes = [engine.flash(pose=level_pose(), frame=frame) for frame in range(FLASHES)]
    return np.array([flash.origin("bottom").sum() for flash in flashes]), flashes


def test_scattering_straight_ahead_takes_nothing_from_a_faint_echo(monkeypatch):
    """Bottom under 11 absorption lengths, on the way back through roulette: as without scattering,
    within 5 %, by equivalence.

    Rationale: light that scatters straight ahead (Henyey-Greenstein, g = 0.99999) is lost by
    absorption alone; its walks fall below the roulette's weight exp(-9.2) on either way. Tracks of
    two legs and a split angle of 0 let it be played at every scattering.
    Expected: the echo of water with b = 0, a flash of which has no chance. Error 0.9 %: a fault of
    10 % fails with 99.9 %; without the reward, there or back, four fifths of the light are gone.
    Source: the lidar equation with a, as g -> 1.
    """
    monkeypatch.setattr(engine_module, "FEWEST_LEGS", 2)
    monkeypatch.setattr(engine_module, "MOST_LEGS", 0)
    assert np.exp(-ABSORPTION * DEPTH) < 0.2 * ROULETTE_BELOW
    clear, _ = bottom_echoes(scattering=0.0)
    light, flashes = bottom_echoes(
        scattering=2.0, phase_function=henyey_greenstein(0.99999), walks_per_pixel=512
    )
    ratio = light / clear.mean()
    error = ratio.std(ddof=1) / FLASHES**0.5
    assert abs(ratio.mean() - 1.0) + QUANTILE * error < 0.05, (ratio.mean(), error)
    assert all(abs(flash.ledger["roulette"]) > 0.0 for flash in flashes)

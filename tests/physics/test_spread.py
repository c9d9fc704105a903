"""Numbers spread over the walks of a pixel: all pairs of tracks count alike, early ones surely."""

from __future__ import annotations

import numpy as np
import pytest

from survey.transport.spread import Shifts, pair, shared_out, spread_evenly

PARTS = [(0.9, 0.8), (0.3, 0.6), (1.0, 0.5), (0.0, 0.7), (1.0, 1.0), (0.001, 0.002)]


def walks_of(walks, parts, shifts):
    """Return places and weights (walks, 3) of a pixel's walks."""
    shares = shared_out(walks, *parts)
    return np.array([pair(i, shares, *shifts) for i in range(walks)])


@pytest.mark.parametrize("parts", PARTS)
@pytest.mark.parametrize("walks", [1, 2, 3, 9, 22])
def test_walks_stand_for_all_pairs(walks, parts):
    """Mean over 4,000 shifts of smooth and of broken functions of two places: 5 standard errors.

    Their integrals over the unit square are known: x y^2 of 1/6, and 1/8 where 2 x + y < 1, which
    does not follow the edges of the early part, is 1/32.
    """
    chance = np.random.default_rng(5)
    found = []
    for _ in range(4000):
        x, y, weight = walks_of(walks, parts, chance.random(2)).T
        assert weight.sum() == pytest.approx(walks, rel=1e-12)
        assert ((x >= 0.0) & (x < 1.0) & (y >= 0.0) & (y < 1.0)).all()
        found.append([(weight * x * y * y).mean(), (weight * (2.0 * x + y < 1.0) / 8.0).mean()])
    error = np.std(found, axis=0) / len(found) ** 0.5
    assert np.all(np.abs(np.mean(found, axis=0) - [1.0 / 6.0, 1.0 / 32.0]) < 5.0 * error + 1e-12)


@pytest.mark.parametrize("parts", [(0.9, 0.8), (0.3, 0.6)])
@pytest.mark.parametrize("walks", [9, 22])
def test_light_of_early_pairs_alone_has_no_chance_in_it(walks, parts):
    for shifts in np.random.default_rng(6).random((50, 2)):
        x, y, weight = walks_of(walks, parts, shifts).T
        early = (x < parts[0]) & (y < parts[1])
        assert (weight * early).mean() == pytest.approx(parts[0] * parts[1], rel=1e-12)
        assert early.sum() == walks - np.ceil((1.0 - parts[0] * parts[1]) * walks)


def test_no_pair_is_set_aside_where_all_or_none_are_early():
    for parts in ((1.0, 1.0), (0.0, 0.5)):
        shares = shared_out(9, *parts)
        assert (shares.early, shares.others, shares.early_weight) == (9, 0, 1.0)


def test_places_in_the_pixel_fill_its_square():
    """Sixteen walks: at least one in each quarter, whatever the shifts."""
    shares = shared_out(16, 0.9, 0.8)
    for shifts in np.random.default_rng(7).random((50, 5)):
        walks = [spread_evenly(i, shares, Shifts(*shifts)) for i in range(16)]
        quarters = {(int(2.0 * walk.in_rows), int(2.0 * walk.in_columns)) for walk in walks}
        assert len(quarters) == 4

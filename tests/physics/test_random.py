"""Addressed random numbers."""

from __future__ import annotations

import numpy as np
from scipy.stats import kstest

from survey.transport.random import philox, start_stream, uniform
from terrain.kernels import kernel

# Known answers of the authors' library, Random123 (philox4x32-10).
KNOWN = [
    ((0, 0, 0, 0), (0, 0), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
    (
        (0xFFFFFFFF,) * 4,
        (0xFFFFFFFF,) * 2,
        (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD),
    ),
    (
        (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
        (0xA4093822, 0x299F31D0),
        (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
    ),
]


@kernel
def first_numbers(seed, photons):
    """Return the first two numbers of many photons' streams."""
    state = np.empty(2, np.uint64)
    out = np.empty((photons, 2))
    for photon in range(photons):
        start_stream(state, seed, 1, 2, 3, photon)
        out[photon, 0] = uniform(state)
        out[photon, 1] = uniform(state)
    return out


def test_philox_known_answers():
    for counter, key, answer in KNOWN:
        words = [np.uint64(word) for word in (*counter, *key)]
        assert tuple(int(word) for word in philox(*words)) == answer


def test_streams_of_neighbours_are_uniform_and_unrelated():
    """First numbers of 100,000 neighbouring streams; false alarms below 1e-4."""
    numbers = first_numbers(5, 100_000)
    assert kstest(numbers[:, 0], "uniform").pvalue > 1e-4
    assert kstest(numbers[:, 1], "uniform").pvalue > 1e-4
    pairs = np.corrcoef([numbers[:-1, 0], numbers[1:, 0], numbers[:-1, 1]])
    assert np.abs(pairs[np.triu_indices(3, 1)]).max() < 4.0 / 100_000**0.5


def test_an_address_draws_the_same_numbers():
    assert np.array_equal(first_numbers(5, 10), first_numbers(5, 10))
    assert not np.array_equal(first_numbers(5, 10), first_numbers(6, 10))

"""Addressed random numbers: the same photon draws the same numbers on any thread, in any order.

A photon's address (seed, purpose, frame, batch, photon) passes once through Philox 4x32-10
(Salmon et al. 2011), which seeds a xoroshiro128+ generator (Blackman and Vigna 2018) of its own.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import leaf_kernel

FORWARD, BACKWARD, TRACKS, PIXELS, COUNTS, REFERENCE, MOTION, NAVIGATION = range(8)

_MULTIPLIER_0 = np.uint64(0xD2511F53)
_MULTIPLIER_1 = np.uint64(0xCD9E8D57)
_WEYL_0 = np.uint64(0x9E3779B9)
_WEYL_1 = np.uint64(0xBB67AE85)
_LOW = np.uint64(0xFFFFFFFF)
_HALF = np.uint64(32)
_TO_UNIT = 1.0 / (1 << 53)


def chance(*, seed: int, purpose: int, frame: int) -> np.random.Generator:
    """Return numpy's generator at the beginning of an address, for draws of whole arrays."""
    return np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, frame, purpose]))


@leaf_kernel
def philox(
    c0: np.uint64, c1: np.uint64, c2: np.uint64, c3: np.uint64, k0: np.uint64, k1: np.uint64
) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64]:
    """Philox 4x32-10: four 32-bit words of counter, two of key, four words of noise."""
    for _ in range(10):
        p0, p1 = _MULTIPLIER_0 * c0, _MULTIPLIER_1 * c2
        c0, c1, c2, c3 = (
            ((p1 >> _HALF) ^ c1 ^ k0) & _LOW,
            p1 & _LOW,
            ((p0 >> _HALF) ^ c3 ^ k1) & _LOW,
            p0 & _LOW,
        )
        k0, k1 = (k0 + _WEYL_0) & _LOW, (k1 + _WEYL_1) & _LOW
    return c0, c1, c2, c3


@leaf_kernel
def start_stream(
    state: NDArray[np.uint64], seed: int, purpose: int, frame: int, batch: int, photon: int
) -> None:
    """Set a generator (two words of ``state``) to the beginning of an address."""
    key = np.uint64(seed)
    r0, r1, r2, r3 = philox(
        np.uint64(photon) & _LOW,
        np.uint64(batch) & _LOW,
        np.uint64(frame) & _LOW,
        np.uint64(purpose) & _LOW,
        key & _LOW,
        key >> _HALF,
    )
    state[0] = (r0 << _HALF) | r1
    state[1] = (r2 << _HALF) | r3 | np.uint64(1)


@leaf_kernel
def uniform(state: NDArray[np.uint64]) -> float:
    """Next uniform number in [0, 1), 53 bits."""
    s0, s1 = state[0], state[1]
    result = s0 + s1
    s1 ^= s0
    state[0] = ((s0 << np.uint64(24)) | (s0 >> np.uint64(40))) ^ s1 ^ (s1 << np.uint64(16))
    state[1] = (s1 << np.uint64(37)) | (s1 >> np.uint64(27))
    return float(result >> np.uint64(11)) * _TO_UNIT


@leaf_kernel
def exponential(state: NDArray[np.uint64]) -> float:
    """Next exponential number of mean one."""
    return -math.log(1.0 - uniform(state))


@leaf_kernel
def mixed(value: np.uint64) -> np.uint64:
    """Scramble 64 bits (the finaliser of SplitMix64, Steele et al. 2014)."""
    value = (value ^ (value >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    value = (value ^ (value >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return value ^ (value >> np.uint64(31))

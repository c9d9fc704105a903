"""New directions after a scattering and from a Lambertian face."""

from __future__ import annotations

import numpy as np
import pytest

from survey.optics.water import petzold_water
from survey.transport.directions import drawn, lambert_direction, turned
from survey.transport.scene import restricted_medium

AZIMUTHS = 2.0 * np.pi * (np.arange(64) + 0.5) / 64
INCOMING = [
    (0.0, 0.0, -1.0),
    (0.0, 0.0, 1.0),
    (1.0, 0.0, 0.0),
    (0.48, -0.6, 0.64),
    (-0.6, 0.48, -0.64),
]


@pytest.mark.parametrize("incoming", INCOMING)
@pytest.mark.parametrize("polar", [1e-4, 0.3, 1.2, 3.0])
def test_a_turn_keeps_its_angle_at_every_azimuth(incoming, polar):
    """Unit vectors at the polar angle, and evenly around: their mean is cos(polar) x incoming."""
    one_minus_cos = 2.0 * np.sin(0.5 * polar) ** 2
    turns = np.array([turned(*incoming, one_minus_cos, azimuth) for azimuth in AZIMUTHS])
    assert np.linalg.norm(turns, axis=1) == pytest.approx(1.0, abs=1e-14)
    aside = np.linalg.norm(turns - np.cos(polar) * np.array(incoming), axis=1)
    assert aside == pytest.approx(np.sin(polar), rel=1e-9)
    assert turns.mean(axis=0) == pytest.approx(np.cos(polar) * np.array(incoming), abs=1e-14)


def test_a_lambertian_face_sends_by_the_cosine():
    """Moments of the cosine, 2/3 and 1/2, and none aside: 5 standard errors of 40,000."""
    normal, state = np.array([0.48, -0.6, 0.64]), np.array([11, 13], np.uint64)
    sent = np.array([lambert_direction(*normal, state) for _ in range(40_000)])
    cosine = sent @ normal
    for value, expected in ((cosine, 2.0 / 3.0), (cosine**2, 0.5)):
        assert abs(value.mean() - expected) < 5.0 * value.std() / 200.0
    aside = sent - cosine[:, None] * normal
    assert np.all(np.abs(aside.mean(axis=0)) < 5.0 * aside.std(axis=0) / 200.0)


@pytest.mark.parametrize("degrees", [10.0, 30.0, 60.0])
def test_restricted_walks_turn_within_the_split_angle(degrees):
    """No turn of 20,000 is wider, some come near, and all attenuation is c still."""
    water = petzold_water("harbor", refractive_index=1.33, group_index=1.33)
    medium = restricted_medium(water, split_angle=np.radians(degrees))
    state = np.array([17, 19], np.uint64)
    turns = [drawn(medium.sampler, medium.sampler_share, state) for _ in range(20_000)]
    widest = np.degrees(np.arccos(1.0 - max(turns)))
    assert 0.9 * degrees < widest < 1.001 * degrees
    assert medium.attenuation + medium.scattering == pytest.approx(water.attenuation, rel=1e-12)

"""The numbers of the method must not matter: split angle, spacing, tracks and their legs.

Light of a small camera over a flat bottom, a slope and a wreck with overhangs, at the settings as
they are and with one of them changed. What is compared, pooled over the pixels:

- column and bottom as a whole, by an equivalence test: the whole 99.9 % interval of their ratio
  lies within 2 %. A bias of 2 % passes with a chance of 0.05 %; without bias, at an error of the
  ratio of 0.4 %, the test passes in 9 of 10 cases and seeds are fixed.
- each band of 10 ns that holds more than 5 % of its origin's light: differences within 4.5
  standard errors. False alarms over all bands and cases below 0.1 %; a bias of six errors, some
  6 % in the weakest band, is found with 93 %.

Errors are those of 64 flashes each way.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from survey.transport import engine as engine_module
from terrain.generators import Ground, slope
from terrain.objects import place, wreck
from tests.physics.conftest import FRAME, level_pose, make_engine

FLASHES, BAND = 64, 10
EQUIVALENT, QUANTILE = 0.02, 3.3
FURTHEST, LEAST_SHARE = 4.5, 0.05
VARIANTS = {
    "split at 20 degrees": {"split_angle": math.radians(20.0)},
    "split at 30 degrees": {"split_angle": math.radians(30.0)},
    "split at 60 degrees": {"split_angle": math.radians(60.0)},
    "column spacing halved": {"column_spacing": 0.5},
    "tracks doubled": {"tracks_per_replicate": 2048},
    "walks doubled": {"walks_per_pixel": 128},
}
SCENES = ("flat", "slope", "wreck")


@cache
def seabed_of(scene):
    """Return a bottom about 8 m deep, flat or falling by one in five, or with a wreck on it."""
    ground = Ground(map_frame=FRAME, length=400.0, width=400.0, axis=np.pi / 2, reflectance=0.1)
    bed = slope(ground=ground, depth=8.0, gradient=0.2 if scene == "slope" else 0.0)
    if scene != "wreck":
        return bed
    hull = place(
        wreck(length=20.0, beam=6.0, height=4.0, edge=1.0),
        seabed=bed, east=1.0, north=0.0, heading=0.5, list_angle=math.radians(15.0),
    )  # fmt: skip
    return bed.with_object(hull, reflectance=0.15, source="A wreck.")


@cache
def bands(scene, variant, seed):
    """Return light (flashes, column and bottom, bands) of all pixels together."""
    engine = make_engine(
        seabed=seabed_of(scene), shape=(4, 8), seed=seed, **VARIANTS.get(variant, {})
    )
    flashes = [engine.flash(pose=level_pose(), frame=frame) for frame in range(FLASHES)]
    light = np.array([flash.photo_electrons[1:].sum(axis=(1, 2)) for flash in flashes])
    return light.reshape(FLASHES, 2, -1, BAND).sum(axis=-1, dtype=np.float64)


def compare(found, known):
    """Assert that two sets of flashes are of the same light."""
    for origin in range(2):
        a, b = found[:, origin], known[:, origin]
        error = np.hypot(a.std(axis=0, ddof=1), b.std(axis=0, ddof=1)) / FLASHES**0.5
        strong = b.mean(axis=0) > LEAST_SHARE * b.mean(axis=0).sum()
        off = (a.mean(axis=0) - b.mean(axis=0))[strong] / error[strong]
        assert np.abs(off).max() < FURTHEST, (origin, off)
        whole, other = a.sum(axis=1), b.sum(axis=1)
        spread = np.hypot(whole.std(ddof=1), other.std(ddof=1)) / FLASHES**0.5 / other.mean()
        difference = abs(whole.mean() / other.mean() - 1.0)
        assert difference + QUANTILE * spread < EQUIVALENT, (origin, difference, spread)


@pytest.mark.parametrize("variant", ["split at 30 degrees", "column spacing halved"])
@pytest.mark.parametrize("scene", ["flat", "wreck"])
def test_settings_do_not_matter(scene, variant):
    compare(bands(scene, variant, 11), bands(scene, "as it is", 12))


def test_every_variant_differs_from_the_settings_as_they_are():
    plain = make_engine(shape=(4, 8)).settings
    for variant in VARIANTS.values():
        assert replace(plain, **variant) != plain


@pytest.mark.slow
@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("scene", SCENES)
def test_no_setting_matters(scene, variant):
    compare(bands(scene, variant, 13), bands(scene, "as it is", 12))


@pytest.mark.parametrize("legs", [2, 40])
def test_the_number_of_legs_drawn_does_not_matter(legs, monkeypatch):
    """A track that ends goes on along another one, as if it had been drawn in one piece."""
    known = bands("flat", "as it is", 12)
    monkeypatch.setattr(engine_module, "FEWEST_LEGS", legs)
    monkeypatch.setattr(engine_module, "MOST_LEGS", 0)
    compare(bands.__wrapped__("flat", "as it is", 14), known)

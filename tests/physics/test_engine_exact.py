"""What holds exactly, whatever the random numbers: energy, scale, absorption, repetition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.constants import speed_of_light

INDEX, HEIGHT, SCATTERING = 1.33, 200.0, 0.219


def test_pulse_energy_scales_exactly(engine_of, nadir):
    """Eight times the energy gives exactly eight times the photo-electrons."""
    few = {"walks_per_pixel": 16}
    plain = engine_of(**few).flash(pose=nadir, frame=3).photo_electrons
    strong = engine_of(pulse_energy=8.0, **few).flash(pose=nadir, frame=3).photo_electrons
    assert np.array_equal(strong, 8.0 * plain)


def test_similar_scenes_give_the_same_echo(engine_of, nadir):
    """All lengths and times doubled, a and b halved: the same histories in the same bins.

    Expected: surface and column to the last bit, the bottom but for its last digit, as walks go on
    from it a fixed 0.1 um above; as many scatterings.
    """
    few = {"walks_per_pixel": 16}
    plain = engine_of(absorption=0.18, scattering=0.2, **few).flash(pose=nadir, frame=1)
    twice = replace(nadir, position=2.0 * nadir.position)
    large = engine_of(absorption=0.09, scattering=0.1, scale=2.0, **few)
    again = large.flash(pose=twice, frame=1)
    assert again.scatterings == plain.scatterings
    for origin in ("surface", "column"):
        assert np.array_equal(again.origin(origin), plain.origin(origin))
    echo = plain.origin("bottom")
    assert np.abs(again.origin("bottom") - echo).max() < 1e-6 * echo.max()


@pytest.mark.parametrize("group_index", [INDEX, 1.36])
def test_absorption_by_reweighting_is_a_fresh_run(engine_of, nadir, group_index):
    """More absorption takes exp(-da s) of the light with path s in water, bin by bin: 1 %; of all
    light 1e-5, column and bottom alike.

    Rationale: absorption turns no light, so that the same numbers draw the same histories. Pixels
    of 10 cm, whose light has the same way in air; what is left of a bin's 0.2 m of path is second
    order, (da ds)^2 / 8 = 6e-6, but where a bin holds few paths.
    """

    def flash(absorption):
        engine = engine_of(
            absorption=absorption, scattering=SCATTERING, group_index=group_index,
            column_spacing=1.5 * (absorption + SCATTERING), shape=(4, 4), pixel_tangent=5e-4,
            pulse_fwhm=1e-15, walks_per_pixel=256,
        )  # fmt: skip
        return engine.flash(pose=nadir, frame=1)

    less, more = 0.1, 0.13
    given, fresh = flash(less), flash(more)
    in_water = (given.times - 2.0 * HEIGHT / speed_of_light) * speed_of_light / group_index
    for origin in ("column", "bottom"):
        expected = given.origin(origin) * np.exp(-(more - less) * in_water)
        found = fresh.origin(origin)
        assert found.sum() == pytest.approx(expected.sum(), rel=1e-5)
        bright = expected > 1e-3 * expected.max()
        assert found[bright] == pytest.approx(expected[bright], rel=0.01)
        assert found.sum() < 0.95 * given.origin(origin).sum()


def test_the_same_flash_draws_the_same_light(engine_of, nadir):
    few = {"walks_per_pixel": 16}
    first, second = (engine_of(**few).flash(pose=nadir, frame=5) for _ in range(2))
    assert np.array_equal(first.photo_electrons, second.photo_electrons)
    assert np.array_equal(first.variance, second.variance)

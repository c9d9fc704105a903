"""Gordon's limits: how fast an echo fades with depth is a matter of the footprint's size.

A narrow footprint loses all light that scatters, and its echo fades with the beam attenuation c; a
wide one keeps what scatters forwards, and fades with the diffuse attenuation K_d of the water. The
footprint's radius R counts in attenuation lengths: c R -> 0 and c R > 5 to 6 (Gordon, H. R., 1982,
"Interpretation of airborne oceanic lidar: effects of multiple scattering", Applied Optics 21).

Rates are those of echo x (n H + z)^2, halved, as light goes there and back. Surfaces are still.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.constants import speed_of_light

from survey.optics.phase import henyey_greenstein, petzold
from survey.optics.water import PAPER_COEFFICIENTS
from survey.transport.profile import light_profile
from tests.physics.conftest import level_pose, make_engine

HEIGHT, INDEX, FLASHES = 200.0, 1.33, 8
# 99.9 %, two-sided, 7 degrees of freedom on either side.
QUANTILE = 4.2
DEPTHS = {"coastal": (5.0, 10.0, 15.0), "clear": (10.0, 20.0, 30.0)}
# Pixels of 2 cm, and a lit field of 51 x 102 m whose middle counts.
NARROW = {
    "shape": (2, 4), "pixel_tangent": 1e-4, "aperture_radius": 1e-4, "illumination": "isolated",
    "walks_per_pixel": 4096,
}  # fmt: skip
WIDE = {"shape": (8, 16), "pixel_tangent": 0.032, "walks_per_pixel": 1024}
MIDDLE = np.s_[3:5, 7:9]


def rate(light, depths):
    """Return the rate of decay between depths [1/m] and its error, of light (flashes, depths)."""
    depths = np.array(depths)
    spread = (INDEX * HEIGHT + depths) ** 2
    mean, error = light.mean(axis=0), light.std(axis=0, ddof=1) / FLASHES**0.5
    steps = 2.0 * np.diff(depths)
    relative = error / mean
    return -np.diff(np.log(mean * spread)) / steps, np.hypot(relative[1:], relative[:-1]) / steps


def flashes(**scene):
    """Return flashes over still water, the pulse being an impulse."""
    engine = make_engine(wind_speed=0.0, pulse_fwhm=1e-15, bins=500, **scene)
    return [engine.flash(pose=level_pose(), frame=frame) for frame in range(FLASHES)]


def bottom_rate(*, depths, pixels=np.s_[:, :], **scene):
    """Return the rate of the bottom's echo from depth to depth, and its error."""
    light = [
        [float(flash.origin("bottom")[pixels].sum()) for flash in flashes(depth=depth, **scene)]
        for depth in depths
    ]
    return rate(np.array(light).T, depths)


def column_rate(*, layers, thick, pixels=np.s_[:, :], **scene):
    """Return the rate of the column's echo between layers of ``thick`` bins, and its error."""
    found = flashes(depth=50.0, reflectance=0.0, **scene)
    depth = (found[0].times - 2.0 * HEIGHT / speed_of_light) * speed_of_light / (2.0 * INDEX)
    rows = [np.flatnonzero(depth > layer)[:thick] for layer in layers]
    light = np.array([flash.origin("column")[pixels].sum(axis=(0, 1)) for flash in found], float)
    return rate(
        np.column_stack([light[:, row].mean(axis=-1) for row in rows]),
        [depth[row].mean() for row in rows],
    )


@cache
def diffuse_attenuation(water, depths):
    """Return K_d between depths [1/m], sun at the zenith, by the Monte Carlo of `light_profile`."""
    absorption, scattering = PAPER_COEFFICIENTS[water]
    attenuation = absorption + scattering
    profile = light_profile(
        depths=attenuation * np.array(depths), albedo=scattering / attenuation,
        phase_function=petzold(water), walks=320_000, index=INDEX,
    )  # fmt: skip
    return profile.diffuse_attenuation[-len(depths) + 1 :] * attenuation


def assert_equivalent(found, expected, tolerance):
    """Assert that the whole 99.9 % interval of a rate lies within the tolerance."""
    value, error = found
    assert np.all(np.abs(value / expected - 1.0) + QUANTILE * error / expected < tolerance)


def test_the_bottom_of_a_narrow_footprint_fades_with_c():
    """Isolated pixels of 2 cm, c R = 0.003, from 3 to 9 m: c within 1.5 %, by equivalence.

    Rationale: a scattering by degrees throws light out of the footprint for good.
    Expected: c = 0.3 / m. Henyey-Greenstein, g = 0.9: of what scatters 0.05 % stays within R; its
    error of 0.2 % makes a fault of 2.5 % fail with 99.9 %, K_d or a instead of c by far.
    Source: Gordon (1982), the limit c R -> 0.
    """
    found = bottom_rate(
        depths=(3.0, 6.0, 9.0), absorption=0.1, scattering=0.2,
        phase_function=henyey_greenstein(0.9), **NARROW,
    )  # fmt: skip
    assert_equivalent(found, 0.3, 0.015)


def test_the_wider_a_footprint_the_slower_the_bottom_fades():
    """Coastal water, isolated pixels of 2 mm, 20 cm and 1.6 m: 0.98 c, 0.81 c, ever less.

    Rationale: what Petzold's peak scatters by less than a milliradian a footprint of millimetres
    still loses, one of metres keeps.
    Expected: between K_d and c, falling, the narrowest within 4 % of c; errors 0.5 %.
    Source: Gordon (1982), between his limits.
    """
    attenuation = sum(PAPER_COEFFICIENTS["coastal"])
    sizes = (1e-5, 1e-3, 8e-3)
    found = [
        bottom_rate(depths=(5.0, 10.0), **(NARROW | {"pixel_tangent": size}))[0][0]
        for size in sizes
    ]
    assert 0.96 * attenuation < found[0] < 1.01 * attenuation
    assert found[0] > 1.1 * found[1] > 1.2 * found[2]
    assert found[2] > diffuse_attenuation("coastal", (5.0, 10.0))[0]


@pytest.mark.parametrize("water", DEPTHS)
def test_the_bottom_of_a_wide_footprint_fades_with_k_d(water):
    """The middle of a lit field, 22 m from its edge at least: K_d within 1 %, by equivalence.

    Rationale: what scatters out of a ray comes from another one; nothing is lost but by absorption
    and backwards. Down it is E_d that fades, back by reciprocity the same.
    Expected: K_d of the same water by another Monte Carlo (`light_profile`), which has no bottom
    below and no laser; layers of 5 and 10 m. Errors 0.1 to 0.2 %: a fault of 2 % fails with 99.9 %.
    Source: Gordon (1982), the limit c R > 5 to 6.
    """
    depths = DEPTHS[water]
    found = bottom_rate(depths=depths, water=water, pixels=MIDDLE, **WIDE)
    assert_equivalent(found, diffuse_attenuation(water, depths), 0.01)


def test_the_column_of_a_narrow_footprint_fades_with_c():
    """Isolated pixels of 2 cm: c within 6 %, by equivalence, from 2 to 9 m.

    Expected: c = 0.3 / m, as for the bottom. Error 1 %: a fault of 10 % fails with 99.9 %.
    Source: Gordon (1982), the limit c R -> 0.
    """
    found = column_rate(
        layers=(1.0, 8.0), thick=18, absorption=0.1, scattering=0.2,
        phase_function=henyey_greenstein(0.5), **NARROW,
    )  # fmt: skip
    assert_equivalent(found, 0.3, 0.06)


@pytest.mark.parametrize("water", ["coastal", "clear"])
def test_the_column_of_a_wide_footprint_fades_with_k_d(water):
    """K_d of the layers within 5 %, by equivalence, 2 to 12 m.

    Expected: what comes back from a depth has gone there and back as E_d does; that it turns once
    by a phase function that is not even leaves some per cent. c is 1.3 to 2 times K_d.
    Source: Gordon (1982), the limit c R > 5 to 6.
    """
    layers = (2.0, 12.0)
    found = column_rate(layers=layers, thick=18, water=water, pixels=MIDDLE, **WIDE)
    assert_equivalent(found, diffuse_attenuation(water, (3.0, 13.0)), 0.05)

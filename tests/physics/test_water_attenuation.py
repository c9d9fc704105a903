"""Waters from surveyors' figures, sent through the Monte Carlo: do they attenuate as measured?"""

from __future__ import annotations

from math import radians

import numpy as np
import pytest

from survey.optics.phase import average_particle
from survey.optics.water.apparent import austin_petzold_attenuation, lee_diffuse_attenuation
from survey.optics.water.mixing import OneParameterWaters
from survey.optics.water.surveyor import chlorophyll_of_kd_490
from survey.transport.profile import light_profile

LASER = 532e-9
# 99.9 % two-sided, 63 degrees of freedom.
QUANTILE = 3.45


def mean_attenuation(mixture, *, cos_incidence):
    """Return K_d from the surface to where a tenth of the light is left, and its error [1/m]."""
    c = mixture.attenuation
    water = mixture.water(refractive_index=1.34, group_index=1.36)
    guess = lee_diffuse_attenuation(
        absorption=mixture.absorption, backscattering=mixture.backscattering, sun_zenith=0.0
    )
    levels = c * np.array([0.01, 2.3]) / guess
    found = light_profile(
        depths=levels,
        albedo=mixture.scattering / c,
        phase_function=water.phase_function,
        cos_incidence=cos_incidence,
        walks=64_000,
    )
    error = np.hypot(*(found.downward_error / found.downward)) / np.diff(levels)[0]
    return found.diffuse_attenuation[0] * c, error * c


@pytest.mark.parametrize("kd_490", [0.04, 0.15, 0.5])
@pytest.mark.parametrize("sun", [0.0, 30.0])
def test_water_of_a_measured_attenuation_has_it(kd_490, sun):
    """K_d(490) to 532 nm, to a and b, through the Monte Carlo, sun as then: 8 %.

    Lee's formula is 2 % off on average and 12 % at most, by its authors.
    """
    waters = OneParameterWaters(salinity=35.0, temperature=293.15, particles=average_particle())
    chlorophyll = chlorophyll_of_kd_490(
        kd_490, wavelength=LASER, waters=waters, sun_zenith=radians(sun)
    )
    mixture = waters.mixture(wavelength=LASER, chlorophyll=chlorophyll)
    found, error = mean_attenuation(mixture, cos_incidence=np.cos(radians(sun)))
    expected = austin_petzold_attenuation(kd_490=kd_490, wavelength=LASER)
    assert abs(found / expected - 1.0) + QUANTILE * error / expected < 0.08

"""Every published relation of the water against its published values."""

from __future__ import annotations

from itertools import pairwise
from math import exp, pi, radians

import numpy as np
import pytest

from survey.optics.phase import average_particle, fournier_forand_of_backscatter, molecular, petzold
from survey.optics.water import PAPER_COEFFICIENTS, apparent, constituents, pure, surveyor
from survey.optics.water.mixing import Component, Mixture, OneParameterWaters
from survey.optics.water.spectra import NM

MG_M3 = 1e-6
ROOM = 293.15
LASER = 532 * NM


@pytest.fixture(scope="module")
def waters():
    return OneParameterWaters(salinity=35.0, temperature=ROOM, particles=average_particle())


@pytest.mark.parametrize(
    ("absorption", "nm", "printed"),
    [
        (pure.pope_fry_absorption, 417.5, 0.00442),
        (pure.pope_fry_absorption, 550.0, 0.0565),
        (pure.pope_fry_absorption, 660.0, 0.410),
        (pure.pope_fry_absorption, 531.25, 0.5 * (0.0434 + 0.0447)),
        (pure.smith_baker_absorption, 400.0, 0.0171),
        (pure.smith_baker_absorption, 550.0, 0.0638),
        (pure.smith_baker_absorption, 700.0, 0.650),
    ],
)
def test_absorption_of_pure_water(absorption, nm, printed):
    assert absorption(wavelength=nm * NM) == pytest.approx(printed, rel=1e-12)


def test_absorption_at_the_laser():
    """Reference values at 532 nm: 0.0442 to 0.0445 1/m; the paper's is half of them."""
    assert pure.pope_fry_absorption(wavelength=LASER) == pytest.approx(0.0443, abs=2.5e-4)
    assert pure.PAPER_ABSORPTION / pure.pope_fry_absorption(wavelength=530 * NM) < 0.51


@pytest.mark.parametrize(("nm", "at_right_angle"), [(366.0, 4.50e-4), (578.0, 0.650e-4)])
def test_scattering_of_pure_water_zhang(nm, at_right_angle):
    """Zhang and Hu (2009), table 1: pure water at 20 degrees C, 90 degrees, 1/(m sr); 0.3 %."""
    total = pure.zhang_scattering(wavelength=nm * NM, salinity=0.0, temperature=ROOM)
    found = total * 3.0 / (8.0 * pi) * 1.039 / 2.039
    assert found == pytest.approx(at_right_angle, rel=3e-3)


def test_scattering_of_sea_water():
    """At 532 nm 1.96e-3 (Zhang) and 2.18e-3 1/m (Morel), fresh 1.51e-3 and 1.70e-3."""
    for salinity, zhang, morel in ((35.0, 1.96e-3, 2.18e-3), (0.0, 1.51e-3, 1.70e-3)):
        place = {"wavelength": LASER, "salinity": salinity}
        found = pure.zhang_scattering(temperature=ROOM, **place)
        assert found == pytest.approx(zhang, abs=5e-6)
        assert pure.morel_scattering(**place) == pytest.approx(morel, abs=5e-6)
    # Morel's sea water at 500 nm, as bio-optical programs carry it.
    sea = pure.morel_scattering(wavelength=500 * NM, salinity=37.0)
    assert sea == pytest.approx(2.88e-3, rel=3e-3)


def test_particles_and_yellow_substance():
    """a_p(440) = 0.052 C^0.635; exp(-0.014 d); b_p(550) = 0.30 C^0.62 and 0.416 C^0.766."""
    for c in (0.05, 1.0, 20.0):
        at_440 = {"wavelength": 440 * NM, "chlorophyll": c * MG_M3}
        at_550 = {"wavelength": 550 * NM, "chlorophyll": c * MG_M3}
        absorbed = constituents.bricaud_absorption(**at_440)
        assert absorbed == pytest.approx(0.052 * c**0.635, rel=1e-12)
        yellow = constituents.covarying_yellow_absorption(**at_440)
        assert yellow == pytest.approx(0.2 * absorbed, rel=1e-12)
        scattered = constituents.gordon_morel_scattering(**at_550)
        assert scattered == pytest.approx(0.30 * c**0.62, rel=1e-12)
        scattered = constituents.loisel_morel_scattering(**at_550)
        assert scattered == pytest.approx(0.416 * c**0.766, rel=1e-12)
    assert constituents.yellow_absorption(wavelength=540 * NM, at_440=2.0) == pytest.approx(
        2.0 * exp(-1.4), rel=1e-12
    )


def test_scattering_falls_with_wavelength():
    """1 / wavelength by Gordon and Morel; by Loisel and Morel only below 2 mg/m3."""
    one = {"chlorophyll": 1.0 * MG_M3}
    gordon, loisel = constituents.gordon_morel_scattering, constituents.loisel_morel_scattering
    ratio = gordon(wavelength=400 * NM, **one) / gordon(wavelength=700 * NM, **one)
    assert ratio == pytest.approx(7.0 / 4.0, rel=1e-12)
    ratio = loisel(wavelength=440 * NM, **one) / loisel(wavelength=550 * NM, **one)
    assert ratio == pytest.approx(0.8**-0.15, rel=1e-12)
    much = {"chlorophyll": 5.0 * MG_M3}
    assert loisel(wavelength=440 * NM, **much) == loisel(wavelength=550 * NM, **much)


def test_nothing_dissolved_adds_nothing():
    none = {"wavelength": LASER, "chlorophyll": 0.0}
    assert constituents.bricaud_absorption(**none) == 0.0
    assert constituents.gordon_morel_scattering(**none) == 0.0
    assert constituents.loisel_morel_scattering(**none) == 0.0


@pytest.mark.parametrize("nm", [399.0, 701.0])
@pytest.mark.parametrize(
    "relation",
    [
        lambda at: pure.pope_fry_absorption(wavelength=at),
        lambda at: pure.smith_baker_absorption(wavelength=at),
        lambda at: constituents.bricaud_absorption(wavelength=at, chlorophyll=MG_M3),
        lambda at: apparent.austin_petzold_attenuation(kd_490=0.1, wavelength=at),
    ],
)
def test_wavelengths_outside_the_tables_are_refused(relation, nm):
    with pytest.raises(ValueError, match=rf"{nm:g} nm is outside the table, 400 to 700 nm"):
        relation(nm * NM)


def test_the_papers_pure_water_is_green():
    pure.require_paper_wavelength(LASER)
    with pytest.raises(ValueError, match="520 nm is outside 525 to 535 nm"):
        pure.require_paper_wavelength(520 * NM)


def test_the_sum_of_components():
    """Coefficients add; the phase function is weighted by scattering, so b_b adds too."""
    parts = [
        Component(name="water", absorption=0.04, scattering=0.002, phase_function=molecular()),
        Component(
            name="particles", absorption=0.02, scattering=0.3, phase_function=average_particle()
        ),
        Component(name="yellow substance", absorption=0.01),
    ]
    mixture = Mixture(components=parts)
    water = mixture.water(refractive_index=1.34, group_index=1.36)
    assert water.absorption == pytest.approx(0.07, rel=1e-12)
    assert water.scattering == pytest.approx(0.302, rel=1e-12)
    assert water.attenuation == mixture.attenuation == pytest.approx(0.372, rel=1e-12)
    b_b = 0.5 * 0.002 + 0.3 * average_particle().backscatter_fraction
    assert mixture.backscattering == pytest.approx(b_b, rel=1e-6)
    share = water.phase_function.backscatter_fraction
    assert share * water.scattering == pytest.approx(b_b, rel=1e-5)


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [("clear", 0.118, 0.121), ("coastal", 0.186, 0.199), ("harbor", 0.44, 0.53)],
)
def test_diffuse_attenuation_of_petzolds_waters(name, low, high):
    """Lee's formula lies in the range that Monte Carlo gives, sun at the zenith [1/m]."""
    absorption, scattering = PAPER_COEFFICIENTS[name]
    b_b = scattering * petzold(name).backscatter_fraction
    found = apparent.lee_diffuse_attenuation(
        absorption=absorption, backscattering=b_b, sun_zenith=0.0
    )
    assert low <= found <= high


def test_low_sun_raises_the_absorbed_part():
    place = {"absorption": 0.1, "backscattering": 0.0}
    found = apparent.lee_diffuse_attenuation(sun_zenith=radians(40.0), **place)
    assert found == pytest.approx(0.1 * 1.2, rel=1e-12)


def test_attenuation_from_490_nm():
    """M and K_w as printed: at 490 nm itself, at 530 nm 0.6924 (K - 0.0224) + 0.0526."""
    found = apparent.austin_petzold_attenuation(kd_490=0.2, wavelength=490 * NM)
    assert found == pytest.approx(0.2, rel=1e-12)
    found = apparent.austin_petzold_attenuation(kd_490=0.2, wavelength=530 * NM)
    assert found == pytest.approx(0.6924 * 0.1776 + 0.0526, rel=1e-12)


@pytest.mark.parametrize("c", [0.03, 0.1, 0.3, 1.0, 3.0, 10.0])
def test_mixtures_against_measured_attenuation(waters, c):
    """K_d(490) = 0.0166 + 0.07242 C^0.68955 (Morel et al. 2007), measured apart: 20 %.

    And Austin and Petzold's K_d(532) from it: 12 %, Lee's largest error.
    """
    sun = radians(30.0)

    def attenuation(wavelength):
        mixture = waters.mixture(wavelength=wavelength, chlorophyll=c * MG_M3)
        return apparent.lee_diffuse_attenuation(
            absorption=mixture.absorption, backscattering=mixture.backscattering, sun_zenith=sun
        )

    at_490 = attenuation(490 * NM)
    assert at_490 == pytest.approx(0.0166 + 0.07242 * c**0.68955, rel=0.2)
    carried = apparent.austin_petzold_attenuation(kd_490=at_490, wavelength=LASER)
    assert carried == pytest.approx(attenuation(LASER), rel=0.12)


def test_secchi_depths():
    """(c + K_d) Z = 8.69; ln(0.135 / 0.013) / 2.5 = 0.936 over K_d."""
    found = apparent.tyler_secchi_depth(attenuation=0.398, diffuse_attenuation=0.19)
    assert found * (0.398 + 0.19) == pytest.approx(8.69, rel=1e-12)
    found = apparent.lee_secchi_depth(diffuse_attenuation=0.1, reflectance=0.005)
    assert found == pytest.approx(9.362, rel=1e-3)


def test_what_a_nephelometer_sees():
    """The spread of b / T is that of 1 / p(90 degrees) among measured and computed functions."""
    right_angle = 0.5 * np.pi
    average = float(average_particle().density(right_angle))
    assert surveyor.TURBIDITY_RATIOS["central"] == 1.0
    for word, share in (("low", 0.03), ("high", 0.01)):
        other = float(fournier_forand_of_backscatter(share).density(right_angle))
        assert average / other == pytest.approx(surveyor.TURBIDITY_RATIOS[word], rel=0.01)
    for name in ("coastal", "harbor"):
        ratio = average / float(petzold(name).density(right_angle))
        assert surveyor.TURBIDITY_RATIOS["low"] < ratio < surveyor.TURBIDITY_RATIOS["high"]


def figures(waters, chlorophyll, sun_zenith):
    """Work out what surveyors would measure in a mixture."""

    def at(wavelength):
        mixture = waters.mixture(wavelength=wavelength, chlorophyll=chlorophyll)
        kd = apparent.lee_diffuse_attenuation(
            absorption=mixture.absorption,
            backscattering=mixture.backscattering,
            sun_zenith=sun_zenith,
        )
        return mixture, kd

    eye, kd_eye = at(555 * NM)
    clearest, kd_least = min(
        (at(nm * NM) for nm in (443, 488, 532, 555, 665)), key=lambda pair: pair[1]
    )
    # Austin and Petzold's line turned round.
    laser_at = [apparent.austin_petzold_attenuation(kd_490=k, wavelength=LASER) for k in (0, 1)]
    return {
        "tyler": apparent.tyler_secchi_depth(
            attenuation=eye.attenuation, diffuse_attenuation=kd_eye
        ),
        "lee": apparent.lee_secchi_depth(
            diffuse_attenuation=kd_least,
            reflectance=apparent.lee_reflectance(
                absorption=clearest.absorption, backscattering=clearest.backscattering
            ),
        ),
        "kd": (at(LASER)[1] - laser_at[0]) / (laser_at[1] - laser_at[0]),
        "turbidity": 0.30 * (chlorophyll / MG_M3) ** 0.62,
    }


def inverted(figure, value, *, waters, sun_zenith, estimate="central"):
    if figure == "kd":
        return surveyor.chlorophyll_of_kd_490(
            value, wavelength=LASER, waters=waters, sun_zenith=sun_zenith, estimate=estimate
        )
    if figure == "turbidity":
        return surveyor.chlorophyll_of_turbidity(value, waters=waters, estimate=estimate)
    return surveyor.chlorophyll_of_secchi_depth(
        value, waters=waters, sun_zenith=sun_zenith, relation=figure, estimate=estimate
    )


@pytest.mark.parametrize("figure", ["tyler", "lee", "kd", "turbidity"])
@pytest.mark.parametrize("c", [0.1, 2.0, 30.0])
def test_figures_lead_back_to_their_water(waters, figure, c):
    sun = radians(25.0)
    value = figures(waters, c * MG_M3, sun)[figure]
    found = inverted(figure, value, waters=waters, sun_zenith=sun)
    assert found == pytest.approx(c * MG_M3, rel=1e-5)
    words = ("low", "central", "high")
    spread = [inverted(figure, value, waters=waters, sun_zenith=sun, estimate=e) for e in words]
    assert all(clear < turbid for clear, turbid in pairwise(spread))


@pytest.mark.parametrize(
    ("figure", "value", "text"),
    [
        ("tyler", 0.1, r"Secchi depth of 0\.1 m lies outside 0\.\d+ to \d+"),
        ("lee", 90.0, "Secchi depth of 90 m lies outside"),
        ("kd", 0.001, r"K_d\(490\) of 0\.001 1/m, at 532 nm 0\.039 1/m, lies outside"),
        ("turbidity", 500.0, "turbidity of 500 NTU lies outside"),
    ],
)
def test_figures_of_no_water_are_refused(waters, figure, value, text):
    with pytest.raises(ValueError, match=text):
        inverted(figure, value, waters=waters, sun_zenith=0.5)


def test_an_end_of_the_spread_stays_a_water(waters):
    """A K_d just above pure water's has no clearer water within its error: the clearest stands."""
    figure = {"waters": waters, "sun_zenith": 0.0}
    low = inverted("kd", 0.018, estimate="low", **figure)
    assert low == surveyor.CHLOROPHYLL_RANGE[0] < inverted("kd", 0.018, **figure)

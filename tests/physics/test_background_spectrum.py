"""The sun's spectrum through a filter."""

from __future__ import annotations

import pytest

from survey.optics.solar_spectrum import mean_solar_irradiance

PER_NM = 1e-9


def mean(wavelength_nm, width_nm):
    return PER_NM * mean_solar_irradiance(wavelength=wavelength_nm * 1e-9, width=width_nm * 1e-9)


def test_the_two_published_numbers():
    """1.958 W/(m2 nm) at 532.0 nm, 1.891 from 527 to 537 nm (ASTM G173-03)."""
    assert mean(532.0, 0.0) == pytest.approx(1.958, abs=5e-4)
    assert mean(532.0, 10.0) == pytest.approx(1.891, abs=5e-4)


def test_a_band_is_the_sum_of_its_parts():
    whole = mean(540.3, 17.7) * 17.7
    left, right = mean(540.3 - 4.425, 8.85) * 8.85, mean(540.3 + 4.425, 8.85) * 8.85
    assert left + right == pytest.approx(whole, rel=1e-9)


def test_the_whole_table():
    """380 to 760 nm of the source's column hold 631.461 W/m2."""
    assert mean(570.0, 380.0) * 380.0 == pytest.approx(631.461, abs=5e-4)


@pytest.mark.parametrize(("wavelength", "width"), [(532.0, 400.0), (380.0, 1.0), (532.0, -1.0)])
def test_a_band_beyond_the_table_is_refused(wavelength, width):
    with pytest.raises(ValueError, match="within 380 to 760 nm"):
        mean(wavelength, width)

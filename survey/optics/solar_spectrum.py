"""The sun's spectrum above the air."""

from __future__ import annotations

from importlib import resources

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

TABLED_NM = (380.0, 760.0)
TABLE = "astm_g173_extraterrestrial.csv"
PER_NM = 1e9  # W/(m2 nm) in W/m3


def mean_solar_irradiance(*, wavelength: float, width: float) -> float:
    """Mean solar constant E_perp in a band, by ASTM G173-03's extraterrestrial spectrum [W/m3].

    Linear between the tabled wavelengths (1 nm apart from 400 nm up), so that a narrow filter
    sees no Fraunhofer line narrower than that; the filter passes all of its band alike.

    Parameters
    ----------
    wavelength, width : float
        Middle and width of the band, within 380 to 760 nm; 0 is one wavelength [m].

    Raises
    ------
    ValueError
        When the band is negative or leaves the table.

    Examples
    --------
    >>> round(mean_solar_irradiance(wavelength=532e-9, width=0.0) * 1e-9, 3)  # W/(m2 nm)
    1.958
    >>> round(mean_solar_irradiance(wavelength=532e-9, width=10e-9) * 1e-9, 3)
    1.891
    """
    low, high = (wavelength - 0.5 * width) * 1e9, (wavelength + 0.5 * width) * 1e9
    first, last = TABLED_NM
    if not (width >= 0.0 and low >= first and high <= last):
        raise ValueError(
            f"solar spectrum: {low:g} to {high:g} nm is not a band within {first:g} to {last:g} nm"
        )
    tabled, irradiance = _table()
    if width == 0.0:
        return float(np.interp(low, tabled, irradiance)) * PER_NM
    inside = tabled[(tabled > low) & (tabled < high)]
    nodes = np.concatenate([[low], inside, [high]])
    mean = np.trapezoid(np.interp(nodes, tabled, irradiance), nodes) / (high - low)
    return float(mean) * PER_NM


def _table() -> tuple[FloatArray, FloatArray]:
    """Wavelengths [nm] and irradiance [W/(m2 nm)]."""
    file = resources.files("survey.optics") / "data" / TABLE
    with file.open(encoding="utf-8") as lines:
        rows = np.loadtxt(lines, delimiter=",", skiprows=1)
    return rows[:, 0], rows[:, 1]

"""Tables over wavelength in the folder of data."""

from __future__ import annotations

from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray

NM = 1e-9


def tabled(file_name: str, column: int, *, wavelength: float) -> float:
    """Return a column of a table at a wavelength [m], linear between its rows.

    Raises
    ------
    ValueError
        When the wavelength lies outside the table.

    Examples
    --------
    >>> round(tabled("pope_fry_1997.csv", 1, wavelength=532e-9), 4)
    0.0444
    """
    table = _read(file_name)
    first, last = table[0, 0], table[-1, 0]
    nm = wavelength / NM
    if not first - 1e-6 <= nm <= last + 1e-6:
        raise ValueError(f"{file_name}: {nm:g} nm is outside the table, {first:g} to {last:g} nm")
    return float(np.interp(nm, table[:, 0], table[:, column]))


@cache
def _read(file_name: str) -> NDArray[np.float64]:
    source = resources.files("survey.optics") / "data" / file_name
    with source.open(encoding="utf-8") as file:
        return np.loadtxt(file, delimiter=",", skiprows=1)

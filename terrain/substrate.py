"""What the bottom is made of: a name, a code for the points, a reflectance."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from pathlib import Path

TABLE = Path(__file__).parent / "data" / "substrates.csv"
WAVELENGTH = 532e-9  # [m] at which the table holds
UNLABELLED = 0
FIRST_OWN_CODE = 100
LAST_CODE = 255


@dataclass(frozen=True, kw_only=True)
class Substrate:
    """A kind of bottom.

    Parameters
    ----------
    code : int
        In the points' column ``substrate``, 0 to 255; 0 is a bottom without a label.
    name : str
    reflectance : float
        Diffuse, 0 to 1.
    """

    code: int
    name: str
    reflectance: float


@cache
def known_substrates() -> dict[str, Substrate]:
    """Return the substrates of the table by name, reflectances at 532 nm.

    Sources stand in ``terrain/data/SOURCES.md``.

    Examples
    --------
    >>> known_substrates()["sand"]
    Substrate(code=1, name='sand', reflectance=0.243)
    """
    with TABLE.open(encoding="utf-8", newline="") as file:
        return {
            row["name"]: Substrate(
                code=int(row["code"]), name=row["name"], reflectance=float(row["reflectance"])
            )
            for row in csv.DictReader(file)
        }

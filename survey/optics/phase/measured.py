"""Phase functions that were measured in the sea."""

from __future__ import annotations

from importlib import resources

import numpy as np

from survey.optics.phase.function import FloatArray, PhaseFunction
from survey.optics.phase.table import tabled_phase_function

PETZOLD_SLOPES = {"clear": -1.191, "coastal": -1.545, "harbor": -1.346}
PETZOLD_COLUMNS = {"clear": 1, "coastal": 2, "harbor": 3}
AVERAGE_PARTICLE_COLUMNS = {"web book": 1, "mobley 1993": 2}


def petzold(water: str) -> PhaseFunction:
    """Petzold's measured functions (SIO Ref. 72-78, 1972), log-log between the tabled angles.

    Parameters
    ----------
    water : {"clear", "coastal", "harbor"}
        AUTEC 8, HAOCE 11 or NUC 2040; below 0.1 degrees the report's power law.

    Examples
    --------
    >>> round(petzold("coastal").mean_cosine, 3), round(petzold("harbor").mean_cosine, 3)
    (0.947, 0.92)
    """
    angle, values = _table("petzold_vsf.csv", PETZOLD_COLUMNS[water])
    return tabled_phase_function(
        name=f"Petzold {water}",
        angle=angle,
        value=values,
        small_angle_slope=PETZOLD_SLOPES[water],
    )


def petzold_scattering(water: str) -> float:
    """Return the scattering coefficient that the table integrates to [1/m].

    Examples
    --------
    >>> [round(petzold_scattering(water), 4) for water in ("clear", "coastal", "harbor")]
    [0.0372, 0.2188, 1.8209]
    """
    angle, values = _table("petzold_vsf.csv", PETZOLD_COLUMNS[water])
    return float(values[-1] / petzold(water).density(angle[-1]))


def average_particle(edition: str = "web book") -> PhaseFunction:
    """Mobley's average of Petzold's particles, pure water removed; below 0.1 degrees as harbor.

    Parameters
    ----------
    edition : {"web book", "mobley 1993"}
        The Ocean Optics Web Book's table, or that of the 1993 model comparison (Mobley et al.,
        Applied Optics 32, 7484), which has an outlier at 0.5 degrees.

    Examples
    --------
    >>> round(average_particle().backscatter_fraction, 4)
    0.0183
    """
    angle, values = _table("petzold_average_particle.csv", AVERAGE_PARTICLE_COLUMNS[edition])
    return tabled_phase_function(
        name=f"average Petzold particle, {edition}",
        angle=angle,
        value=values,
        small_angle_slope=PETZOLD_SLOPES["harbor"],
    )


def _table(file_name: str, column: int) -> tuple[FloatArray, FloatArray]:
    source = resources.files("survey.optics") / "data" / file_name
    with source.open() as file:
        table = np.loadtxt(file, delimiter=",", skiprows=1)
    return np.radians(table[:, 0]), table[:, column]

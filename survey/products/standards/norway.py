"""The Norwegian Mapping Authority's rules for airborne lidar bathymetry."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from survey.products.standards.tables import read_table, values_of


@dataclass(frozen=True, kw_only=True)
class NorwegianRules:
    """What is asked of a delivered cloud.

    Parameters
    ----------
    title : str
        Of the specification.
    density : float
        Points of ground and seabed in a cell [1/m2].
    cell : float
        Side of a cell [m].
    cells : float
        Share of the cells that must be so dense [1].
    least_depth, largest_depth : float
        Depths of the cells that are judged [m].
    hole : float
        Area above which a hole needs a cause [m2].
    """

    title: str
    density: float
    cell: float
    cells: float
    least_depth: float
    largest_depth: float
    hole: float


@cache
def norwegian_rules() -> NorwegianRules:
    """Return the rules from their data file.

    Examples
    --------
    >>> rules = norwegian_rules()
    >>> rules.density * rules.cell**2
    20.0
    """
    table = read_table("norway.toml")
    figures = {
        name.removesuffix("_m2").removesuffix("_m"): v for name, v in values_of(table).items()
    }
    figures["density"] = figures.pop("density_per")
    return NorwegianRules(title=table["title"], **figures)

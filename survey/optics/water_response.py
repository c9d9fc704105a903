"""What a water sends back, from shipped tables or estimated from them by the K_d on the way."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import log, pi

import numpy as np
from numpy.typing import NDArray

from survey.optics.phase import petzold
from survey.optics.response_table import Illumination, ResponseTable, response_table
from survey.optics.water import PAPER_COEFFICIENTS, Water, WaterColumn, petzold_water
from survey.optics.water.apparent import diffuse_attenuation

FloatArray = NDArray[np.float64]

FAINTEST = 1e-300
CLOSE = 1e-6
SHALLOW = 1e-6  # [m]


@dataclass(frozen=True, kw_only=True)
class WaterResponse:
    """A water's response and where it comes from.

    Parameters
    ----------
    table : ResponseTable
    basis : str
        In words.
    is_estimate : bool
        True unless the water is one that was traced.
    """

    table: ResponseTable
    basis: str
    is_estimate: bool


def water_response(water: WaterColumn, illumination: Illumination) -> WaterResponse:
    """Return the response of a water: its table, or one made of all tables by its K_d.

    To each depth z belongs the water above it: its integral of K_d, by Lee et al. (2005) under a
    sun in the zenith, and its b / a. The tables are read where their water has the same K_d z,
    mixed in logarithms as b / a lies between theirs, and the column is scaled by b p(180 deg) of
    the water at z. Uniform coastal water, made so from the other two, is right to 7 % in the depth
    from which as much light comes back; its column comes out up to 3 times too bright.
    Through layers (a plume of 1.5 m on clear water, sediment of 1.5 m under coastal water, two
    others) the bottom's light was right to 20 %, the column's to a factor of 2 down to the end of a
    layer and of 2.6 below it.

    Parameters
    ----------
    water : WaterColumn
    illumination : {"flood", "isolated"}
        An isolated pixel is 2 x 2 m in all tables.

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> coastal = petzold_water("coastal", refractive_index=1.34, group_index=1.36)
    >>> found = water_response(WaterColumn.uniform(coastal), "flood")
    >>> found.is_estimate, f"{found.table.two_way_at(np.array([20.0]))[0]:.2e}"
    (False, '4.39e-04')
    """
    for name in PAPER_COEFFICIENTS:
        if water.is_uniform and _is_named(water.surface, name):
            return WaterResponse(
                table=response_table(name, illumination),
                basis=f"traced, table of {name} water",
                is_estimate=False,
            )
    surface = f"{diffuse_attenuation(water.surface):.3g} 1/m"
    return WaterResponse(
        table=_estimate(water, illumination),
        basis=f"estimate from K_d = {surface} and the tables of named waters"
        if water.is_uniform
        else f"estimate from the K_d of {len(water.layers)} layers, {surface} under the surface, "
        "and the tables of named waters",
        is_estimate=True,
    )


def _is_named(water: Water, name: str) -> bool:
    coefficients = (water.absorption, water.scattering)
    return (
        np.allclose(coefficients, PAPER_COEFFICIENTS[name], rtol=CLOSE)
        and water.phase_function.name == petzold(name).name
    )


def named_shares(water: WaterColumn, depth: FloatArray) -> dict[str, FloatArray]:
    """Return how far the water above depths (n,) [m] is each named water, by its b / a, (n,) [1].

    In proportion to ln(b / a) between two of them; beyond the last it is the last.

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> clear = petzold_water("clear", refractive_index=1.34, group_index=1.36, scattering=0.1)
    >>> shares = named_shares(WaterColumn.uniform(clear), np.array([5.0]))
    >>> {name: round(float(share[0]), 2) for name, share in shares.items()}
    {'clear': 0.25, 'coastal': 0.75, 'harbor': 0.0}
    """
    above = np.maximum(depth, SHALLOW)
    scattered, absorbed = (
        np.maximum(gone(above), FAINTEST) for gone in (water.scattered, water.absorbed)
    )
    names = sorted(PAPER_COEFFICIENTS, key=_named_ratio)
    places = [_named_ratio(name) for name in names]
    place = np.interp(np.log(scattered / absorbed), places, np.arange(len(names)))
    return {
        name: np.maximum(1.0 - np.abs(place - number), 0.0) for number, name in enumerate(names)
    }


def _named_ratio(name: str) -> float:
    absorption, scattering = PAPER_COEFFICIENTS[name]
    return log(scattering / absorption)


def named_depth(water: WaterColumn, depth: FloatArray, name: str) -> FloatArray:
    """Return at which depths a named water has the K_d z of a water at depths [m]."""
    return water.integral(depth, diffuse_attenuation) / diffuse_attenuation(_named(name))


@cache
def _named(name: str) -> Water:
    return petzold_water(name, refractive_index=1.34, group_index=1.36)


def _estimate(water: WaterColumn, illumination: Illumination) -> ResponseTable:
    tables = {name: response_table(name, illumination) for name in PAPER_COEFFICIENTS}
    grid = tables["clear"]
    depth = _as_deep(water, grid.depth)
    edges = np.union1d(_as_deep(water, grid.column_edges), [layer.top for layer in water.layers])
    middle = 0.5 * (edges[1:] + edges[:-1])
    two_way, column = np.zeros(depth.shape), np.zeros(middle.shape)
    shares, above = (named_shares(water, at) for at in (depth, middle))
    for name, table in tables.items():
        two_way += shares[name] * np.log(table.two_way_at(named_depth(water, depth, name)))
        seen = table.column_at(named_depth(water, middle, name)) / _backscatter(_named(name))
        column += above[name] * np.log(seen)
    backscatter = np.array([_backscatter(water.at(z)) for z in middle])
    late_edges = grid.late_edges * depth[-1] / grid.depth[-1]
    return ResponseTable(
        depth=depth,
        two_way=np.exp(two_way),
        late_edges=late_edges,
        late_share=_late_shares(water, tables, depth, late_edges),
        column_edges=edges,
        column=backscatter * np.exp(column),
    )


def _as_deep(water: WaterColumn, clear_depth: FloatArray) -> FloatArray:
    """Return at which depths a water has the K_d z of clear water at depths [m]."""
    tops = np.array([layer.top for layer in water.layers])
    last = max(diffuse_attenuation(water.layers[-1].water), FAINTEST)
    at_tops = named_depth(water, tops, "clear")
    beyond = np.maximum(clear_depth - at_tops[-1], 0.0) * diffuse_attenuation(_named("clear"))
    return np.asarray(np.interp(clear_depth, at_tops, tops) + beyond / last)


def _late_shares(
    water: WaterColumn,
    tables: dict[str, ResponseTable],
    depth: FloatArray,
    edges: FloatArray,
) -> FloatArray:
    """Return how the light of bottoms at depths is spread over ``edges`` (depths, late)."""
    late = np.zeros((len(depth), len(edges) - 1))
    shares = named_shares(water, depth)
    for name, table in tables.items():
        alike = named_depth(water, depth, name)
        for row, (share, z, named) in enumerate(zip(shares[name], depth, alike, strict=True)):
            stretch = z / named if named > 0.0 else 1.0
            late[row] += share * _on_edges(table, float(named), float(stretch), edges)
    return late


def _on_edges(table: ResponseTable, depth: float, stretch: float, edges: FloatArray) -> FloatArray:
    """Return the lateness at a depth, stretched, on other edges; later light is in the last."""
    gathered = np.concatenate([[0.0], np.cumsum(table.late_share_at(depth))])
    at = np.interp(edges, stretch * table.late_edges, gathered)
    at[-1] = gathered[-1]
    return np.asarray(np.diff(at))


def _backscatter(water: Water) -> float:
    """Return the volume scattering at 180 degrees [1/(m sr)]."""
    return water.scattering * float(water.phase_function.density(pi))

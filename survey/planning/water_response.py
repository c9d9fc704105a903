"""What a uniform water sends back, from shipped tables or estimated from them by its K_d."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi

import numpy as np
from numpy.typing import NDArray

from survey.optics.phase import petzold
from survey.optics.water import PAPER_COEFFICIENTS, Water
from survey.planning.response_table import Illumination, ResponseTable, response_table
from survey.products.reach import WaterClarity

FloatArray = NDArray[np.float64]

FAINTEST = 1e-300
CLOSE = 1e-6


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


def water_response(water: Water, illumination: Illumination) -> WaterResponse:
    """Return the response of a water: its table, or one stretched by K_d between two tables.

    Water that is none of the three lies between two of them by b / a. Their depths are stretched
    by K_d of Lee et al. (2005), sun in the zenith, their columns scaled by b p(180 deg), and both
    mixed in proportion to ln(b / a). Coastal water, made so from the other two, is right to 7 % in
    the depth from which as much light comes back; its column comes out up to 3 times too bright.

    Parameters
    ----------
    water : Water
    illumination : {"flood", "isolated"}
        An isolated pixel is 2 x 2 m in all tables.

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> found = water_response(
    ...     petzold_water("coastal", refractive_index=1.34, group_index=1.36), "flood")
    >>> found.is_estimate, f"{found.table.two_way_at(np.array([20.0]))[0]:.2e}"
    (False, '4.39e-04')
    """
    for name in PAPER_COEFFICIENTS:
        if _is_named(water, name):
            return WaterResponse(
                table=response_table(name, illumination),
                basis=f"traced, table of {name} water",
                is_estimate=False,
            )
    below, above, share = neighbours(water)
    tables = (_alike(name, water, illumination) for name in (below, above))
    return WaterResponse(
        table=_mixed(*tables, share=share),
        basis=f"estimate from K_d = {_attenuation(water):.3g} 1/m and the tables of {below} and "
        f"{above} water",
        is_estimate=True,
    )


def _is_named(water: Water, name: str) -> bool:
    coefficients = (water.absorption, water.scattering)
    return (
        np.allclose(coefficients, PAPER_COEFFICIENTS[name], rtol=CLOSE)
        and water.phase_function.name == petzold(name).name
    )


def neighbours(water: Water) -> tuple[str, str, float]:
    """Return the named waters to both sides by b / a, and how far a water lies to the second.

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> below, above, share = neighbours(
    ...     petzold_water("clear", refractive_index=1.34, group_index=1.36, scattering=0.1))
    >>> below, above, round(share, 2)
    ('clear', 'coastal', 0.75)
    """
    names = sorted(PAPER_COEFFICIENTS, key=_named_ratio)
    places = [_named_ratio(name) for name in names]
    ratio = log(max(water.scattering, FAINTEST) / max(water.absorption, FAINTEST))
    place = float(np.interp(ratio, places, range(len(names))))
    low = min(int(place), len(names) - 2)
    return names[low], names[low + 1], place - low


def _named_ratio(name: str) -> float:
    absorption, scattering = PAPER_COEFFICIENTS[name]
    return log(scattering / absorption)


def _alike(name: str, water: Water, illumination: Illumination) -> ResponseTable:
    """Return a named water's table stretched to the K_d and the backscatter of a water."""
    absorption, scattering = PAPER_COEFFICIENTS[name]
    phase = petzold(name)
    named = Water(
        absorption=absorption,
        scattering=scattering,
        phase_function=phase,
        refractive_index=water.refractive_index,
        group_index=water.group_index,
    )
    return response_table(name, illumination).stretched(
        shrink=_attenuation(water) / _attenuation(named),
        backscatter=_backscatter(water) / _backscatter(named),
    )


def _attenuation(water: Water) -> float:
    """Return K_d [1/m]."""
    return WaterClarity.of(water).diffuse_attenuation


def _backscatter(water: Water) -> float:
    """Return the volume scattering at 180 degrees [1/(m sr)]."""
    return water.scattering * float(water.phase_function.density(pi))


def _mixed(one: ResponseTable, other: ResponseTable, *, share: float) -> ResponseTable:
    """Return the table between two, in logarithms, on the depths of the first."""
    middle = 0.5 * (one.column_edges[1:] + one.column_edges[:-1])
    columns = one.column_at(middle), other.column_at(middle)
    transmissions = one.two_way, other.two_way_at(one.depth)
    late = np.array([_on_edges(other, depth, one.late_edges) for depth in one.depth])
    return ResponseTable(
        depth=one.depth,
        two_way=_between(*transmissions, share),
        late_edges=one.late_edges,
        late_share=(1.0 - share) * one.late_share + share * late,
        column_edges=one.column_edges,
        column=_between(*columns, share),
    )


def _between(one: FloatArray, other: FloatArray, share: float) -> FloatArray:
    return np.asarray(one ** (1.0 - share) * other**share)


def _on_edges(table: ResponseTable, depth: float, edges: FloatArray) -> FloatArray:
    """Return the lateness at a depth on other edges; what is later falls into the last."""
    gathered = np.concatenate([[0.0], np.cumsum(table.late_share_at(depth))])
    at = np.interp(edges, table.late_edges, gathered)
    at[-1] = gathered[-1]
    return np.asarray(np.diff(at))

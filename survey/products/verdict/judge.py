"""The verdict over a mission: every order of S-44, and the Norwegian rules."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.products.coverage import OUTSIDE_AREA, CoverageMap
from survey.products.standards import NorwegianRules, Order, norwegian_rules, orders
from survey.products.standards.orders import s44_title
from survey.products.verdict.criterion import Criterion, percent, verdict
from survey.products.verdict.density import DensityTally
from survey.products.verdict.extent import judge_coverage, judge_features
from survey.products.verdict.features import FoundCube
from survey.products.verdict.passes import Passes
from survey.products.verdict.tally import OrderTally
from survey.products.verdict.uncertainty import judge_errors


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """What was counted over a mission, and is judged by every order.

    Parameters
    ----------
    errors : OrderTally
    passes : Passes
    coverage : CoverageMap
        On the cells of `passes`.
    cubes : sequence of FoundCube
        Those in the survey area, under water.
    density : DensityTally
    density_depth : array (rows, columns)
        True depth of its cells [m]; nan outside the survey area.
    water_level : float
        [m].
    """

    errors: OrderTally
    passes: Passes
    coverage: CoverageMap
    cubes: Sequence[FoundCube]
    density: DensityTally
    density_depth: NDArray[np.float32]
    water_level: float


def judge_s44(evidence: Evidence, *, asked: str | None) -> dict[str, Any]:
    """Return the verdict by every order of S-44 as plain values.

    ``judged`` names the order that reports speak of: the one asked for; without one the strictest
    that passes, or Order 2 where none does.

    Parameters
    ----------
    evidence : Evidence
    asked : str or None
        Key of an order.
    """
    found = {key: _by_order(evidence, order) for key, order in orders().items()}
    passed = [key for key, result in found.items() if result["result"] == "pass"]
    return {
        "standard": s44_title(),
        "asked": asked,
        "judged": asked or (passed[0] if passed else list(found)[-1]),
        "orders": found,
    }


def _by_order(evidence: Evidence, order: Order) -> dict[str, Any]:
    passes, coverage = evidence.passes, evidence.coverage
    hole = order.feature or 0.0
    criteria = {
        "tvu": judge_errors(evidence.errors, order, "tvu"),
        "thu": judge_errors(evidence.errors, order, "thu"),
        "coverage": judge_coverage(passes, coverage, asked=order.coverage, hole=hole),
        "feature_search": judge_coverage(passes, coverage, asked=order.feature_search, hole=hole),
        "feature_detection": judge_features(
            evidence.cubes, order, water_level=evidence.water_level
        ),
    }
    return {"title": order.title, **verdict(criteria)}


def judge_norway(evidence: Evidence) -> dict[str, Any]:
    """Return the verdict by the Norwegian rules as plain values."""
    rules = norwegian_rules()
    criteria = {"density": _density(evidence, rules), "holes": _holes(evidence.coverage, rules)}
    return {"standard": rules.title, **verdict(criteria)}


def _density(evidence: Evidence, rules: NorwegianRules) -> Criterion:
    depth = evidence.density_depth
    dense = evidence.density.density() >= rules.density
    judged = (depth >= rules.least_depth) & (depth <= rules.largest_depth)
    at_all_depths = percent(float(dense[depth > 0.0].mean())) if (depth > 0.0).any() else "none"
    everywhere = f"; at all depths {at_all_depths}"
    asked = f"{rules.density:g} points a square metre"
    if not judged.any():
        reason = (
            f"no cell lies {rules.least_depth:g} to {rules.largest_depth:g} m deep, where "
            f"{asked} are counted{everywhere} of the cells hold them"
        )
        return Criterion(result="not assessable", figure=None, limit=rules.cells, reason=reason)
    share = float(dense[judged].mean())
    reason = (
        f"{percent(share)} of {int(judged.sum())} cells {rules.least_depth:g} to "
        f"{rules.largest_depth:g} m deep hold {asked}{everywhere}"
    )
    good = share >= rules.cells
    return Criterion(
        result="pass" if good else "fail", figure=share, limit=rules.cells, reason=reason
    )


def _holes(coverage: CoverageMap, rules: NorwegianRules) -> Criterion:
    area = float((~coverage.covered & (coverage.state != OUTSIDE_AREA)).sum())
    area *= coverage.cells.cell_size**2
    reason = (
        f"{area:.0f} m2 of holes; those over {rules.hole:g} m2 stand in coverage.geojson, "
        "each with its cause"
    )
    return Criterion(result="pass", figure=area, limit=None, reason=reason)


def cubes_in_area(
    cubes: Sequence[FoundCube], coverage: CoverageMap, origin: Any, level: float
) -> list[FoundCube]:
    """Return the cubes whose middle lies in the survey area and whose top is under water."""
    kept = []
    for cube in cubes:
        place = np.array([[cube.cube.east, cube.cube.north]]) + origin[:2]
        if not coverage.cells.contains(place)[0] or cube.top >= level:
            continue
        if coverage.state.ravel()[coverage.cells.index_of(place)[0]] != OUTSIDE_AREA:
            kept.append(cube)
    return kept

"""How much of the area was seen, and whether cubes were, against what an order asks."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.products.coverage import CoverageMap
from survey.products.standards import Order
from survey.products.verdict.criterion import Criterion, not_asked, percent, rounded
from survey.products.verdict.features import ENOUGH_POINTS, FoundCube
from survey.products.verdict.passes import Passes

OWN_SIZE = 1.25
"""Assumed: a cube up to so many times the order's side speaks for the order's own [1]."""


def judge_coverage(
    passes: Passes, coverage: CoverageMap, *, asked: float | None, hole: float
) -> Criterion:
    """Judge which share of the wet survey area was seen as often as asked.

    "Full" is taken to mean that no gap has room for a square of side ``hole`` [m], the cube that
    the order asks for: S-44 has no tolerance for single depths that are missing.

    Parameters
    ----------
    passes : Passes
    coverage : CoverageMap
        Why a cell was not seen; on the same cells.
    asked : float or None
        Share [1]; 2 is everywhere twice.
    hole : float
        [m].
    """
    if asked is None:
        return not_asked()
    if not passes.wet.any():
        return Criterion(
            result="not assessable", figure=None, limit=asked, reason="no water in the survey area"
        )
    times = max(ceil(asked), 1)
    full = asked >= 1.0
    missing = passes.missing(times=times, hole=hole if full else 0.0)
    share = passes.share(missing)
    causes = missing_by_cause(missing, passes, coverage)
    seen = "" if times == 1 else f" {times} times"
    reason = f"{percent(share)} of the wet area was seen{seen}"
    if full and hole > passes.cells.cell_size:
        reason += f" or lies in gaps narrower than {hole:g} m"
    if causes:
        listed = ", ".join(f"{cause} {percent(part)}" for cause, part in causes.items())
        reason += f"; not seen: {listed}"
    return Criterion(
        result="pass" if share >= min(asked, 1.0) else "fail",
        figure=share,
        limit=min(asked, 1.0),
        reason=reason,
        details={"times": times, "missing": {cause: rounded(s) for cause, s in causes.items()}},
    )


def missing_by_cause(
    missing: NDArray[np.bool_], passes: Passes, coverage: CoverageMap
) -> dict[str, float]:
    """Return the share of the wet area that is missing, by cause, the commonest first."""
    seen_once = missing & (passes.frames > 0)
    parts: dict[str, float] = {"seen too few times": float(seen_once.sum())}
    for state in np.unique(coverage.state[missing & ~seen_once]).tolist():
        name = coverage.cause(state).replace("_", " ")
        parts[name] = float((missing & ~seen_once & (coverage.state == state)).sum())
    wet = float(passes.wet.sum())
    ordered = sorted(parts.items(), key=lambda part: -part[1])
    return {name: count / wet for name, count in ordered if count > 0.0}


def judge_features(cubes: Sequence[FoundCube], order: Order, *, water_level: float) -> Criterion:
    """Judge whether cubes of the order's size, or larger, stand out of the cloud.

    A cube is found when at least `ENOUGH_POINTS` bottom points in its outline lie above half its
    height. Every cube must be found that is no smaller than the order's. One of the order's own
    size, up to `OWN_SIZE` times, or a smaller one must be among those found: larger ones can fail
    the order but not pass it.

    Parameters
    ----------
    cubes : sequence of FoundCube
        Those in the survey area.
    order : Order
    water_level : float
        [m].
    """
    if order.feature is None:
        return not_asked()
    sized = [(cube, order.feature_at(water_level - cube.bed) or 0.0) for cube in cubes]
    asked = [cube for cube, size in sized if cube.cube.side >= size - 1e-9]
    speak = [cube for cube, size in sized if cube.found and cube.cube.side <= OWN_SIZE * size]
    judged = asked + [cube for cube in speak if cube not in asked]
    details = {"cubes": [_as_json(cube, order, water_level) for cube in judged]}
    lost = [cube for cube in judged if not cube.found]
    if lost:
        few = ", ".join(f"{cube.cube.side:g} m with {_points(cube)}" for cube in lost)
        reason = f"{len(lost)} of {len(judged)} cubes lost: {few} on it, {ENOUGH_POINTS} are asked"
        share = 1.0 - len(lost) / len(judged)
        return Criterion(result="fail", figure=share, limit=1.0, reason=reason, details=details)
    if not speak:
        reason = f"no cube of {order.feature:g} m lies in the survey area"
        return Criterion(
            result="not assessable", figure=None, limit=1.0, reason=reason, details=details
        )
    sides = ", ".join(f"{cube.cube.side:g} m by {_points(cube)}" for cube in judged)
    return Criterion(
        result="pass", figure=1.0, limit=1.0, reason=f"cubes found: {sides}", details=details
    )


def _points(cube: FoundCube) -> str:
    return f"{cube.points} point{'' if cube.points == 1 else 's'}"


def _as_json(cube: FoundCube, order: Order, water_level: float) -> dict[str, Any]:
    return {
        "side_m": cube.cube.side,
        "depth_of_bed_m": rounded(water_level - cube.bed),
        "points": cube.points,
        "found": cube.found,
        "least_depth_error_m": None if cube.highest is None else rounded(cube.highest - cube.top),
        "least_depth_limit_m": rounded(float(order.tvu(water_level - cube.top))),
    }

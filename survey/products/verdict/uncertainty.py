"""Vertical and horizontal errors against what an order allows at each depth."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from survey.products.standards import Order
from survey.products.standards.orders import WITHIN
from survey.products.verdict.criterion import Criterion, percent, rounded
from survey.products.verdict.tally import BIN, ENOUGH, OrderTally, interval, percentile

IntArray = NDArray[np.int64]
Kind = Literal["tvu", "thu"]


def judge_errors(tally: OrderTally, order: Order, kind: Kind) -> Criterion:
    """Judge errors of one kind: in every range of depth 95 % must lie within the order's limit.

    The limit is that at each point's own depth. Fewer than `ENOUGH` points in all cannot show it.
    """
    within = tally.within_tvu if kind == "tvu" else tally.within_thu
    if tally.points.sum() < ENOUGH:
        count = int(tally.points.sum())
        reason = f"{count} bottom points; {ENOUGH} are the fewest that can show 95 %"
        return Criterion(result="not assessable", figure=None, limit=WITHIN, reason=reason)
    bins = [
        _range(tally, order, kind, within[order.key], first, last) for first, last in tally.ranges()
    ]
    worst = min(bins, key=badness)
    failed = [row for row in bins if row["share"] < WITHIN]
    return Criterion(
        result="fail" if failed else "pass",
        figure=worst["share"],
        limit=WITHIN,
        reason=_reason(worst, failed, kind),
        details={"by_depth": bins},
    )


def _range(
    tally: OrderTally, order: Order, kind: Kind, within: IntArray, first: int, last: int
) -> dict[str, Any]:
    part = slice(first, last)
    points, inside = int(tally.points[part].sum()), int(within[part].sum())
    low, high = interval(inside, points)
    row = {
        "from_depth_m": first * BIN,
        "to_depth_m": last * BIN,
        "points": points,
        "share": rounded(inside / points),
        "share_95_low": rounded(low),
        "share_95_high": rounded(high),
        "limit_m": rounded(float((order.tvu if kind == "tvu" else order.thu)(first * BIN))),
    }
    if kind == "thu":
        return row
    mean = float(tally.error[part].sum()) / points
    square = float(tally.error_squared[part].sum()) / points
    return row | {
        "p95_abs_error_m": percentile(tally.vertical[part].sum(axis=0), 0.95),
        "bias_m": rounded(mean),
        "spread_m": rounded(float(np.sqrt(max(square - mean**2, 0.0)))),
        "false_bottoms": int(tally.false_bottoms[part].sum()),
    }


def _reason(worst: dict[str, Any], failed: list[dict[str, Any]], kind: Kind) -> str:
    what = "depth" if kind == "tvu" else "place"
    text = (
        f"at {depth_range(worst)} {percent(worst['share'])} of {worst['points']} points lie within "
        f"{worst['limit_m']:.2f} m of the true {what}"
    )
    if not failed:
        return text
    text += "; 95 % are asked"
    if kind == "thu":
        return text
    cause = f"bias {worst['bias_m']:+.2f} m, spread {worst['spread_m']:.2f} m"
    return f"{text}: {cause}, {worst['false_bottoms']} false bottoms there"


def badness(row: dict[str, Any]) -> tuple[float, float]:
    """Return what sorts ranges of depth from the worst to the best."""
    p95 = row.get("p95_abs_error_m")
    return row["share"], -(np.inf if p95 is None else p95 / row["limit_m"])


def depth_range(row: dict[str, Any]) -> str:
    """Return a range of depth in words.

    Examples
    --------
    >>> depth_range({"from_depth_m": 7.0, "to_depth_m": 8.0})
    '7 to 8 m'
    """
    return f"{row['from_depth_m']:.0f} to {row['to_depth_m']:.0f} m"

"""The verdict in words: a few lines for the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from survey.products.verdict.uncertainty import badness, depth_range

CRITERIA = {
    "tvu": "depth error (TVU)",
    "thu": "place error (THU)",
    "coverage": "bathymetric coverage",
    "feature_search": "feature search",
    "feature_detection": "feature detection",
}


def judged(metrics: Mapping[str, Any]) -> dict[str, Any]:
    """Return the verdict of the order that is spoken of."""
    s44 = metrics["s44"]
    found: dict[str, Any] = s44["orders"][s44["judged"]]
    return found


def verdict_sentence(order: Mapping[str, Any]) -> str:
    """Return an order's verdict in one sentence.

    Examples
    --------
    >>> verdict_sentence({"title": "Order 1a", "result": "fail", "failed": ["tvu"],
    ...                   "not_assessable": ["feature_detection"]})
    'Order 1a fails: depth error (TVU); not assessable: feature detection'
    """
    failed = ", ".join(CRITERIA[name] for name in order["failed"])
    unknown = ", ".join(CRITERIA[name] for name in order["not_assessable"])
    if order["result"] == "not assessable":
        return f"{order['title']} is not assessable"
    text = f"{order['title']} fails: {failed}" if failed else f"{order['title']} passes"
    if unknown and not failed:
        text += " on all that is assessable"
    return f"{text}; not assessable: {unknown}" if unknown else text


def verdict_lines(metrics: Mapping[str, Any]) -> tuple[str, ...]:
    """Return errors, coverage and depth reached, each against the order, in a line of its own.

    Where no order was asked for, one more line says what keeps the next stricter one from passing.
    """
    order = judged(metrics)
    return (
        f"{verdict_sentence(order)}. {_errors(order['criteria']['tvu'])}",
        *_stricter(metrics["s44"]),
        f"coverage: {_coverage(order['criteria'])}",
        f"bottom reached {_reached(metrics)}",
    )


def _errors(tvu: Mapping[str, Any]) -> str:
    if "by_depth" not in tvu:
        return f"{tvu['reason']}"
    worst = min(tvu["by_depth"], key=badness)
    p95 = worst["p95_abs_error_m"]
    within = "not even within 5 m" if p95 is None else f"within {p95:.2f} m"
    how = "come nearest to" if tvu["result"] == "pass" else "are furthest beyond"
    return (
        f"Depth errors {how} its limit at {depth_range(worst)}: 95 % of {worst['points']} points "
        f"{within}, {worst['limit_m']:.2f} m allowed"
    )


def _stricter(s44: Mapping[str, Any]) -> list[str]:
    """Return why the order before the one that passed does not pass."""
    keys = list(s44["orders"])
    place = keys.index(s44["judged"])
    if s44["asked"] or place == 0 or s44["orders"][s44["judged"]]["result"] != "pass":
        return []
    order = s44["orders"][keys[place - 1]]
    unmet = [*order["failed"], *order["not_assessable"]]
    reasons = "; ".join(str(order["criteria"][name]["reason"]) for name in unmet)
    return [f"{verdict_sentence(order)}: {reasons}"]


def _coverage(criteria: Mapping[str, Any]) -> str:
    search = criteria["feature_search"]
    return str((criteria["coverage"] if search["limit"] is None else search)["reason"])


def _reached(metrics: Mapping[str, Any]) -> str:
    depth = metrics["found_depth_m"]
    if depth is None:
        return "by nine pixels in ten at no depth"
    return (
        f"by nine pixels in ten down to {depth:.1f} m: {metrics['found_depth_secchi']:.2f} Secchi "
        f"depths (of {metrics['secchi_depth_m']:.1f} m), K_d z {metrics['found_depth_k_d_z']:.2f}"
    )

"""The costs of effects as lines of a Markdown table, and as plain values for JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from survey.effects.costs import AS_IT_IS, FIGURES, Cost

DECIMALS = 6
COLUMNS = ("r.m.s. m", "bias m", "sideways m", "lost %", "false %")
DIGITS = (3, 3, 3, 2, 2)


def heading() -> str:
    """Return the first two lines of the table."""
    return "\n".join([_line(["without", *COLUMNS]), _line(["---"] * (len(COLUMNS) + 1))])


def row(cost: Cost) -> str:
    """Return the line of a mission: each figure, and its change with the standard error.

    Examples
    --------
    >>> value, error = np.array([0.2, -0.1, 0.3, 5.0, np.nan]), np.full(5, 0.01)
    >>> row(Cost(without="waves", value=value, error=error, change=-value, change_error=error))
    '| waves | 0.200 (-0.200 ± 0.010) | -0.100 (+0.100 ± 0.010) | 0.300 (-0.300 ± 0.010) |
    5.00 (-5.00 ± 0.01) | - |'
    """
    as_it_is = cost.without == AS_IT_IS
    cells = [
        _cell(*figures, digits=digits, as_it_is=as_it_is)
        for *figures, digits in zip(
            cost.value, cost.error, cost.change, cost.change_error, DIGITS, strict=True
        )
    ]
    return _line([cost.without, *cells])


def _cell(
    value: float, error: float, change: float, change_error: float, *, digits: int, as_it_is: bool
) -> str:
    if not np.isfinite(value):
        return "-"
    if as_it_is:
        return f"{value:.{digits}f} ± {error:.{digits}f}"
    return f"{value:.{digits}f} ({change:+.{digits}f} ± {change_error:.{digits}f})"


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def as_json(cost: Cost) -> dict[str, Any]:
    """Return the figures by name, each with its standard error and its change; None for none."""
    return {"without": cost.without} | {
        name: {
            "value": _number(cost.value[i]),
            "standard_error": _number(cost.error[i]),
            "change": _number(cost.change[i]),
            "change_standard_error": _number(cost.change_error[i]),
        }
        for i, name in enumerate(FIGURES)
    }


def _number(value: float) -> float | None:
    return round(float(value), DECIMALS) if np.isfinite(value) else None

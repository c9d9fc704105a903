"""One criterion of a standard and what came of it; the verdict over all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Result = Literal["pass", "fail", "not assessable"]


@dataclass(frozen=True, kw_only=True)
class Criterion:
    """What was asked, what was measured, and why the one meets the other or does not.

    Parameters
    ----------
    result : str
        "pass", "fail" or "not assessable".
    figure, limit : float or None
        What was measured and what is asked, in the same unit; None where there is no such figure.
    reason : str
        In words.
    details : mapping
        Plain values for JSON.
    """

    result: Result
    figure: float | None
    limit: float | None
    reason: str
    details: Mapping[str, Any] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            "result": self.result,
            "figure": rounded(self.figure),
            "limit": rounded(self.limit),
            "reason": self.reason,
            **self.details,
        }


def not_asked() -> Criterion:
    """Return the criterion of an order that asks nothing of the kind."""
    return Criterion(result="pass", figure=None, limit=None, reason="not asked")


def verdict(criteria: Mapping[str, Criterion]) -> dict[str, Any]:
    """Return the verdict over criteria as plain values.

    ``result`` is "fail" if any fails, "not assessable" if none can be judged, else "pass"; what
    could not be judged is listed and never counts as passed.

    Examples
    --------
    >>> good = Criterion(result="pass", figure=1.0, limit=0.95, reason="all within")
    >>> unknown = Criterion(result="not assessable", figure=None, limit=1.0, reason="no cube")
    >>> found = verdict({"tvu": good, "feature_detection": unknown})
    >>> found["result"], found["not_assessable"]
    ('pass', ['feature_detection'])
    """
    results = {name: criterion.result for name, criterion in criteria.items()}
    failed = [name for name, result in results.items() if result == "fail"]
    unknown = [name for name, result in results.items() if result == "not assessable"]
    judged = len(unknown) < len(results)
    return {
        "result": "fail" if failed else "pass" if judged else "not assessable",
        "failed": failed,
        "not_assessable": unknown,
        "criteria": {name: criterion.as_json() for name, criterion in criteria.items()},
    }


def rounded(value: float | None) -> float | None:
    """Return a figure with six decimals."""
    return None if value is None else round(value, 6)


def percent(share: float) -> str:
    """Return a share as a percentage that is 100 only where nothing is missing.

    Examples
    --------
    >>> percent(1.0), percent(0.99999), percent(0.5)
    ('100 %', '99.9 %', '50.0 %')
    """
    if share >= 1.0:
        return "100 %"
    return f"{min(100.0 * share, 99.9):.1f} %"

"""The orders of IHO S-44: how wrong a depth may be, and how much must be seen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.products.standards.tables import read_table, values_of

FloatArray = NDArray[np.float64]

WITHIN = 0.95
"""Share of depths that must lie within the uncertainty: S-44 states both at 95 % confidence."""


@dataclass(frozen=True, kw_only=True)
class Order:
    """One order of S-44, edition 6, table 1, in SI units; shares are parts of 1.

    Parameters
    ----------
    key, title : str
        As scenario files and as people write it.
    tvu_constant, tvu_of_depth : float
        a [m] and b [1] of the maximum vertical uncertainty.
    thu_constant, thu_of_depth : float
        Maximum horizontal uncertainty: constant [m] and share of depth [1].
    coverage : float
        Bathymetric coverage that is asked; 2 means every place twice [1].
    feature : float or None
        Side of the cube that must be detected [m].
    feature_of_depth : float
        The same as a share of depth, where that is more [1].
    feature_search : float or None
        Share of the area that must be searched for such cubes [1].
    """

    key: str
    title: str
    tvu_constant: float
    tvu_of_depth: float
    thu_constant: float
    thu_of_depth: float
    coverage: float
    feature: float | None = None
    feature_of_depth: float = 0.0
    feature_search: float | None = None

    def tvu(self, depth: ArrayLike) -> FloatArray:
        """Return the maximum vertical uncertainty at depths [m], sqrt(a^2 + (b d)^2), S-44 3.2.3.

        Examples
        --------
        >>> float(orders()["special"].tvu(20.0).round(3))
        0.292
        """
        varying = self.tvu_of_depth * np.asarray(depth, dtype=np.float64)
        return np.asarray(np.hypot(self.tvu_constant, varying))

    def thu(self, depth: ArrayLike) -> FloatArray:
        """Return the maximum horizontal uncertainty at depths [m].

        Examples
        --------
        >>> float(orders()["order_1a"].thu(20.0))
        6.0
        """
        return np.asarray(
            self.thu_constant + self.thu_of_depth * np.asarray(depth, dtype=np.float64)
        )

    def feature_at(self, depth: float) -> float | None:
        """Return the side of the cube that must be detected at a depth [m]; None if none is.

        Examples
        --------
        >>> [orders()["order_1a"].feature_at(depth) for depth in (10.0, 50.0)]
        [2.0, 5.0]
        """
        if self.feature is None:
            return None
        return max(self.feature, self.feature_of_depth * depth)


@cache
def orders() -> Mapping[str, Order]:
    """Return the orders by key, the strictest first.

    Examples
    --------
    >>> list(orders())
    ['exclusive', 'special', 'order_1a', 'order_1b', 'order_2']
    """
    return {
        key: Order(
            key=key,
            title=table["title"],
            **{name.removesuffix("_m"): value for name, value in values_of(table).items()},
        )
        for key, table in read_table("s44.toml")["orders"].items()
    }


def s44_title() -> str:
    """Return the name of the standard."""
    return str(read_table("s44.toml")["title"])

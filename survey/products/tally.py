"""Statistics that grow with the values met and not with their number."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

STEPS_PER_UNIT = 1_000_000
"""Quantiles are told to a millionth [m, or whatever is counted], as metrics.json is."""

REACH = 1 << 20
"""Steps to either side of 0 that are counted; what lies beyond is kept value by value."""

DEPTH_BIN = 0.5


class ErrorTally:
    """Mean, root mean square and quantiles of any number of errors, quantiles to a millionth.

    Examples
    --------
    >>> tally = ErrorTally()
    >>> tally.add(np.array([0.1, -0.2]))
    >>> tally.add(np.array([0.3, -40.0]))
    >>> tally.count, round(tally.mean, 6), round(tally.quantile_of_absolute(0.5), 6)
    (4, -9.95, 0.25)
    >>> tally.histogram(np.array([-1.0, 0.0, 1.0])).tolist()
    [2, 2]
    """

    def __init__(self) -> None:
        self.count, self._sum, self._squares = 0, 0.0, 0.0
        self._steps = np.zeros(2 * REACH + 1, np.uint32)
        self._beyond: list[FloatArray] = []

    def add(self, errors: FloatArray) -> None:
        """Add finite errors (n,)."""
        self.count += errors.size
        self._sum += float(errors.sum())
        self._squares += float(np.sum(errors**2))
        steps = np.rint(errors * STEPS_PER_UNIT)
        near = np.abs(steps) <= REACH
        places, counts = np.unique(steps[near].astype(np.intp) + REACH, return_counts=True)
        self._steps[places] += counts.astype(np.uint32)
        self._beyond.append(errors[~near])

    @property
    def mean(self) -> float:
        """Their mean."""
        return self._sum / self.count

    @property
    def root_mean_square(self) -> float:
        """Their root mean square."""
        return float(np.sqrt(self._squares / self.count))

    def quantile_of_absolute(self, share: float) -> float:
        """Return the quantile of the absolute errors, between neighbours as `numpy.quantile`."""
        counts = self._steps[REACH:].astype(np.int64)
        counts[1:] += self._steps[:REACH][::-1]
        upto = np.cumsum(counts)
        beyond = np.sort(np.abs(np.concatenate([*self._beyond, np.zeros(0)])))

        def ranked(rank: int) -> float:
            if rank < upto[-1]:
                return float(np.searchsorted(upto, rank, side="right")) / STEPS_PER_UNIT
            return float(beyond[rank - upto[-1]])

        place = share * (self.count - 1)
        low = ranked(int(np.floor(place)))
        return float(low + (place - np.floor(place)) * (ranked(int(np.ceil(place))) - low))

    def histogram(self, edges: FloatArray) -> NDArray[np.int64]:
        """Return counts between ascending edges; the end bins hold all that is beyond."""
        filled = np.flatnonzero(self._steps)
        values = np.concatenate([(filled - REACH) / STEPS_PER_UNIT, *self._beyond])
        counts = np.concatenate([self._steps[filled], *(np.ones(b.size) for b in self._beyond)])
        inside = np.clip(values, edges[0], edges[-1])
        return np.histogram(inside, edges, weights=counts)[0].astype(np.int64)


class DepthBins:
    """Counts of several kinds by bins of 0.5 m of true depth.

    Parameters
    ----------
    kinds : sequence of str
        Names of what is counted beside the members.

    Examples
    --------
    >>> bins = DepthBins(["found"])
    >>> bins.add(np.array([1.1, 1.2, 1.6, 1.3]), found=np.array([True, True, False, True]))
    >>> bins.deepest("found", 0.5)
    1.5
    >>> bins.total("found", depth=1.5), bins.total("members")
    (3, 4)
    """

    def __init__(self, kinds: Sequence[str]) -> None:
        self._counts = {name: np.zeros(0, np.int64) for name in ("members", *kinds)}
        self.least, self.greatest = np.inf, -np.inf

    def add(self, depth: FloatArray, **kinds: NDArray[np.bool_]) -> None:
        """Add members at depths (n,) [m], not negative, each of some kinds."""
        if depth.size == 0:
            return
        self.least = min(self.least, float(depth.min()))
        self.greatest = max(self.greatest, float(depth.max()))
        bins = np.floor(depth / DEPTH_BIN).astype(np.intp)
        for name, which in {"members": np.ones(depth.size, np.bool_), **kinds}.items():
            size = max(self._counts[name].size, int(self.greatest / DEPTH_BIN) + 1)
            counts = np.bincount(bins[which], minlength=size)
            counts[: self._counts[name].size] += self._counts[name]
            self._counts[name] = counts

    def deepest(self, kind: str, share: float) -> float | None:
        """Return the deep edge of the deepest bin so filled with a kind, or the deepest place [m].

        None where no bin is.
        """
        members = self._counts["members"]
        good = np.flatnonzero((members > 0) & (self._counts[kind] >= share * members))
        return float(min((good[-1] + 1) * DEPTH_BIN, self.greatest)) if good.size else None

    def total(self, kind: str, *, depth: float = np.inf) -> int:
        """Return how many of a kind lie in bins down to a depth [m]."""
        edges = np.arange(self._counts[kind].size) * DEPTH_BIN
        above = (edges < depth) | ((edges == depth) & (depth == self.greatest))
        return int(self._counts[kind][above].sum())

"""Levels of detail: points in such an order that any first few of them show the whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]
DEPTH = 16
"""Levels: cells of the last are 1/65536 of the extent wide."""

BLOCK = 1_000_000
SLOWEST_CHANGE = 0.5
"""At most so much fewer, or the reciprocal more, at a time."""


def coarse_to_fine(places: FloatArray) -> IndexArray:
    """Return an order of places in plan: one of every cell of a level comes before the next level.

    The cells of a level halve those of the level before. Each is stood for by its first place
    along a Z-order curve; within a level the order is drawn by lot, the same every time.

    Parameters
    ----------
    places : array (n, 2 or 3)
        Local places [m].

    Returns
    -------
    array (n,) of int

    Examples
    --------
    >>> places = np.array([[0.0, 0.0], [0.1, 0.1], [9.0, 9.0], [9.1, 9.1]])
    >>> sorted(coarse_to_fine(places)[:2].tolist())
    [0, 2]
    """
    if len(places) == 0:
        return np.zeros(0, dtype=np.intp)
    codes = _z_codes(places)
    along = np.argsort(codes, kind="stable")
    level = _level(codes[along])
    lot = np.random.default_rng(0).random(len(places), dtype=np.float32)
    return np.asarray(along[np.argsort(level + lot, kind="stable")])


def _level(ascending: NDArray[np.uint32]) -> NDArray[np.float32]:
    """Return the first level on which a code has another cell than the one before."""
    differing = np.diff(ascending, prepend=ascending[:1])
    np.bitwise_xor(ascending[1:], ascending[:-1], out=differing[1:])
    _, highest = np.frexp(differing.astype(np.float64))
    level = (DEPTH - (highest - 1) // 2).astype(np.float32)
    level[0] = 0.0
    return level


def _z_codes(places: FloatArray) -> NDArray[np.uint32]:
    plan = places[:, :2]
    low = plan.min(axis=0)
    extent = max(float((plan.max(axis=0) - low).max()), 1e-9)
    cells = ((plan - low) * ((2**DEPTH - 1) / extent)).astype(np.uint32)
    return _spread(cells[:, 0]) | (_spread(cells[:, 1]) << np.uint32(1))


def _spread(cells: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Return 16 bits with a zero between any two."""
    for shift, mask in ((8, 0x00FF00FF), (4, 0x0F0F0F0F), (2, 0x33333333), (1, 0x55555555)):
        cells = (cells | (cells << np.uint32(shift))) & np.uint32(mask)
    return cells


@dataclass(frozen=True, kw_only=True)
class LeveledPlaces:
    """Places in the order of `coarse_to_fine`.

    Parameters
    ----------
    order : array (n,)
        Their numbers in the cloud.
    place : array (n, 3) of float32
        Local, heights to scale [m].
    frame : array (n,)
        Of the flash that saw them.
    spacing : float
        Typical distance of neighbours [m].
    """

    order: IndexArray
    place: NDArray[np.float32]
    frame: NDArray[np.uint32]
    spacing: float

    @classmethod
    def of(
        cls,
        position: FloatArray,
        frame: NDArray[np.uint32],
        *,
        spacing: float,
        at_most: int | None = None,
    ) -> LeveledPlaces:
        """Return places (n, 3) and their frames in order; at most so many, drawn by lot."""
        if at_most is not None and len(position) > at_most:
            few = np.sort(np.random.default_rng(0).choice(len(position), at_most, replace=False))
            order = few[coarse_to_fine(position[few])]
        else:
            order = coarse_to_fine(position)
        return cls(
            order=order,
            place=position[order].astype(np.float32),
            frame=frame[order],
            spacing=spacing,
        )

    def __len__(self) -> int:
        return len(self.order)

    def first(self, count: int, wanted: Callable[[slice], NDArray[np.bool_]]) -> IndexArray:
        """Return the first so many that are wanted, as places of this order.

        Parameters
        ----------
        count : int
        wanted : callable
            From a slice of the order, which of it may be taken.
        """
        found, missing = [], count
        for start in range(0, len(self), BLOCK):
            if missing <= 0:
                break
            block = np.flatnonzero(wanted(slice(start, start + BLOCK)))[:missing] + start
            found.append(block)
            missing -= len(block)
        return np.concatenate(found) if found else np.zeros(0, dtype=np.intp)

    def spacing_of(self, count: int) -> float:
        """Return the typical distance of neighbours when only so many are drawn [m]."""
        return self.spacing * float(np.sqrt(max(len(self) / max(count, 1), 1.0)))


@dataclass
class Pace:
    """How many points may be drawn in a time; every picture drawn makes it know better.

    Parameters
    ----------
    seconds : float
        That a picture may take [s].
    points : int
        Tried first.
    least : int
        Drawn however long it takes.

    Examples
    --------
    >>> pace = Pace(seconds=0.1, points=100_000, least=10_000)
    >>> pace.told(100_000, 0.125)
    >>> pace.points
    80000
    """

    seconds: float
    points: int
    least: int

    def told(self, drawn: int, took: float) -> None:
        """Learn from a picture of so many points; of fewer than were allowed only if it was slow.

        Parameters
        ----------
        drawn : int
        took : float
            Time [s].
        """
        change = float(np.clip(self.seconds / max(took, 1e-6), SLOWEST_CHANGE, 1 / SLOWEST_CHANGE))
        if drawn >= self.points or change < 1.0:
            self.points = max(int(min(drawn, self.points) * change), self.least)

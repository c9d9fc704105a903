"""How often each place of the survey area was seen, and the holes in it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil

import numpy as np
from numpy.typing import NDArray

from survey.products.cells import CellGrid
from survey.products.pixels import SEEN

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Passes:
    """The survey area by cells (rows, columns).

    Parameters
    ----------
    cells : CellGrid
        Where they lie on the map.
    wet : array of bool
        Cells of the survey area that are truly under water.
    frames : array of int
        Frames that found the bottom, or saw land, within reach of a cell's centre.
    """

    cells: CellGrid
    wet: NDArray[np.bool_]
    frames: NDArray[np.uint16]

    def missing(self, *, times: int, hole: float = 0.0) -> NDArray[np.bool_]:
        """Return the wet cells that were seen fewer times.

        With ``hole`` only those within a gap in which a square of that side [m] has room; a side
        below the cells' leaves every one of them.
        """
        fewer = self.wet & (self.frames < times)
        side = ceil(hole / self.cells.cell_size - 1e-9)
        if side <= 1:
            return fewer
        from scipy.ndimage import binary_opening

        return np.asarray(binary_opening(fewer, np.ones((side, side), dtype=np.bool_)))

    def share(self, missing: NDArray[np.bool_]) -> float:
        """Return the share of the wet cells that is not missing [1]."""
        return 1.0 - float(missing.sum()) / float(self.wet.sum())


@dataclass(kw_only=True)
class PassTally:
    """Counts the frames that saw the bottom, or land, near each cell's centre.

    Parameters
    ----------
    cells : CellGrid
        On the map.
    reach : float
        Distance that one pixel answers for [m].
    """

    cells: CellGrid
    reach: float
    frames: NDArray[np.uint16] = field(init=False)

    def __post_init__(self) -> None:
        self.frames = np.zeros(self.cells.shape, dtype=np.uint16)

    def add(
        self,
        places: FloatArray,
        outcomes: NDArray[np.uint8],
        flash: NDArray[np.intp],
        cells: CellGrid | None = None,
    ) -> None:
        """Count for some cells, by default all, with all pixels in reach of them.

        Parameters
        ----------
        places : array (n, 2)
            Where pixels look [m, map].
        outcomes, flash : array (n,)
            What became of the bottom there, and which frame looked, in rising order.
        cells : CellGrid, optional
            Cells of the same lattice.
        """
        window = self.cells.window(cells or self.cells)
        part = self.cells.part(window)
        seen = np.isin(outcomes, SEEN)
        places, flash = places[seen], flash[seen]
        starts = np.flatnonzero(np.diff(flash, prepend=-1))
        frames = np.zeros(part.shape, dtype=np.uint16)
        for of_frame in np.split(places, starts[1:]):
            frames.ravel()[_reached(of_frame, part, self.reach)] += 1
        self.frames[window] = frames


def _reached(places: FloatArray, cells: CellGrid, reach: float) -> NDArray[np.intp]:
    """Return the flat indices of the cells, each once, with a place within reach of the centre."""
    west, _, south, _ = cells.extent
    most = ceil(reach / cells.cell_size + 0.5)
    columns = _steps((places[:, 0] - west) / cells.cell_size, cells.columns, most)
    rows = _steps((places[:, 1] - south) / cells.cell_size, cells.rows, most)
    found = [np.empty(0, dtype=np.intp)]
    for column, across, known_column in columns:
        for row, along, known_row in rows:
            near = np.sqrt(across + along) * cells.cell_size <= reach
            near &= known_column & known_row
            found.append((cells.rows - 1 - row[near]) * cells.columns + column[near])
    return np.unique(np.concatenate(found))


def _steps(
    at: FloatArray, count: int, most: int
) -> list[tuple[NDArray[np.intp], FloatArray, NDArray[np.bool_]]]:
    """Return cells along one axis up to so many steps away from places counted in cells.

    Of each step the cells, the squared distances to their centres, and which cells there are.
    """
    cells = [np.floor(at) + step for step in range(-most, most + 1)]
    return [
        (cell.astype(np.intp), (cell + 0.5 - at) ** 2, (cell >= 0) & (cell < count))
        for cell in cells
    ]
